"""Generated cases stay inside the fragment of their tool, and stlspec agrees with the definition on them."""

import random

import pytest

from tests.peers.compare import defined_values, own_values
from tests.peers.fragments import FRAGMENTS, random_case
from tests.peers.syntax import WRITERS


def cases(tool, count=60):
    rng = random.Random(f"7 {tool}")
    return [random_case(FRAGMENTS[tool], rng) for _ in range(count)]


def parts(formula):
    """All sub-formulas."""
    yield formula
    for part in formula[1:]:
        if isinstance(part, list) and part and isinstance(part[0], str):
            yield from parts(part)


@pytest.mark.parametrize("tool", FRAGMENTS)
def test_every_generated_formula_has_a_spelling_for_its_tool(tool):
    fragment = FRAGMENTS[tool]
    allowed = {*fragment.unary, *fragment.timed, *fragment.paired, "and", "or", "implies", "pred", "bool"}
    for case in cases(tool, 300):
        assert WRITERS[tool](case.formula)
        assert {part[0] for part in parts(case.formula)} <= allowed
        assert len(case.times) >= fragment.shortest


@pytest.mark.parametrize("tool", FRAGMENTS)
def test_stlspec_agrees_with_the_definition_on_what_the_tools_are_asked(tool):
    for case in cases(tool):
        assert own_values(case) == defined_values(case)


@pytest.mark.parametrize("tool", FRAGMENTS)
def test_stlspec_agrees_with_the_definition_where_a_tool_is_at_fault(tool):
    for fault in FRAGMENTS[tool].faults:
        assert own_values(fault.case) == defined_values(fault.case), fault.reason


def test_reelay_is_not_asked_where_it_is_at_fault():
    for case in cases("reelay", 300):
        for part in parts(case.formula):
            if part[0] in ("H", "O", "S"):
                assert part[1] != [0, 0]
            if part[0] == "S" and part[1] is not None:
                assert part[1][0] == 0
