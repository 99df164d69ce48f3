"""Rates are shown in the unit that was written, and nothing else is given a unit."""

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.compiler.ir import COMPARISONS
from stlspec.compiler.rates import written_unit
from stlspec.semantics.evaluation import evaluate
from stlspec.semantics.explain import explain
from stlspec.source import SourceText

HEAD = 'time 100 ms\nsignal alt unit "m"\nsignal w unit "m"\nsignal plain\n'
DATA = {"alt": [10, 9.9, 9.6, 9.6], "w": [0, 0, 0, 0], "plain": [0, 1, 2, 3]}


def compiled(formula, head=HEAD, more=""):
    return compile_source(SourceText.of("s", f"{head}{more}hard a: {formula}\n"))


def unit_in(formula, head=HEAD, more=""):
    bundle = compiled(formula, head, more)
    found = [written_unit(bundle, i) for i, node in enumerate(bundle.nodes) if node.op in COMPARISONS]
    return found[0] if len(found) == 1 else found


@pytest.mark.parametrize(
    ("formula", "unit", "value"),
    [
        ("always (rate(alt) >= -2 m/s)", "m/s", -2.0),
        ("always (abs(rate(alt)) < 120 m/min)", "m/min", 120.0),
        ("always (rate(rate(alt)) < 3 m/s**2)", "m/s**2", 3.0),
        ("always (rate(alt) - rate(w) < 3 m/s)", "m/s", 3.0),
    ],
)
def test_a_rate_is_in_the_unit_that_was_written(formula, unit, value):
    bundle = compiled(formula)
    found = unit_in(formula)
    (constant,) = {float(n.value) for n in bundle.nodes if n.op == "const"}
    assert (found.unit, found.of(constant)) == (unit, value)


def test_of_two_units_each_comparison_keeps_its_own():
    found = unit_in("always (rate(alt) < 2 m/s and rate(w) < 60 m/min)")
    assert [f.unit for f in found] == ["m/s", "m/min"]


def test_the_unit_of_a_param_is_one_that_was_written():
    assert unit_in("always (rate(alt) < v)", more="param v = 2 m/s\n").unit == "m/s"


@pytest.mark.parametrize(
    ("formula", "head"),
    [
        ("always (alt < 3 m)", HEAD),
        ("always (rate(alt) < 3)", HEAD),
        ("always (rate(plain) < 3)", HEAD),
        ("always (rate(alt) * 2 < 3 m/s)", HEAD),  # the factor may have a unit of its own
        ("always (rate(x) < 3)", "signal x\n"),
    ],
)
def test_what_has_no_written_unit_is_left_alone(formula, head):
    assert unit_in(formula, head) is None


def test_reasons_and_explanations_show_it_wherever_they_are_made():
    bundle = compiled("always (rate(alt) >= -2 m/s)")
    result = evaluate(bundle, DATA)["a"]
    said = "rate(alt) = -3 m/s, needs >= -2 m/s"
    assert result.reason == said
    found = explain(bundle, "a", result)
    assert found.reason == said
    assert [step.text for step in found.steps][-1] == "rate(alt) >= -2 m/s"
