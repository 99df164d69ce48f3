"""Ranges of expressions and predicates hold every value, and are tight where that is easy."""

import random

import numpy as np
import pytest

from stlspec.compiler.bundle import Signal, TimeBase
from stlspec.compiler.ir import REAL, Builder
from stlspec.compiler.ranges import INF, WHOLE, value_ranges
from stlspec.errors import DataError
from stlspec.semantics.robustness import TIE, evaluate_nodes
from stlspec.traces import make_trace
from tests.strategies import random_expression

STEP = TimeBase("step", "step", 1)


def range_of(build, x=WHOLE, y=WHOLE, base=STEP):
    builder = Builder()
    root = build(builder)
    signals = [Signal("x", low=x[0], high=x[1]), Signal("y", low=y[0], high=y[1])]
    return value_ranges(builder.nodes, signals, base)[root]


def real(op, *operands):
    """A builder of an expression over signals (texts) and numbers."""

    def build(b):
        return b.add(op, [o(b) if callable(o) else leaf(o)(b) for o in operands])

    return build


def leaf(value):
    if isinstance(value, str):
        return lambda b: b.add("signal", value=value) if value != "now" else b.add("now")
    return lambda b: b.add("const", value=float(value))


@pytest.mark.parametrize(
    ("build", "expected"),
    [
        (real("add", "x", "y"), (0, 9)),
        (real("sub", "x", "y"), (-8, 1)),
        (real("mul", "x", "y"), (-12, 18)),
        (real("div", "y", 2), (1, 3)),
        (real("div", "x", "y"), (-1, 1.5)),
        (real("div", "y", "x"), WHOLE),
        (real("neg", "x"), (-3, 2)),
        (real("abs", "x"), (0, 3)),
        (real("abs", "y"), (2, 6)),
        (real("min", "x", "y"), (-2, 3)),
        (real("max", "x", "y", 2.5), (2.5, 6)),
        (real("sqrt", "x"), (0, 3**0.5)),
        (real("sin", "x"), (-1, 1)),
        (real("delta", "x"), (-5, 5)),
        (real("sub", real("abs", "x"), 1), (-1, 2)),
        (real("add", "now", 1), (1, INF)),
    ],
)
def test_ranges_by_hand(build, expected):
    assert range_of(build, (-2.0, 3.0), (2.0, 6.0)) == expected


@pytest.mark.parametrize(
    ("build", "expected"),
    [
        (real("sub", "x", "y"), WHOLE),
        (real("sub", real("abs", "x"), 1), (-1, INF)),
        (real("mul", real("abs", "x"), real("abs", "y")), (0, INF)),
        (real("div", real("abs", "x"), real("add", real("abs", "y"), 1)), (0, INF)),
        (real("delta", "x"), WHOLE),
        (real("pow", "x", 2), (0, INF)),
    ],
)
def test_without_declared_ranges_infinities_never_become_nan(build, expected):
    assert range_of(build) == expected


def test_a_rate_depends_on_the_shortest_step():
    rate = real("rate", "x")
    assert range_of(rate, (0.0, 2.0)) == (-2, 2)
    assert range_of(rate, (0.0, 2.0), base=TimeBase("period", "ms", 10**6, 5 * 10**5)) == (-4, 4)
    assert range_of(rate, (0.0, 2.0), base=TimeBase("stamps", "s", 10)) == (-20, 20)


@pytest.mark.parametrize(
    ("op", "bound", "expected"),
    [
        ("ge", 1, (-1.0, 1.0)),
        ("ge", 2, (-2.0, TIE)),
        ("gt", 2, (-2.0, -TIE)),
        ("le", 2, (TIE, 2.0)),
        ("lt", 0, (-2.0, -TIE)),
        ("eq", 1, (-1.0, TIE)),
        ("eq", 3, (-3.0, -1.0)),
        ("ne", 1, (-TIE, 1.0)),
        ("ne", 5, (3.0, 5.0)),
        ("gt", INF, (-INF, -INF)),
    ],
)
def test_a_bound_of_a_predicate_that_is_0_knows_its_truth(op, bound, expected):
    assert range_of(real(op, "x", bound), (0.0, 2.0)) == expected


def test_equal_infinities_differ_by_0():
    assert range_of(real("ge", "x", INF)) == (-INF, TIE)
    assert range_of(real("eq", "x", "y")) == (-INF, TIE)


def test_no_value_lies_outside_its_range():
    rng = random.Random(1)
    values = 0
    for _ in range(600):
        builder = Builder()
        root = random_expression(builder, rng, 3)
        builder.add("signal", value="x")
        low, high = sorted(rng.choice([-INF, -2.0, -0.5, 0.0, 1.0, 3.0, INF]) for _ in range(2))
        signals = (Signal("x", low=low, high=high), Signal("y"))
        nodes = tuple(builder.nodes)
        ranges = value_ranges(nodes, signals, STEP)
        pool = [v for v in (-INF, -2.0, -0.7, 0.0, 0.3, 1.0, 2.9, INF) if low <= v <= high] or [low]
        for _ in range(10):
            data = {"x": [rng.choice(pool) for _ in range(3)], "y": [rng.choice([-2.0, 0.0, 1.7]) for _ in range(3)]}
            trace = make_trace(STEP, signals, data)
            try:
                found = evaluate_nodes(nodes, [i for i in range(root + 1) if nodes[i].op in REAL], trace)[-1]
            except DataError:
                continue
            values += 1
            assert np.all(found >= ranges[root][0]) and np.all(found <= ranges[root][1]), (nodes, data, ranges[root])
    assert values > 3000
