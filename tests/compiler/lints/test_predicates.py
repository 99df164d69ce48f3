"""Conditions that say less than they seem to are reported, and what is meant is not."""

import random

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.compiler.review import review_source
from stlspec.source import SourceText
from tests.compiler.lints.specs import HEAD as RANGED
from tests.compiler.lints.specs import oracle_of, random_spec, random_trace

HEAD = (
    'signal x in [0, 10]\nsignal d in [0, inf]\nsignal v unit "m/s"\nsignal row\nsignal goal\nsignal p: bool\n'
    "param T = 8\nparam open\n"
)
CODES = ("L601", "L602", "L603", "L604", "L607", "L609")


def codes(formula, params=None):
    found = review_source(SourceText.of("s", f"{HEAD}soft a: {formula}\n"), params).diagnostics
    return [d.code for d in found if d.code in CODES]


@pytest.mark.parametrize(
    ("formula", "code"),
    [
        ("eventually[0, T] (now <= T)", "L601"),
        ("always (now < 10)", "L601"),
        ("eventually (x > 12)", "L602"),
        ("eventually (0 <= x + d < 0)", "L602"),
        ("eventually (x > T + 3)", "L602"),
        ("always (x < 12)", "L603"),
        ("always (abs(x) >= 0)", "L603"),
        ("eventually (d <= 0)", "L604"),
        ("always not (d <= 0)", "L604"),
        ("always (x > 12 implies p)", "L607"),
        ("always (v == 3)", "L609"),
        ("always (row == 0.5)", "L609"),
        ("always (row / 3 == goal)", "L609"),
    ],
)
def test_one_report_for_each_condition_that_says_too_little(formula, code):
    assert codes(formula) == [code]


@pytest.mark.parametrize(
    "formula",
    [
        "always (now >= 5 implies x > 3)",
        "eventually (now <= T and d < 1)",
        "p until (now >= 5 and x > 3)",
        "eventually (d < 1)",
        "eventually (row == 3)",
        "always (row != goal)",
        "eventually (x > open)",
        "always (p implies x > 3)",
        "always (x > 3 iff p)",
        "always[0, open] (x > 3)",
    ],
)
def test_what_is_meant_is_not_reported(formula):
    assert codes(formula) == []


def test_a_param_counts_with_the_value_it_is_bound_to():
    assert codes("eventually (x > open)", {"open": "11"}) == ["L602"]


def test_no_trace_contradicts_what_is_said_of_a_condition():
    rng = random.Random(3)
    said = 0
    for _ in range(200):
        text = random_spec(rng)
        for found in review_source(SourceText.of("s", text)).diagnostics:
            if found.code not in ("L602", "L603", "L604", "L607"):
                continue
            said += 1
            condition = text[found.span.start : found.span.end]
            bundle = compile_source(SourceText.of("s", f"{RANGED}hard c: {condition}\n"))
            for _ in range(5):
                oracle = oracle_of(bundle, random_trace(rng))
                root = bundle.requirements[0].root
                if found.code == "L604":
                    sign = 1 if "positive" in found.message else -1
                    assert all(sign * rho <= 0 for rho in oracle.rho(root)), text
                else:
                    assert set(oracle.holds(root)) == {found.code == "L603"}, text
    assert said > 100
