"""always and until over settled formulas, by hand; random cases are in test_monitor.py."""

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Node
from stlspec.semantics.online.outermost import NOWHERE, Always, First, Starting, Until
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import STAMPS, STEP, bundle_of

INF = float("inf")


def plan(base=STEP, ends="any"):
    bundle = bundle_of((Node("true"),), (Requirement("r", "hard", 0),), (Signal("x"),), base)
    return make_plan(bundle, ends)


def test_always_waits_for_its_window_and_closes_with_it():
    always = Always(plan(), (1, 2), (-5.0, 5.0))
    assert [always.step(t, v) for t, v in enumerate([0.0, 3.0, 2.0, 1.0])] == [
        (-5, INF, INF),
        (-5, 3, 3),
        (2, 2, 2),
        (2, 2, 2),
    ]


def test_promised_samples_bound_the_high_end_too():
    always = Always(plan(ends="horizon"), (0, 1), (-5.0, 5.0))
    assert always.step(0, 7.0) == (-5, 5, 7)


def test_uneven_samples_may_come_until_the_window_has_passed():
    always = Always(plan(STAMPS), (0, 5), (-5.0, 5.0))
    assert always.step(0, 1.0) == (-5, 1, 1)
    assert always.step(4, 2.0) == (-5, 1, 1)
    assert always.step(9, 0.0) == (1, 1, 1)


def test_until_is_one_clamp():
    until = Until(plan(), (1, 3), (-9.0, 4.0), (-9.0, 6.0))
    # Sample 1 is in the window, so x there need not hold; from then on the best so far counts.
    assert until.step(0, 5.0, 9.0) == (-INF, 5.0, -INF)
    assert until.step(1, 2.0, 1.0) == (1.0, 2.0, 1.0)
    assert until.step(2, 0.5, 3.0) == (2.0, 2.0, 2.0)
    assert until.step(3, 9.0, 9.0) == (2.0, 2.0, 2.0)


def test_until_counts_the_left_operand_at_samples_to_come_before_its_window():
    until = Until(plan(), (2, 3), (-9.0, 4.0), (-9.0, 6.0))
    assert until.step(0, 5.0, 9.0) == (-INF, 4.0, -INF)


def test_the_first_value_counts():
    first = First()
    assert [first.step(t, v) for t, v in ((0, 2.0), (1, 3.0))] == [(2, 2, 2)] * 2


def test_an_engine_can_start_at_a_later_sample():
    late = Starting(Always(plan(), (0, 0), (-5.0, 5.0)), 1)
    assert late.step(3, 9.0) == NOWHERE
    assert late.step(5, 2.0) == (2, 2, 2)
    assert late.step(7, 1.0) == (2, 2, 2)
