"""Specs of Breach and STLRom mean here what they mean there."""

import pytest

from stlspec.errors import SpecError
from stlspec.source import SourceText
from stlspec.tools.importing.conversion import convert


def conversion(text, time="step"):
    return convert(SourceText.of("f", text), "breach", time)


def formula_of(text):
    return conversion(f"phi := {text}").text.split("hard phi:\n    ")[1].strip()


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("alw_[0, 5] (x[t] > 0)", "always[0, 5] (x > 0)"),
        ("alw_[0 5] (x[t] > 0)", "always[0, 5] (x > 0)"),
        ("ev (x[t] > 0)", "eventually (x > 0)"),
        ("alw x[t] > 0 and ev y[t] < 1", "(always (x > 0)) and (eventually (y < 1))"),
        ("not x[t] > 0 and y[t] > 0", "not (x > 0) and (y > 0)"),
        ("x[t] > 0 or y[t] > 0 and z[t] > 0", "(x > 0) or ((y > 0) and (z > 0))"),
        ("x[t] > 0 => y[t] > 0 or z[t] > 0", "((x > 0) implies (y > 0)) or (z > 0)"),
        ("x[t] > 0 => y[t] > 0 => z[t] > 0", "(x > 0) implies ((y > 0) implies (z > 0))"),
        ("x[t] > 0 until_[0, 3] y[t] > 0 and z[t] > 0", "((x > 0) until[0, 3] (y > 0)) and (z > 0)"),
        ("(x[t] > 0) until (y[t] > 0)", "(x > 0) until (y > 0)"),
        ("abs(x[t] - y[t])/2 < 3*z[t]^2", "abs(x - y) / 2 < 3 * z ** 2"),
        ("-x[t]^2 < .5", "-x ** 2 < 0.5"),
        ("+x[t] < 5.", "x < 5"),
        ("[]_[0, 2] x[t] > 0 & <>_[1, 2] x[t] > 0", "(always[0, 2] (x > 0)) and (eventually[1, 2] (x > 0))"),
        ("once_[0, 2] x[t] > 0", "once[0, 2] (x > 0)"),
        ("hist (x[t] > 0)", "historically (x > 0)"),
        ("alw_[0, Inf] true", "always[0, inf] true"),
        ("x[t] == 2", "x == 2"),
    ],
)
def test_a_formula_keeps_its_meaning(text, written):
    assert formula_of(text) == written


def test_a_file_of_declarations_and_formulas_in_its_order_with_its_comments():
    text = """# Automatic transmission
signal speed, gear
param vmax = 150, t1=1   # default values

gear2 := gear[t]==2
phi := alw_[0, t1+.5] (gear2 => ev_[0, 2*t1]
   (speed[t] < vmax))
"""
    assert conversion(text, None).text == (
        "time s\n\n# Automatic transmission\nsignal speed\nsignal gear\n\nparam vmax = 150\n\n"
        "# default values\nparam t1 = 1 s\n\nlet gear2 = gear == 2\n\n"
        "hard phi:\n    always[0, t1 + 0.5 s] (gear2 implies eventually[0, 2 * t1] (speed < vmax))\n"
    )


def test_signals_that_are_not_declared_are_told_by_their_index_and_params_wait_for_a_value():
    found = conversion("phi := alw (x[t] > low)")
    assert found.text.startswith("time step\n\nsignal x\n\nparam low\n")
    (warning,) = found.warnings
    assert warning.code == "S042" and "`low` has no value" in warning.message


@pytest.mark.parametrize(
    "text",
    [
        "x[t] > 0 and y[t] > 0 or z[t] > 0",
        "x[t] > 0 or y[t] > 0 and z[t] > 0",
        "x[t] > 0 => y[t] > 0 and z[t] > 0",
        "not x[t] > 0 until_[0, 1] y[t] > 0",
    ],
)
def test_where_stlrom_reads_another_order_it_is_said(text):
    (warning,) = conversion(f"phi := {text}").warnings
    assert warning.code == "S042" and "STLRom" in warning.help


@pytest.mark.parametrize("text", ["(x[t] > 0 and y[t] > 0) or z[t] > 0", "x[t] > 0 and y[t] > 0 and z[t] > 0"])
def test_brackets_leave_nothing_to_say(text):
    assert conversion(f"phi := {text}").warnings == ()


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("phi := x[t+1] > 0", "S040", "x[t+1]"),
        ("phi := x[t+dt] - x[t] > 0", "S040", "x[t+dt]"),
        ("phi := norm(x[t]) > 0", "S040", "norm"),
        ("phi := av_ev_[0, 2] (x[t] > 0)", "S040", "av_ev_"),
        ('phi := x[t] > 0\ntest t1: "env", 20', "S040", "test"),
        ("param a = 1\nparam a = 2\nphi := x[t] > a", "S040", "a"),
        ("phi := x[t] > 0\nphi := x[t] > 1", "S040", "phi"),
        ("signal x\nphi := x > 0", "S040", "x"),
        ("param T = 2\nphi := alw_[0, T*T] (x[t] > 0)", "S040", "T*T"),
        ("phi := alw_[0, 5 (x[t] > 0)", "S041", "("),
        ("phi := (x[t] > 0", "S041", ""),
        ("phi := x[t] > 0)", "S041", ")"),
        ("phi alw (x[t] > 0)", "S041", "alw"),
        ("param a\nphi := x[t] > 0", "S041", "phi"),
        ("phi := x[t] > 0 y[t]", "S041", "y"),
        ("phi := alw x[t]", "T201", "x"),
        ("phi := alw_[5, 1] (x[t] > 0)", "I401", "[5, 1]"),
    ],
)
def test_what_cannot_be_carried_is_said_at_its_place(text, code, place):
    with pytest.raises(SpecError) as caught:
        conversion(text, "s")
    found = [(p.code, p.source.slice(p.span)) for p in caught.value.diagnostics if p.severity == "error"]
    assert found == [(code, place)]


def test_the_same_value_twice_is_no_contradiction():
    assert conversion("param a = 1\nparam a = 1\nphi := x[t] > a").text.count("param a") == 1
