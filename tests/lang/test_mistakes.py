"""The second generator of broken specs: its referee is right, and the checker is, about nearly all of its cases."""

import random

import pytest

from tests.lang.mistakes import DOMAINS, SLIPS, cases, declared, is_broken, measure, pieces_of, slip


@pytest.mark.parametrize("path", DOMAINS, ids=lambda path: path.stem)
def test_the_referee_finds_no_fault_in_good_statements(path):
    text = path.read_text(encoding="utf-8")
    pieces = [text[start:end] for start, end in pieces_of(text)]
    assert len(pieces) > 12
    assert [piece for piece in pieces if is_broken(piece, declared(text))] == []


@pytest.mark.parametrize(
    "piece", ["hard a: alwayss (x > 1)", "hard a: always x > ", "signal always", "let a = (x", "hard a: y > 1"]
)
def test_the_referee_finds_faults(piece):
    assert is_broken(piece, frozenset("x"))


def test_every_slip_fits_somewhere_and_changes_something():
    rng, seen = random.Random(0), set()
    texts = [path.read_text(encoding="utf-8") for path in DOMAINS]
    pieces = [text[start:end] for text in texts for start, end in pieces_of(text)]
    for piece in pieces * 40:
        found = slip(piece, rng)
        if found is not None and found[1][0] != piece:
            seen.add(found[0])
    assert len(seen) > 0.9 * len(SLIPS)


def test_the_same_seed_gives_the_same_cases():
    assert list(cases(20, 3)) == list(cases(20, 3)) != list(cases(20, 4))


def test_broken_statements_are_found_placed_and_reported_once():
    score = measure(300, 0)
    assert score.found >= 0.99 * score.cases
    assert score.placed >= 0.98 * score.found
    assert score.reported <= 1.05 * score.found
    assert score.elsewhere <= 0.01 * score.good
