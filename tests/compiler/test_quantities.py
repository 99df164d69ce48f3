"""Units: what may be joined, what a product is measured in, what is converted."""

from fractions import Fraction

import pytest

import stlspec
from stlspec.compiler.checks import check
from stlspec.compiler.quantities import conversion, scaled
from stlspec.lang.parse import parse
from stlspec.lang.units import spell
from stlspec.source import SourceText

DECLARED = (
    'time 100 ms\nsignal v unit "m/s"\nsignal d unit "m"\nsignal n\nsignal a unit "rad"\nsignal f unit "furlong"\n'
    'signal soc unit "%"\n'
    "param T = 2 s\nparam k = 3\nparam open\n"
)


def checked(text):
    return check(parse(SourceText.of("s", DECLARED + text)))


def codes(formula):
    return [d.code for d in checked(f"hard a1: {formula}")[1]]


@pytest.mark.parametrize(
    "formula",
    [
        "v > 3",
        "v > 3 m/s",
        "soc > 3 percent",
        "v > k",
        "v > open",
        "d > v * T",
        "d > v * 2 s",
        "d / T > v",
        "d ** 2 > 4 m**2",
        "d * d > 4 m**2",
        "v / 1 m/s > n",
        "now > 3",
        "now > 3 s",
        "now < T",
        "now * 1 > 5 min",
        "sqrt(d * d) > d",
        "abs(v) < max(v, 3, k)",
        "hypot(d, 3 m) < d",
        "delta(d) < 3 m",
        "rate(d) < 3 m/ms",
        "sin(a) > 0",
        "sin(n) > 0",
        "exp(d / 1 m) > n",
        "f > 3 furlong",
        "1 / d > 2 / 1 m",
        "T > 300 ms",
        "d ** (2) > 3 m**2",
        "2 ** n > 3",
        "2 ** k > 3",
        "v > 0",
        "v > -inf",
    ],
)
def test_units_that_fit_pass(formula):
    assert codes(formula) == []


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("v > d", ["U301"]),
        ("v > n", ["U301"]),
        ("v > 3 m", ["U301"]),
        ("v + T > 3", ["U301"]),
        ("d > v", ["U301"]),
        ("min(v, d) > 3", ["U301"]),
        ("1 s < 5 < d", ["U301"]),
        ("now > d", ["U301"]),
        ("exp(v) > 1", ["U306"]),
        ("sin(d) > 1", ["U306"]),
        ("sqrt(d) > 1", ["U306"]),
        ("d ** 0.5 > 1", ["U306"]),
        ("d ** n > 1", ["U306"]),
        ("2 ** d > 1", ["U306"]),
        ("d ** k > 1", ["U306"]),
        ("f > 3 furlon", ["U302"]),
        ("d > 3 m and d > 3 k", ["U302"]),
        ("3 sec > now", ["U302"]),
    ],
)
def test_units_that_do_not_fit_are_one_diagnostic(formula, expected):
    assert codes(formula) == expected


@pytest.mark.parametrize(
    ("formula", "meant"),
    [
        ("3 sec > now", "s"),
        ("v > 3 m/sec", "m/s"),
        ("v > 3 meters/seconds", "m/s"),
        ("v / 3 s > 3 m/s2", "m/s**2"),
        ("f > 3 furlogn", "furlong"),
    ],
)
def test_a_unit_of_several_words_is_mended_as_a_whole(formula, meant):
    (problem,) = checked(f"hard h: {formula}")[1]
    assert problem.help == f"did you mean `{meant}`?"
    assert check(parse(SourceText.of("s", problem.fixes[0].applied(problem.source.text))))[1] == ()


@pytest.mark.parametrize(
    ("expression", "unit", "value"),
    [
        ("2 s + 500 ms", "s", 2.5),
        ("500 ms + 2 s", "ms", 2500),
        ("max(1 min, 90 s)", "min", 1.5),
        ("3 m * 2 s", "m*s", 6),
        ("(1 min * 6 s) / 1 min", "s", 6),
        ("6 s / 2 s", "", 3),
        ("(3 m) ** 2 / 1 m", "m", 9),
        ("-(2 s)", "s", -2),
        ("hypot(3 s, 4000 ms)", "s", 5),
    ],
)
def test_only_times_that_are_joined_are_converted(expression, unit, value):
    model, problems = checked(f"let c = {expression}\nhard a1: true")
    assert problems == ()
    typing = model.let_typings["c"]
    assert (spell(typing.unit or {}), typing.value) == (unit, value)


def test_conversion_exists_between_times_only():
    assert conversion({"s": 1}, {"ms": 1}) == 1000
    assert conversion({"m": 1}, {"m": 1}) == conversion(None, {"m": 1}) == 1
    assert conversion({"m": 1}, {"s": 1}) is None
    assert conversion({"s": 2}, {"ms": 2}) == 1_000_000
    assert conversion({"s": 1}, {"ms": 2}) is conversion({"s": 9}, {"ms": 9}) is None


def test_the_rate_of_a_speed_is_an_acceleration_whatever_the_time_is_measured_in():
    assert conversion({"m": 1, "s": -1, "ms": -1}, {"m": 1, "s": -2}) == 1000
    assert conversion({"m": 1, "s": -2}, {"m": 1, "s": -1, "ms": -1}) == Fraction(1, 1000)
    assert conversion({"m": 1, "s": -2}, {"kg": 1, "s": -2}) is None


def test_an_acceleration_limit_is_kept_in_the_unit_that_it_is_written_in():
    bundle = stlspec.compile('time 10 ms\nsignal v unit "m/s"\nhard gentle: always (rate(v) <= 3 m/s**2)\n')
    assert bundle.evaluate({"v": [0.0, 0.02, 0.04]})["gentle"].robustness == pytest.approx(0.001)  # m/s/ms
    assert bundle.evaluate({"v": [0.0, 0.02, 0.06]})["gentle"].robustness == pytest.approx(-0.001)


def test_a_unit_declared_for_a_signal_may_stand_behind_a_param_above_it():
    assert check(parse(SourceText.of("s", 'param p = 5 parsec\nsignal x unit "parsec"\nhard a: x > p')))[1] == ()


def test_whole_milliseconds_are_that_many_thousandths_of_a_second_from_either_side():
    for n in range(1, 2000):
        assert scaled(float(n), conversion({"ms": 1}, {"s": 1})) == n / 1000
        assert scaled(n / 1000, conversion({"s": 1}, {"ms": 1})) == n


def test_what_is_too_large_for_another_unit_is_infinite():
    factor = conversion({"h": 1}, {"ns": 1})
    assert [scaled(x, factor) for x in (1e308, -1e308, float("inf"))] == [float("inf"), -float("inf"), float("inf")]


@pytest.mark.parametrize(
    ("formula", "names"),
    [
        ("d > 3 N*m", ["m"]),
        ("d > 3 kg*m/s**2", ["m"]),
        ("d > 3 / m", ["m"]),
        ("d < m/s", ["m"]),
        ("d < m / v / s", ["m", "s"]),
    ],
)
def test_a_unit_that_was_taken_for_names_is_told_once(formula, names):
    found = checked(f"hard a1: {formula}")[1]
    assert [(d.code, d.message.split("`")[1]) for d in found] == [("N101", name) for name in names]
    told = "leave the unit out" in found[0].help
    assert told == ("3" in formula)
