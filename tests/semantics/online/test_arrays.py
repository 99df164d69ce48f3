"""Enclosures over arrays, by hand; the comparison with the naive recursion is in test_monitor.py."""

import numpy as np

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.arrays import enclosures, needed, open_from, stretch, three
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import PERIOD, STAMPS, STEP, bundle_of

INF = float("inf")


def plan_of(build, base=STEP, ends="any", high=2.0):
    builder = Builder()
    p, q = (
        builder.add("gt", [builder.add("signal", value=name), builder.add("const", value=0.0)]) for name in ("x", "y")
    )
    root = build(builder, p, q)
    signals = (Signal("x", low=-1.0, high=high), Signal("y", low=-3.0, high=4.0))
    return make_plan(bundle_of(tuple(builder.nodes), (Requirement("r", "hard", root),), signals, base), ends), root


def rows(plan, root, times, **columns):
    inputs, others = needed(plan, [root])
    values = [np.array(columns["xy"[k]], dtype=float) for k in range(len(inputs))]
    return three(enclosures(stretch(plan, np.array(times)), inputs, others, values)[root]).tolist()


def test_an_open_window_takes_in_the_tail_on_the_side_that_it_can_worsen():
    plan, root = plan_of(lambda b, p, q: b.add("always", [p], interval=(0, 1)))
    assert rows(plan, root, [0, 1, 2], x=[1, 3, 2]) == [[1, 1, 1], [2, 2, 2], [-1, 2, 2]]
    plan, root = plan_of(lambda b, p, q: b.add("always", [p], interval=(0, 1)), ends="horizon", high=1.5)
    assert rows(plan, root, [0, 1, 2], x=[1, 3, 2]) == [[1, 1, 1], [2, 2, 2], [-1, 1.5, 2]]


def test_columns_that_are_equal_are_one_array():
    plan, root = plan_of(lambda b, p, q: b.add("not", [b.add("eventually", [p], interval=(0, 0))]))
    inputs, others = needed(plan, [root])
    span = stretch(plan, np.array([0, 1]))
    low, high, current = enclosures(span, inputs, others, [np.array([1.0, 3.0])])[root]
    assert low is high is current
    assert low.tolist() == [-1.0, -3.0]
    plan, root = plan_of(lambda b, p, q: b.add("always", [p], interval=(0, 1)))
    span = stretch(plan, np.array([0, 1]))
    low, high, current = enclosures(span, *needed(plan, [root]), [np.array([1.0, 3.0])])[root]
    assert high is current
    assert low.tolist() == [1.0, -1.0]


def test_three_columns_stand_side_by_side():
    ones, twos = np.array([1.0, 4.0]), np.array([2.0, 5.0])
    assert three((ones, twos, ones), 1).tolist() == [[4.0, 5.0, 4.0]]


def test_until_needs_its_left_operand_at_samples_to_come_before_its_window():
    plan, root = plan_of(lambda b, p, q: b.add("until", [p, q], interval=(2, 3)))
    # At the first sample the next one is not in the window yet, so x > 0 must hold there: at most 2.
    assert rows(plan, root, [0], x=[9], y=[9]) == [[-INF, 2, -INF]]
    assert rows(plan, root, [0, 1], x=[9, 8], y=[9, 9]) == [[-INF, 4, -INF], [-INF, 2, -INF]]


def test_with_gaps_the_next_sample_may_lie_in_the_window_at_once():
    for base, times in ((STAMPS, [0]), (PERIOD, [0])):
        scale = base.period or 1
        window = (2 * scale, 3 * scale)
        plan, root = plan_of(lambda b, p, q, i=window: b.add("until", [p, q], interval=i), base)
        assert rows(plan, root, times, x=[9], y=[9]) == [[-INF, 4, -INF]]


def test_next_and_prev_at_the_ends():
    plan, root = plan_of(lambda b, p, q: b.add("next", [p]))
    assert rows(plan, root, [0, 1], x=[1, 3]) == [[3, 3, 3], [-INF, 2, -INF]]
    plan, root = plan_of(lambda b, p, q: b.add("prev", [b.add("next", [p])]))
    assert rows(plan, root, [0, 1], x=[1, 3]) == [[-INF, -INF, -INF], [3, 3, 3]]


def test_negation_swaps_low_and_high():
    plan, root = plan_of(lambda b, p, q: b.add("not", [b.add("always", [p], interval=(0, 1))]))
    assert rows(plan, root, [0], x=[1]) == [[-1, 1, -1]]


def test_the_first_open_window_is_the_first_that_ends_after_the_newest_sample():
    plan, _ = plan_of(lambda b, p, q: p)
    span = stretch(plan, np.array([0, 1, 2, 3]))
    assert [open_from(span, high) for high in (0, 1, 3, 9, None)] == [4, 3, 1, 0, 0]
