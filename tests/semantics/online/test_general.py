"""The engine for any depth, by hand; random cases are in test_monitor.py."""

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.general import NOWHERE, General, inputs_of
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import STEP, bundle_of

INF = float("inf")


def engine(build, ends="any", origin=0):
    b = Builder()
    p = b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.0)])
    root = build(b, p)
    signals = (Signal("x", low=-1.0, high=5.0),)
    plan = make_plan(bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), signals, STEP), ends)
    return General(plan, root, origin), plan, root, p


def three_levels(b, p):
    """always eventually[0, 1] always[0, 1] x > 0."""
    stable = b.add("always", [p], interval=(0, 1))
    return b.add("always", [b.add("eventually", [stable], interval=(0, 1))], interval=(0, None))


def test_three_levels_by_hand():
    general, plan, root, p = engine(three_levels)
    assert inputs_of(plan, root) == (p,)
    told = [general.step(t, v) for t, v in enumerate([3.0, 2.0, 4.0, 1.0])]
    # The inner always is 2, 2, 1 at samples 0, 1, 2 as soon as the sample after each is known, so eventually is
    # 2 at sample 0 from the second sample on, and at most 1 at sample 2 from the fourth on.
    assert told == [(-1, 5, 3), (-1, 2, 2), (-1, 2, 2), (-1, 1, 1)]


def test_samples_that_cannot_change_are_folded():
    general, *_ = engine(three_levels)
    for t in range(500):
        general.step(t, 1.0 + t % 3)
    assert general.folded >= 498
    assert len(general.tape.times) < 200


def test_a_formula_that_is_known_keeps_nothing():
    general, *_ = engine(
        lambda b, p: b.add("until", [b.add("next", [p]), b.add("always", [p], interval=(0, 1))], interval=(0, 2))
    )
    told = [general.step(t, 2.0) for t in range(6)]
    assert told[-1] == (2, 2, 2)
    assert len(general.tape.times) == 0


def test_before_its_sample_there_is_nothing_to_say():
    general, *_ = engine(three_levels, origin=2)
    assert [general.step(t, 9.0) == NOWHERE for t in range(3)] == [True, True, False]
