"""What the checks know of an expression."""

import pytest

from stlspec.compiler.checks import check
from stlspec.compiler.model import BROKEN, FORMULA, Binding, Typing
from stlspec.lang.parse import parse
from stlspec.source import SourceText


def test_a_model_tells_the_typing_of_every_expression():
    source = SourceText.of("s", 'signal v unit "m"\nparam k = 2\nhard a: v + k > 3')
    model, _ = check(parse(source))
    formula = model.declared.requirements["a"].formula
    total, three = formula.operands
    assert model.typing(formula) == FORMULA
    assert model.typing(total) == Typing("real", {"m": 1})
    assert model.typing(three) == Typing("real", None, True, 3.0)
    assert model.source is source


def test_what_was_reported_is_broken():
    model, problems = check(parse(SourceText.of("s", "hard a: z > 1")))
    formula = model.declared.requirements["a"].formula
    assert [d.code for d in problems] == ["N101"]
    assert model.typing(formula.operands[0]) == BROKEN


@pytest.mark.parametrize("unit", [None, "ms"])
def test_a_binding_brings_a_unit_only_where_the_text_has_none(unit):
    model, _ = check(
        parse(SourceText.of("s", "param T = 5 s\nparam U\nhard a: true")), dict.fromkeys("TU", Binding(3.0, unit))
    )
    assert [(p.value, p.unit) for p in model.params.values()] == [(3.0, "s"), (3.0, unit)]
