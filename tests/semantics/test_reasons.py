"""A reason names the operands' values and what is needed of them."""

import pytest

from stlspec.compiler.ir import Builder
from stlspec.semantics.reasons import reason_text
from stlspec.traces import make_trace
from tests.strategies import DECLARED, STEP

INF = float("inf")


def reason(op, left, right, negated=False, x=3.0, y=2.0):
    builder = Builder()

    def add(term):
        if isinstance(term, str):
            return builder.add("signal", value=term)
        if isinstance(term, tuple):
            return builder.add(term[0], [add(t) for t in term[1:]])
        return builder.add("const", value=float(term))

    root = builder.add(op, [add(left), add(right)])
    trace = make_trace(STEP, DECLARED[:2], {"x": [9, x], "y": [9, y]})
    return reason_text(builder.nodes, root, negated, trace, 1)


@pytest.mark.parametrize(
    ("arguments", "named", "text"),
    [
        (("ge", "x", 1), {"x": 0.0}, "x = 0, needs >= 1"),
        (("gt", ("sub", "x", "y"), 2), {"x": 5.0}, "x - y = 3, needs > 2"),
        (("gt", "x", "y"), {}, "x = 3, needs > y = 2"),
        (("le", 0, "x"), {"x": -1.0}, "x = -1, needs >= 0"),
        (("ge", "x", 1), {"negated": True}, "x = 3, needs < 1"),
        (("eq", "x", 1), {"negated": True}, "x = 3, needs != 1"),
        (("lt", 4, "x"), {"negated": True}, "x = 3, needs <= 4"),
        (("lt", 1, 2), {}, "1, needs < 2"),
        (("ge", "x", 1), {"x": INF}, "x = inf, needs >= 1"),
        (("ge", "x", 1), {"x": -0.0}, "x = 0, needs >= 1"),
    ],
)
def test_a_predicate_is_explained_by_its_operands(arguments, named, text):
    assert reason(*arguments, **named) == text


def test_numbers_are_cut_to_six_digits():
    assert reason("ge", "x", 1, x=1 / 3) == "x = 0.333333, needs >= 1"


def test_a_number_keeps_the_digits_that_tell_it_from_the_bound():
    assert reason("le", "x", 0.3, x=0.1 + 0.2) == "x = 0.30000000000000004, needs <= 0.3"


@pytest.mark.parametrize(
    ("value", "negated", "text"),
    [(False, False, "b is false, needs true"), (True, True, "b is true, needs false")],
)
def test_a_boolean_signal_is_explained_by_its_truth(value, negated, text):
    builder = Builder()
    root = builder.add("bool", value="b")
    trace = make_trace(STEP, DECLARED[2:], {"b": [value]})
    assert reason_text(builder.nodes, root, negated, trace, 0) == text
