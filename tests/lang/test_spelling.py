"""The nearest word, if there is one."""

import time

import pytest

from stlspec.lang.spelling import closest, closest_column, split_unit


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


@pytest.mark.parametrize(
    ("name", "columns", "expected"),
    [
        ("alt", ["time", "altitude"], "altitude"),
        ("altitude", ["time", "alt"], "alt"),
        ("vz", ["vx", "vz [ft/s]"], "vz [ft/s]"),
        ("batt", ["batt (%)"], "batt (%)"),
        ("d_goal", ["D Goal", "d_goals"], "D Goal"),
        ("d_goal", ["d.goal"], "d.goal"),
        ("alt", ["altimeter", "drone.alt"], "drone.alt"),
        ("alt", ["altitude_rate", "altitude"], "altitude"),
        ("battery", ["batery"], "batery"),
        ("alt", ["alternative_route", "salt_content"], None),
        ("x", ["xpos", "z"], None),
        ("vz", ["vx", "vy"], None),
        ("alt", [], None),
        ("_", ["-", "x"], None),
    ],
)
def test_the_column_that_a_signal_is_read_from_is_found(name, columns, expected):
    assert closest_column(name, columns) == expected


@pytest.mark.parametrize(
    ("column", "expected"),
    [
        ("alt [m]", ("alt", "m")),
        ("vz[ft/s]", ("vz", "ft/s")),
        ("batt (%)", ("batt", "%")),
        ("obs[0]", ("obs[0]", None)),
        ("[m]", ("[m]", None)),
        ("alt", ("alt", None)),
    ],
)
def test_a_unit_in_brackets_is_no_part_of_the_name(column, expected):
    assert split_unit(column) == expected
