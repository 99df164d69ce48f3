"""Specs of RTAMT mean here what they mean there."""

import random

import pytest

from stlspec.errors import DataError, SpecError
from stlspec.source import SourceText
from stlspec.tools.importing.conversion import convert
from tests.peers.imports import case, own_values


def text_of(text, time=None):
    return convert(SourceText.of("f", text), "rtamt", time).text


def formula_of(text):
    return text_of(f"out = {text}", "step").split("hard out:\n    ")[1].strip()


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("always[0:5](x >= 3)", "always[0, 5] (x >= 3)"),
        ("always[0,5] x >= 3", "always[0, 5] (x >= 3)"),
        ("G[0:5](x >= 3) & F (y < 1)", "(always[0, 5] (x >= 3)) and (eventually (y < 1))"),
        ("always x > 1 until y > 2", "(always (x > 1)) until (y > 2)"),
        ("x > 1 implies y > 1 implies z > 1", "((x > 1) implies (y > 1)) implies (z > 1)"),
        ("x > 1 -> y > 1", "(x > 1) implies (y > 1)"),
        ("a - b + c > 0", "a - (b + c) > 0"),
        ("a + b - c > 0", "a + b - c > 0"),
        ("a / b * c > 0", "a / (b * c) > 0"),
        ("a > -5", "a > -5"),
        ("x > 1 since y > 1 until z > 1", "(x > 1) since ((y > 1) until (z > 1))"),
        ("always(req)", "always (req > 0)"),
        ("x and y", "(x > 0) and (y > 0)"),
        ("not x", "not (x > 0)"),
        ("rise(x > 1)", "(x > 1) and wprev not (x > 1)"),
        ("fall(x > 1)", "not (x > 1) and wprev (x > 1)"),
        ("prev x > 1", "wprev (x > 1)"),
        ("s_prev x > 1", "prev (x > 1)"),
        ("next x > 1", "wnext (x > 1)"),
        ("sX x > 1", "next (x > 1)"),
        ("x > 1 unless[0:3] y > 1", "(x > 1) unless[0, 3] (y > 1)"),
        ("x !== 3", "x != 3"),
        ("pow(x, 2) > abs(y)", "x ** 2 > abs(y)"),
        ("x.speed > 1", "x_speed > 1"),
    ],
)
def test_a_formula_keeps_its_meaning(text, written):
    assert formula_of(text) == written


def test_bounds_have_units_and_constants_become_params():
    text = "const float T = 5\nconst float c = 3\nfloat x\nout = always[0:T](x > c) and eventually[0:500 ms](x > 0)"
    assert text_of(text) == (
        "time 1 s\n\nparam T = 5 s\nparam c = 3\n\nsignal x\n\nhard out:\n"
        "    (always[0, T] (x > c)) and (eventually[0, 500 ms] (x > 0))\n"
    )
    both = text_of("const float T = 5\nout = always[0:T](x > T)", "s")
    assert "param T = 5\n" in both and "always[0, T * 1 s] (x > T)" in both
    assert "always[0, T * 1 ms] (x > 0)" in text_of("const float T = 5\nout = always[0:T ms](x > 0)")


def test_assertions_that_others_use_are_lets_and_the_last_is_a_requirement():
    written = text_of("specification two\nnear = x < 1;\nout = always near;")
    assert written.startswith("spec two\n\ntime 1 s\n\nsignal x\n\nlet near = x < 1\n\nhard out:\n    always near")


def test_declared_outputs_that_are_assigned_are_no_signals():
    assert "signal out" not in text_of("input float x\noutput float out\nout = always(x > 1)")


def test_words_of_this_language_are_renamed_and_read_from_their_column():
    written = text_of("float signal\nfloat hard\nout = signal > hard")
    assert 'signal signal_ from "signal"' in written and "signal_ > hard_" in written


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("out = abs(x > 1) > 0", "S040", "x > 1"),
        ("out = (x > 1) > 2", "S040", "x > 1"),
        ("out = log(x, y) > 1", "S040", "log"),
        ("complex z\nout = x > 1", "S040", "complex"),
        ("Pose p\nout = x > 1", "S041", "p"),
        ("from geometry import Pose\nout = x > 1", "S040", "from"),
        ("@ topic(x, y)\nout = x > 1", "S040", "@"),
        ("float x = 3\nout = x > 1", "S040", "="),
        ("out = always[0:T] x > 1", "S040", "T"),
        ("out = always[0:5 ps] x > 1", "S040", "ps"),
        ("out = x > 1\nout = x > 2", "S040", "out"),
        ("out = x > ", "S041", ""),
        ("out = always[0:5 x > 1", "S041", "x"),
        ("out = x => 1", "S041", "="),
        ("out = (x > 1", "S041", ""),
        ("out = always[5:1] x > 1", "I401", "[5:1]"),
    ],
)
def test_what_cannot_be_carried_is_said_at_its_place(text, code, place):
    with pytest.raises(SpecError) as caught:
        text_of(text)
    found = [(p.code, p.source.slice(p.span)) for p in caught.value.diagnostics if p.severity == "error"]
    assert found == [(code, place)]


def test_every_broken_statement_is_reported_in_one_run():
    with pytest.raises(SpecError) as caught:
        text_of("complex z\na = x >\nb = log(x) > 1\nc = x > 1")
    assert [p.code for p in caught.value.diagnostics] == ["S040", "S041", "S040"]


def test_where_the_robustness_differs_it_is_said():
    (warning,) = convert(SourceText.of("f", "out = x > 1 iff y > 1"), "rtamt").warnings
    assert (warning.code, warning.severity) == ("S042", "warning")


def test_few_brackets_and_all_brackets_mean_the_same_in_random_specs():
    rng = random.Random(2)
    for _ in range(150):
        few, full, signals = case(rng)
        try:
            assert own_values(few, signals) == own_values(full, signals), few
        except DataError:  # 0 / 0 has no value, with whatever brackets
            with pytest.raises(DataError):
                own_values(full, signals)
