"""The nearest word, if there is one."""

import time

import pytest

from stlspec.lang.spelling import closest


@pytest.mark.parametrize(
    ("word", "candidates", "expected"),
    [
        ("eventualy", ["always", "eventually"], "eventually"),
        ("d_obz", ["d_goal", "d_obs"], "d_obs"),
        ("AND", ["and", "or"], "and"),
        ("adn", ["not", "and"], "and"),
        ("zzz", ["and", "or"], None),
        ("x", [], None),
    ],
)
def test_the_nearest_word_is_found(word, candidates, expected):
    assert closest(word, candidates) == expected


def test_among_thousands_a_slip_at_either_end_is_found_fast():
    names = [f"signal_number_{i}" for i in range(5000)]
    before = time.process_time()
    assert closest("signal_number_123x", names) in names
    assert closest("sgnal_number_4999", names) == "signal_number_4999"
    assert time.process_time() - before < 0.2
