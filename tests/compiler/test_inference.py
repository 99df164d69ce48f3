"""Reals and formulas told apart, constants computed, names reported once."""

import pytest

from stlspec.compiler.checks import check
from stlspec.lang.parse import parse
from stlspec.source import SourceText

DECLARED = "signal x\nsignal y\nsignal b: bool\nsignal c: bool\nparam T = 3\nlet p = x > 1\n"


def codes(formula, declared=DECLARED):
    return [d.code for d in check(parse(SourceText.of("s", f"{declared}hard a: {formula}")))[1]]


@pytest.mark.parametrize(
    "formula",
    [
        "b",
        "not b",
        "b and p",
        "b iff c",
        "b xor c",
        "x == y",
        "abs(x) ** 2 + 1 > y / 2",
        "min(x, y, T) < max(x, 1)",
        "hypot(x, y) < 3",
        "delta(x) > 0",
        "rate(x) < 2",
        "now < 5",
        "t < 5",
        "x[t] > 1 and b[t]",
        "x > inf",
        "true",
        "1 > 2",
        "always[T, 2 * T] b",
        "(b)",
        "(x + y) > (1)",
        "exp(x) > log(y) - sin(1) + cos(0) * sqrt(4)",
        "b until[0, T] c",
        "prev b and wprev b",
        "once[0, 2] b since c",
    ],
)
def test_well_typed_formulas_pass(formula):
    assert codes(formula) == []


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("x", ["T201"]),
        ("x + 1", ["T201"]),
        ("always x", ["T201"]),
        ("b and x", ["T201"]),
        ("x and y", ["T201", "T201"]),
        ("not x > 1 and 5", ["T201"]),
        ("b + 1 > 2", ["T202"]),
        ("-b > 1", ["T202"]),
        ("b == c", ["T202"]),
        ("abs(b) > 1", ["T202"]),
        ("(always x > 1) > 2", ["T202"]),
        ("x => 5", ["T201"]),
        ("b => x", ["T201"]),
        ("x -> y", ["T201", "T201"]),
        ("min(x) > 1", ["T203"]),
        ("rate(x, y) > 1", ["T203"]),
        ("always[x, 5] b", ["T204"]),
        ("always[0, rate(2)] b", ["T204"]),
        ("always[0, now] b", ["T204"]),
        ("always[0, b] c", ["T202"]),
        ("always[0, (once b)] c", ["T202"]),
        ("x > 0 / 0", ["T207"]),
        ("x > inf - inf", ["T207"]),
        ("x > sqrt(-1)", ["T207"]),
        ("x > log(-2)", ["T207"]),
        ("x > (-8) ** (1 / 3)", ["T207"]),
        ("x = 1", ["S008"]),
        ("1 < x = 5", ["S008"]),
        ("x[3] > 1", ["S013"]),
        ("x[t + 1] > 1", ["S013"]),
        ("z[t] > 1", ["N101"]),
        ("z > 1 and z < 2 or z > 5", ["N101"]),
        ("z > 1 and w > 1", ["N101", "N101"]),
        ("foo(x) > foo(y)", ["N103"]),
        ("S > 3", ["N101"]),
        ("a", ["N105"]),
        ("x > 1e400", ["S023"]),
        ("b until c until b", ["S009"]),
        ("0 < x > 5", ["S022"]),
        ("x == y == 1", ["S022"]),
    ],
)
def test_each_wrong_place_is_one_diagnostic(formula, expected):
    assert codes(formula) == expected


@pytest.mark.parametrize(
    ("name", "way"),
    [
        ("xx", "did you mean `x`?"),
        ("TRUE", "did you mean `true`?"),
        ("zebra", "declare it: `signal zebra`, `param zebra = ...` or `let zebra = ...`"),
    ],
)
def test_an_unknown_name_is_told_a_way_out(name, way):
    (problem,) = check(parse(SourceText.of("s", f"signal x\nhard a: {name} > 1")))[1]
    assert problem.help == way


def test_at_least_written_as_an_arrow_is_told_the_comparison():
    (problem,) = check(parse(SourceText.of("s", "signal x\nhard a: x + 1 => 5")))[1]
    assert problem.help == "`=>` means `implies`; to compare write `x + 1 >= 5`"


def test_the_way_out_quotes_the_expression_that_is_no_formula():
    (problem,) = check(parse(SourceText.of("s", "signal x\nhard a: always (x\n + 1)")))[1]
    assert "`(x + 1) > 0`" in problem.help


def test_the_value_of_a_constant_is_known_to_its_users():
    model, _ = check(parse(SourceText.of("s", "param T = 3\nlet u = 2 ** T - 1\nlet v = u / 0\nhard a: v > u")))
    assert (model.let_typings["u"].value, model.let_typings["v"].value) == (7, float("inf"))


def test_bounds_within_bounds_need_no_deep_stack():
    nested = "always[0, (" * 90 + "b" + ")] c" * 90
    assert codes(nested) == ["T202"]


@pytest.mark.parametrize(
    ("call", "meant"), [("diff", None), ("norm", None), ("rte", "rate"), ("alway", "always"), ("nt", None)]
)
def test_an_unknown_function_is_compared_with_functions(call, meant):
    text = f"signal x\nhard a: x > 1 and {call}(x) > 1"
    (problem,) = check(parse(SourceText.of("s", text)))[1]
    begins = f"did you mean `{meant}`?" if meant else "the functions are abs, min,"
    assert problem.code == "N103" and problem.help.startswith(begins)
