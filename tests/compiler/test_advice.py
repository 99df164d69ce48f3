"""Ways out of mistakes of names, types and units: each fix clears the file, and is left out where nobody can know."""

import pytest

from stlspec.compiler.checks import check
from stlspec.lang.parse import parse
from stlspec.source import SourceText

HEAD = (
    'time s\nsignal d unit "m"\nsignal v unit "m/s"\nsignal w unit "km/h"\nsignal p : bool\nsignal u\n'
    'signal m unit "kg"\nsignal f unit "ft"\n'
)


def errors(text):
    return [problem for problem in check(parse(SourceText.of("s", text)))[1] if problem.severity == "error"]


def only(statement):
    (problem,) = errors(HEAD + statement + "\n")
    return problem


@pytest.mark.parametrize(
    ("statement", "right"),
    [
        ("hard a: v > w", "hard a: v > w * 1000 m/km"),
        ("hard a: w > v", "hard a: w * 1000 m/km > v"),
        ("hard a: w - (v + v) > 0", "hard a: w * 1000 m/km - (v + v) > 0"),
        ("hard a: v > -w", "hard a: v > (-w) * 1000 m/km"),
        ("hard a: v > 36 km/h", "hard a: v > 10 m/s"),
        ("hard a: 36 km/h < v", "hard a: 10 m/s < v"),
        ("hard a: v > 3 km/h", "hard a: v > 3 km/h * 1000 m/km"),
        ("hard a: max(d, 1 inch) > 0", "hard a: max(d, 0.0254 m) > 0"),
        ("hard a: 1 / v > 1 / w", "hard a: (1 / v) * 1000 m/km > 1 / w"),
        ("hard a: d > 1e308 km", "hard a: d > 1e308 km * 1000 m/km"),
        ("hard a: d > f", "hard a: d > f * 0.3048 m/ft"),
        ("hard a: f > d", "hard a: f * 0.3048 m/ft > d"),
        ("hard a: d**2 > 3 km**2", "hard a: d**2 > 3000000 m**2"),
        ("hard a: m * d > d * 5 g", "hard a: (m * d) * 1000 g/kg > d * 5 g"),
        ('signal g unit "m" in [0, 1 km]', 'signal g unit "m" in [0, 1000 m]'),
        ("hard a: p == true", "hard a: p"),
        ("hard a: p == false", "hard a: not p"),
        ("hard a: p != true", "hard a: not p"),
        ("hard a: true != (u > 1)", "hard a: not (u > 1)"),
        ("hard a: p == 0 and u > 1", "hard a: not p and u > 1"),
        ("hard a: always[0, infinity] p", "hard a: always[0, inf] p"),
        ("signal g in [0, Infinity]", "signal g in [0, inf]"),
    ],
)
def test_the_fix_says_what_was_meant_and_clears_the_file(statement, right):
    text = only(statement).fixes[0].applied(f"{HEAD}{statement}\n")
    assert text == f"{HEAD}{right}\n"
    assert errors(text) == []


@pytest.mark.parametrize(
    ("statement", "way"),
    [
        ("hard a: d > m", "convert one side by a factor with a unit"),
        ("hard a: d > 3 degC", "convert one side by a factor with a unit"),
        ("hard a: v > 1 km", "convert one side by a factor with a unit"),
        ("hard a: m * d > 3 rev", "convert one side by a factor with a unit"),
        ("hard a: d > u + 1 rad", "declare the unit of both sides"),
        ("hard a: p == (u > 1)", "use `iff` to say that two formulas agree"),
        ("hard a: u == true", "`u` is a number: compare it with one, as in `u > 0`"),
        ("hard a: p == 2", "use `iff` to say that two formulas agree"),
    ],
)
def test_what_nobody_can_know_has_no_fix(statement, way):
    problem = only(statement)
    assert (problem.help, problem.fixes) == (way, ())


def test_a_declared_infinity_is_a_name_like_any():
    assert errors("param infinity = 5\nsignal x\nhard a: always[0, infinity] x > 1\n") == []


def test_in_a_template_the_argument_is_named():
    (problem,) = errors(f"{HEAD}let faster(a, b) = a > b\nhard a: faster(v, w)\n")
    assert problem.help == "write `w * 1000 m/km`; times are converted already"
    assert problem.fixes == ()


@pytest.mark.parametrize(
    ("statement", "way"),
    [
        ("hard a: always[0, Limit] (1 > 0)", "declare it: `param Limit = ...` or `let Limit = ...`"),
        ("signal xx in [0, 2 * Limit]", "declare it: `param Limit = ...` or `let Limit = ...`"),
        ("hard a: always (1 > Limit)", "declare it: `signal Limit`, `param Limit = ...` or `let Limit = ...`"),
    ],
)
def test_where_no_signal_may_stand_none_is_proposed(statement, way):
    (found,) = check(parse(SourceText.of("s", statement + "\n")))[1]
    assert (found.code, found.help) == ("N101", way)
