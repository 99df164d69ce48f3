"""`end="interval"`: what is known of a recorded trace that may go on. Random cases are in test_monitor.py."""

import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.errors import DataError
from stlspec.semantics.online import interval_evaluate
from tests.semantics.online.cases import STEP, bundle_of

INF = float("inf")


def bundle():
    """avoid: always x >= 1; reach: eventually[0, 2] x > 3, with x up to 10."""
    b = Builder()
    x = b.add("signal", value="x")
    avoid = b.add("always", [b.add("ge", [x, b.add("const", value=1.0)])], interval=(0, None))
    reach = b.add("eventually", [b.add("gt", [x, b.add("const", value=3.0)])], interval=(0, 2))
    roots = {"avoid": avoid, "reach": reach}
    return bundle_of(
        tuple(b.nodes), tuple(Requirement(n, "hard", r) for n, r in roots.items()), (Signal("x", high=10.0),), STEP
    )


def test_an_undecided_requirement_by_hand():
    found = interval_evaluate(bundle(), {"x": [2, 1]})
    avoid, reach = found["avoid"], found["reach"]
    assert (avoid.low, avoid.high, avoid.robustness, avoid.verdict) == (-INF, 0.0, 0.0, "undecided")
    assert (reach.low, reach.high, reach.robustness, reach.verdict) == (-1.0, 7.0, -1.0, "undecided")
    assert (reach.lows.tolist(), reach.highs.tolist()) == ([-1, -2], [7, 7])


def test_a_decided_requirement_by_hand():
    found = interval_evaluate(bundle(), {"x": [2, 0, 1]})
    assert [found[n].verdict for n in ("avoid", "reach")] == ["violated", "violated"]
    assert found["reach"].high == -1.0


def test_any_sample_can_be_asked_for():
    assert interval_evaluate(bundle(), {"x": [2, 0, 4]}, at=-1)["reach"].low == 1.0
    with pytest.raises(IndexError):
        interval_evaluate(bundle(), {"x": [2]}, at=1)


def test_bad_signals_are_refused():
    with pytest.raises(DataError, match="D801"):
        interval_evaluate(bundle(), {"x": [1, float("nan")]})
