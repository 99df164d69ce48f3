"""Units written in another way: one diagnostic, with the way to say it here, and a fix that clears it."""

import pytest

from stlspec.lang.parse import parse
from stlspec.source import SourceText

LEAVE_OUT = "leave the unit out: a number takes that of the other side"
AS_IT_IS = ": behind a number a unit stands as it is"


def problems(text):
    return parse(SourceText.of("s", text)).diagnostics


@pytest.mark.parametrize(
    ("statement", "way", "fixed"),
    [
        ('hard a: x > 3 "m/s"', "write `3 m/s`" + AS_IT_IS, "hard a: x > 3 m/s"),
        ('hard a: x > 3 "m^2"', "write `3 m**2`" + AS_IT_IS, "hard a: x > 3 m**2"),
        ("hard a: always (x > 3 [m/s])", "write `3 m/s`" + AS_IT_IS, "hard a: always (x > 3 m/s)"),
        ("hard a: F[0, 3 [s]] p", "write `3 s`" + AS_IT_IS, "hard a: F[0, 3 s] p"),
        ('hard a: x > 3 "furlong/h"', "write `3 furlong/h`" + AS_IT_IS, "hard a: x > 3 furlong/h"),
        ("hard a: always (x > 3 1/s)", LEAVE_OUT, "hard a: always (x > 3)"),
        ("hard a: always (x > 3 N m)", LEAVE_OUT, "hard a: always (x > 3)"),
        ("let a = x > 3 m s", LEAVE_OUT, "let a = x > 3"),
        ("hard a: F[0, T s] p", "write `T`: a param carries its own unit, as in `param T = 5 s`", "hard a: F[0, T] p"),
        (
            "hard a: F[T ms, 9] p",
            "write `T`: a param carries its own unit, as in `param T = 5 ms`",
            "hard a: F[T, 9] p",
        ),
        ("signal y [m/s]", 'write `unit "m/s"`', 'signal y unit "m/s"'),
        ("signal y (N m)", 'write `unit "N*m"`', 'signal y unit "N*m"'),
        ("signal y: real [m**2]", 'write `unit "m**2"`', 'signal y: real unit "m**2"'),
    ],
)
def test_a_unit_is_told_how_it_is_written_here(statement, way, fixed):
    head = 'signal x unit "furlong/h"\nsignal p: bool\n'
    (found,) = problems(head + statement)
    assert (found.code, found.help) == ("S001", way)
    assert found.fixes[0].applied(head + statement) == head + fixed
    assert problems(head + fixed) == ()


@pytest.mark.parametrize(
    ("statement", "code"),
    [
        ('hard a: x > 3 "a title"', "S010"),
        ('hard a: x > 3 "x"', "S010"),
        ("hard a: always (x > 3 x)", "U302"),
        ("hard a: always (x > 3 1)", "S004"),
        ("signal y [0, 5]", "S026"),
        ("signal y (x)", "S001"),
    ],
)
def test_what_is_no_unit_is_not_taken_for_one(statement, code):
    found = problems(f"signal x\n{statement}")
    assert [problem.code for problem in found] == ([code] if code != "U302" else [])
    assert not any("unit" in problem.help for problem in found)
