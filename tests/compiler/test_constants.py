"""Folding gives what IEEE 754 gives, and never raises."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.compiler.constants import FOLDABLE, fold

INF, NAN = math.inf, math.nan
ARITY = {"neg": 1, "abs": 1, "sqrt": 1, "exp": 1, "log": 1, "sin": 1, "cos": 1}


@pytest.mark.parametrize(
    ("op", "operands", "expected"),
    [
        ("add", [1, 2, 3], 6),
        ("add", [INF, -INF], NAN),
        ("sub", [5, 7], -2),
        ("mul", [2, 3, 4], 24),
        ("mul", [0, INF], NAN),
        ("div", [1, 0.0], INF),
        ("div", [1, -0.0], -INF),
        ("div", [0, 0], NAN),
        ("div", [-3, 2], -1.5),
        ("pow", [2, 10], 1024),
        ("pow", [0, -1], INF),
        ("pow", [-0.0, -1], -INF),
        ("pow", [0, -INF], INF),
        ("pow", [-8, 1 / 3], NAN),
        ("pow", [10, 400], INF),
        ("pow", [-10, 401], -INF),
        ("pow", [-10, 400], INF),
        ("pow", [0, 0], 1),
        ("sqrt", [-1], NAN),
        ("sqrt", [4], 2),
        ("exp", [1000], INF),
        ("exp", [-1000], 0),
        ("log", [0], -INF),
        ("log", [-1], NAN),
        ("sin", [INF], NAN),
        ("min", [3, 1, 2], 1),
        ("max", [3, 1, 2], 3),
        ("hypot", [3, 4], 5),
        ("neg", [2], -2),
        ("abs", [-2], 2),
        ("abs", [NAN], NAN),
    ],
)
def test_a_constant_is_what_the_engine_would_give(op, operands, expected):
    found = fold(op, [float(x) for x in operands])
    assert found == expected or (math.isnan(found) and math.isnan(expected))


@given(st.sampled_from(sorted(FOLDABLE)), st.floats(), st.floats())
def test_folding_never_raises(op, a, b):
    assert isinstance(fold(op, [a, b][: ARITY.get(op, 2)]), float)
