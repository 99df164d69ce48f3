"""A requirement that looks at the first sample only is told so, whatever its lets are called."""

import pytest

from stlspec.compiler.review import review_source
from stlspec.source import SourceText

HEAD = "signal x\nsignal p: bool\nsignal q: bool\nparam open\nlet low = x < 3\nlet never(y) = always not y\n"


def found_in(formula):
    found = review_source(SourceText.of("s", f"{HEAD}soft a: {formula}\n")).diagnostics
    return [d for d in found if d.code in ("L611", "L620")]


@pytest.mark.parametrize("formula", ["x <= 3", "p", "low", "not p", "p implies x > open", "delta(x) > 1", "(low or p)"])
def test_a_requirement_without_an_operator_of_time_is_found(formula):
    (found,) = found_in(formula)
    assert (found.code, found.severity) == ("L620", "warning") and "first sample only" in found.message


@pytest.mark.parametrize("formula", ["once p", "historically (x > 3)", "(once p) and q", "p since q"])
def test_a_requirement_on_the_past_alone_is_found(formula):
    assert [d.code for d in found_in(formula)] == ["L611"]


@pytest.mark.parametrize(
    "formula",
    ["always low", "x < 3 and eventually p", "p implies next q", "never(p)", "p until q", "true", "1 < 2", "open > 3"],
)
def test_what_looks_ahead_or_at_no_signal_is_left_alone(formula):
    assert found_in(formula) == []


@pytest.mark.parametrize(
    ("formula", "always"),
    [
        ("x <= 3", "always (x <= 3)"),
        ("low", "always low"),
        ("(low or p)", "always (low or p)"),
        ("not p", "always (not p)"),
        ("once p", "always (once p)"),
    ],
)
def test_the_two_operators_that_are_meant_are_fixes_and_the_first_is_shown(formula, always):
    (found,) = found_in(formula)
    assert f"`{always}`" in found.help
    text = found.source.text
    after = [fix.applied(text) for fix in found.fixes]
    assert after == [
        text.replace(f"soft a: {formula}", f"soft a: {word}")
        for word in (always, always.replace("always", "eventually"))
    ]


def test_an_initial_condition_is_said_to_be_one():
    assert [d.code for d in found_in("x < 3  # stlspec: ignore L620 - the start")] == []
