"""The slopes of the real operators are those of the school book, and finite differences agree."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stlspec.compiler.ir import Builder
from stlspec.semantics.expressions import expression_values
from stlspec.semantics.slopes import operand_slopes
from stlspec.traces import make_trace
from tests.strategies import DECLARED, SECONDS

INF = float("inf")
STAMPS = [0.0, 0.1, 0.4]


def slopes(op, *operands):
    """d sum / d operand of an operator on constant operands over three samples, as lists."""
    builder = Builder()
    children = [builder.add("signal", value="x") for _ in operands]
    index = builder.add(op, children)
    trace = make_trace(SECONDS, DECLARED[:1], {"x": np.zeros(3)}, STAMPS)
    arrays = [np.broadcast_to(np.asarray(o, dtype=float), 3) for o in operands]
    with np.errstate(all="ignore"):
        values = expression_values(builder.nodes, index, arrays, trace)
        found = operand_slopes(builder.nodes[index], arrays, values, np.ones(3), trace)
    return [f.tolist() for f in found]


def first(op, *operands):
    return [f[0] for f in slopes(op, *operands)]


@pytest.mark.parametrize(
    ("op", "operands", "expected"),
    [
        ("neg", [2], [-1]),
        ("add", [1, 2, 3], [1, 1, 1]),
        ("sub", [1, 2], [1, -1]),
        ("mul", [2, 3, 5], [15, 10, 6]),
        ("mul", [0, 3, 0], [0, 0, 0]),
        ("mul", [0, 3], [3, 0]),
        ("div", [6, 2], [0.5, -1.5]),
        ("abs", [-2], [-1]),
        ("abs", [0], [0]),
        ("min", [1, 2, 1], [1, 0, 0]),
        ("max", [1, 2, 2], [0, 1, 0]),
        ("sqrt", [4], [0.25]),
        ("sqrt", [0], [INF]),
        ("exp", [0], [1]),
        ("log", [4], [0.25]),
        ("log", [0], [INF]),
        ("sin", [0], [1]),
        ("cos", [0], [0]),
        ("hypot", [3, 4], [0.6, 0.8]),
        ("hypot", [0, 0], [0, 0]),
        ("pow", [2, 3], [12, 8 * np.log(2)]),
        ("pow", [0, 2], [0, 0]),
        ("pow", [0, 0], [0, -INF]),
        ("pow", [-2, 2], [-4, np.nan]),
    ],
)
def test_slopes_by_hand(op, operands, expected):
    assert first(op, *operands) == pytest.approx(expected, nan_ok=True)


def test_a_change_has_a_slope_at_both_of_its_samples():
    assert slopes("delta", [1, 2, 5]) == [[-1, 0, 1]]
    assert slopes("rate", [1, 2, 5]) == [pytest.approx([-10, 10 - 1 / 0.3, 1 / 0.3])]


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(["mul", "div", "hypot", "pow", "sub"]), st.floats(0.2, 4), st.floats(0.2, 4))
def test_finite_differences_agree(op, x, y):
    functions = {"mul": np.multiply, "div": np.divide, "hypot": np.hypot, "pow": np.power, "sub": np.subtract}
    f, h = functions[op], 1e-6
    expected = [(f(x + h, y) - f(x - h, y)) / (2 * h), (f(x, y + h) - f(x, y - h)) / (2 * h)]
    assert first(op, x, y) == pytest.approx(expected, rel=1e-5, abs=1e-6)
