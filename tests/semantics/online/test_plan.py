"""What is known before the first sample: settled formulas, tails, windows that begin and end on samples."""

import pytest

from stlspec.compiler.bundle import Requirement, Signal, TimeBase
from stlspec.compiler.ir import Builder, Node
from stlspec.compiler.ranges import INF
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import PERIOD, STAMPS, STEP, bundle_of


def plan_of(build, base=STEP, ends="any"):
    builder = Builder()
    root = build(builder, builder.add("gt", [builder.add("signal", value="x"), builder.add("const", value=0.0)]))
    bundle = bundle_of(
        tuple(builder.nodes), (Requirement("r", "hard", root),), (Signal("x", low=-1.0, high=2.0),), base
    )
    return make_plan(bundle, ends), root


def unary(op, low=None, high=None):
    return lambda b, p: b.add(op, [p], interval=None if low is None else (low, high))


@pytest.mark.parametrize(
    ("build", "any_end", "at_horizon"),
    [
        (lambda b, p: p, (-1, 2), (-1, 2)),
        (unary("not"), (-2, 1), (-2, 1)),
        (unary("always", 0, 3), (-1, 2), (-1, 2)),
        (unary("always", 1, 3), (-1, INF), (-1, 2)),
        (unary("eventually", 0, 3), (-1, 2), (-1, 2)),
        (unary("eventually", 1, None), (-INF, 2), (-1, 2)),
        (unary("next"), (-INF, 2), (-1, 2)),
        (unary("prev"), (-1, 2), (-1, 2)),
        (unary("historically", 0, 3), (-1, 2), (-1, 2)),
        (unary("historically", 1, 3), (-1, INF), (-1, INF)),
        (unary("once", 2, 3), (-INF, 2), (-INF, 2)),
        (lambda b, p: b.add("prev", [b.add("prev", [p])]), (-INF, 2), (-INF, 2)),
        (lambda b, p: b.add("until", [p, b.add("true")], interval=(1, 2)), (-INF, 2), (-1, 2)),
        (lambda b, p: b.add("until", [p, b.add("true")], interval=(0, 2)), (INF, INF), (INF, INF)),
        (lambda b, p: b.add("since", [p, b.add("true")], interval=(1, 2)), (-INF, 2), (-INF, 2)),
        (lambda b, p: b.add("or", [p, b.add("true")]), (INF, INF), (INF, INF)),
    ],
)
def test_the_tail_encloses_a_formula_at_a_sample_to_come(build, any_end, at_horizon):
    for ends, expected in (("any", any_end), ("horizon", at_horizon)):
        plan, root = plan_of(build, ends=ends)
        assert plan.tails[root] == expected


def test_what_looks_ahead_is_not_settled():
    plan, root = plan_of(lambda b, p: b.add("and", [b.add("once", [p], interval=(0, 3)), b.add("next", [p])]))
    assert [plan.nodes[i].op for i in range(root + 1) if not plan.settled[i]] == ["next", "and"]


@pytest.mark.parametrize(
    ("base", "ends", "expected"),
    [
        (STEP, "any", (1, True, False)),
        (STEP, "horizon", (1, True, True)),
        (PERIOD, "any", (20, False, False)),
        (PERIOD, "horizon", (20, True, True)),
        (STAMPS, "any", (1, False, False)),
        (STAMPS, "horizon", (1, False, False)),
    ],
)
def test_only_even_samples_can_be_promised(base, ends, expected):
    plan, _ = plan_of(unary("next"), base, ends)
    assert (plan.stride, plan.dense, plan.certain) == expected


def test_windows_begin_and_end_on_samples():
    base = TimeBase("period", "ms", 1, 20)
    plan, root = plan_of(unary("always", 15, 75), base)
    assert plan.nodes[root].interval == (20, 60)
    plan, root = plan_of(unary("eventually", 41, 59), base)
    assert plan.nodes[root] == Node("false")
