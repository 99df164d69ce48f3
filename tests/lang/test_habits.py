"""Habits of other languages: one diagnostic, with the way to say it here."""

import pytest

from stlspec.lang.parse import parse
from stlspec.source import SourceText


def only(text):
    (problem,) = parse(SourceText.of("s", text)).diagnostics
    return problem


@pytest.mark.parametrize(
    ("statement", "code", "way"),
    [
        ("hard a: ego.speed > 1", "S005", "a name has no dots: write `ego_speed`"),
        ("hard a: x > 20%", "S005", "write `percent` in its place"),
        ("hard a: always (if x > 5 then x < 7)", "S001", "write `p implies q` for: if p then q"),
        ("hard a: eventually[5 s] x > 1", "S001", "write `[0, 5 s]`"),
        ("hard a: always (|x - 1| < 5)", "S001", "write `abs(x - 1)`"),
        ("hard a: always{0, 5 s} (x > 1)", "S001", "write `[0, 5 s]`"),
        ("hard a: eventually<0, 5> (x > 1)", "S001", "write `[0, 5]`"),
        ("hard a: always |0 : 5| (x > 1)", "S001", "write `[0, 5]`"),
        ("hard a: x > 5 °C", "S005", "write `deg` in its place"),
        ("signal y unit %", "S005", 'write `"%"`: a unit that is no word stands in quotes'),
        ("signal y in (-1, 5)", "S025", "write [-1, 5]"),
        ("signal y in (0, 5]", "S025", "write [0, 5]"),
    ],
)
def test_habits_of_other_languages_are_told_the_way_here(statement, code, way):
    problem = only(f"signal x\n{statement}")
    assert (problem.code, problem.help) == (code, way)


@pytest.mark.parametrize(
    "text",
    [
        "signal x in (-1, 5)",
        "hard a: eventually[5 s] x > 1",
        "hard a: always{0, 5 s} (x > 1)",
        "hard a: |x| + |x - 2| < 5 | x > |x - 1|",
    ],
)
def test_the_fix_clears_it(text):
    assert parse(SourceText.of("s", only(text).fixes[0].applied(text))).diagnostics == ()


def test_a_stray_bracket_among_requirements_is_no_interval_with_one_bound():
    assert only("signal x\nhard a depends on b]: x > 1").code == "S019"
