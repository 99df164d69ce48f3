"""Windows as people say them: one diagnostic, the way to write them here, and a fix that was tried where it is sure."""

import pytest

from stlspec.lang.parse import parse
from stlspec.source import SourceText

HEAD = "time s\nsignal x\nsignal p : bool\nsignal to\n"


def only(statement):
    (problem,) = parse(SourceText.of("s", f"{HEAD}{statement}\n")).diagnostics
    return problem


@pytest.mark.parametrize(
    ("statement", "right"),
    [
        ("hard a: p within 5 s", "hard a: eventually[0, 5 s] p"),
        ("hard a: p for 5 s", "hard a: always[0, 5 s] p"),
        ("hard a: x > 5 for at least 5 s", "hard a: always[0, 5 s] (x > 5)"),
        ("hard a: always for 5 s p", "hard a: always[0, 5 s] p"),
        ("hard a: p within the next 5 s", "hard a: eventually[0, 5 s] p"),
        ("hard a: p implies x > 5 within 5 s", "hard a: p implies eventually[0, 5 s] (x > 5)"),
        ("hard a: always (p -> (x > 5) within [1 s, 5 s])", "hard a: always (p -> eventually[1 s, 5 s] (x > 5))"),
        ("hard a: eventually within 5 s p", "hard a: eventually[0, 5 s] p"),
        ("hard a: eventually within [1 s, 5 s] (x > 4)", "hard a: eventually[1 s, 5 s] (x > 4)"),
        ("hard a: always (x > 5) in [0 s, 9 s]", "hard a: always[0 s, 9 s] (x > 5)"),
        ("hard a: forall t in [0, 9 s]: x > 1 and p", "hard a: always[0, 9 s] (x > 1 and p)"),
        ("hard a: exists t in [0, 9 s] x > 1", "hard a: eventually[0, 9 s] (x > 1)"),
        ("signal y in [-10 through 80]", "signal y in [-10, 80]"),
        ("hard a: always[0 s till 5 s] p", "hard a: always[0 s, 5 s] p"),
        ("hard a: always[0 and 5 s] p", "hard a: always[0, 5 s] p"),
    ],
)
def test_a_window_is_put_right(statement, right):
    problem = only(statement)
    text = problem.fixes[0].applied(problem.source.text)
    assert text == f"{HEAD}{right}\n"
    assert parse(SourceText.of("s", text)).diagnostics == ()


@pytest.mark.parametrize(
    ("statement", "way"),
    [
        ("hard a: x in [0, 10]", "for values write `0 <= x and x <= 10`; for times `always[0, 10] x`"),
        ("hard a: x > 5 in [0, 9 s]", "write `always[0, 9 s] (x > 5)`, or `eventually[0, 9 s] (x > 5)`"),
        ("hard a: p and x > 5 within 5 s", "write `eventually[0, 5 s]` before the formula"),
        ("hard a: p and x > 5 in [0, 9 s]", "a window stands behind its operator, as in `always[0, 9 s] (...)`"),
        ("hard a: not (forall t in [0, 9 s]: p)", "write `always[0, 9 s] (...)`"),
        (
            "hard forall t in [0, 9 s]: p",
            "write a name first, and the window at its operator, as in `hard goal: always[0, 9 s] (...)`",
        ),
    ],
)
def test_what_can_be_meant_in_two_ways_has_no_fix(statement, way):
    problem = only(statement)
    assert (problem.help, problem.fixes) == (way, ())


def test_a_declared_name_is_no_word_between_bounds():
    assert only("hard a: always[0 to 5] p").help != "write `[0, 5]`"


@pytest.mark.parametrize("words", ["for all", "for each", "for every"])
def test_for_all_is_always(words):
    text = f"signal x\nhard a: {words} (x > 1)"
    (problem,) = parse(SourceText.of("s", text)).diagnostics
    assert (problem.code, problem.help) == ("S001", "write `always` for: at all samples")
    assert problem.fixes[0].applied(text) == "signal x\nhard a: always (x > 1)"
