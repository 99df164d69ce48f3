"""Probabilities under chance: by hand, against brute force, and against Wilson's printed values."""

import itertools

import pytest

from stlspec import api
from stlspec.learning.memory import make_machine
from stlspec.learning.satisfaction import exact, from_runs, wilson
from stlspec.learning.shaping import GOAL, RUNS, VIOLATION

OUTCOMES = (
    (((0.5, 0), (0.3, 1), (0.2, 2)),),
    (((1.0, 1),),),
    (((1.0, 2),),),
)
"""State 0 stays with 1/2, reaches the goal 1 with 3/10, falls into 2 with 2/10."""
ENDINGS = (RUNS, GOAL, VIOLATION)
GOALS, HOLES = (False, True, False), (False, False, True)
SPEC = """
signal g : bool
signal h : bool
hard avoid: always not h
soft reach depends on avoid: eventually g
soft fast depends on reach: eventually[0, 2] g
"""


def value(nodes, index, state):
    """Evaluate a Boolean combination of g and h in a state."""
    node = nodes[index]
    parts = [value(nodes, child, state) for child in node.children]
    if node.op == "bool":
        return {"g": GOALS, "h": HOLES}[node.value][state]
    return {"not": lambda: not parts[0], "and": lambda: all(parts), "or": lambda: any(parts)}[node.op]()


def probability(text, max_steps, endings=ENDINGS):
    bundle = api.compile(text)
    machine = make_machine(bundle.nodes, [r.root for r in bundle.requirements], bundle.time)
    holds = [[value(bundle.nodes, source, state) for source in machine.sources] for state in range(3)]
    return exact(bundle, machine, holds, OUTCOMES, (0, 0, 0), endings, 0, max_steps)


@pytest.mark.parametrize("limit", [1, 2, 5, 30])
def test_a_chain_by_hand(limit):
    """Within k steps: the goal with 3/10 (1 - 2^-k) / (1/2); no violation with 1 - 2/10 (1 - 2^-k) / (1/2)."""
    found = probability(SPEC, limit)
    assert found.alone["reach"] == pytest.approx(0.6 * (1 - 0.5**limit))
    assert found.alone["avoid"] == found.hard == pytest.approx(1 - 0.4 * (1 - 0.5**limit))
    assert found.alone["fast"] == pytest.approx(0.6 * (1 - 0.5 ** min(limit, 2)))
    assert found.value == found.low == found.high == pytest.approx(found.alone["fast"])
    assert (found.method, found.n) == ("exact", None)


def test_memory_counts_as_in_any_other_evaluation():
    """Exact values are the sums over all paths of 4 steps, each judged by the evaluator."""
    text = "signal g : bool\nsignal h : bool\nsoft a: eventually[1, 3] (once[1, 2] (not g and not h) and g)"
    bundle, total = api.compile(text), 0.0
    for path in itertools.product(range(3), repeat=4):
        states, mass = (0, *path), 1.0
        for before, after in itertools.pairwise(states):
            mass *= {s: p for p, s in OUTCOMES[before][0]}.get(after, 0.0)
        if mass:
            signals = {"g": [GOALS[s] for s in states], "h": [HOLES[s] for s in states]}
            total += mass * (bundle.evaluate(signals)["a"].verdict.value == "satisfied")
    assert probability(text, 4, (RUNS, RUNS, RUNS)).value == pytest.approx(total)
    assert 0.1 < total < 0.9


def test_wilson_by_hand():
    """n = 10, 7 successes: Wilson's interval is 0.3968 to 0.8922; none: 0 to 0.2775."""
    assert wilson(7, 10) == pytest.approx((0.3968, 0.8922), abs=1e-4)
    assert wilson(0, 10) == pytest.approx((0.0, 0.2775), abs=1e-4)
    assert wilson(10, 10)[1] == 1.0


def test_runs_are_counted():
    bundle = api.compile(SPEC)
    runs = [{"avoid": True, "reach": True, "fast": k < 3} for k in range(4)]
    found = from_runs(bundle, runs)
    assert (found.value, found.n, found.hard, found.method) == (0.75, 4, 1.0, "rollouts")
    assert found.alone == {"avoid": 1.0, "reach": 1.0, "fast": 0.75}
    shown = {"value": 0.75, "low": found.low, "high": found.high, "method": "rollouts", "n": 4}
    assert found.to_json() == {**shown, "hard": 1.0, "meets_hard": True}
    assert found.low < 0.75 < found.high


@pytest.mark.parametrize(("met", "expected"), [(0, False), (2, False), (100, False), (101, True), (200, True)])
def test_hard_requirements_are_met_if_they_hold_more_often_than_not(met, expected):
    """A hard requirement that holds in 1 % of the runs is not met by the policy."""
    runs = [{"avoid": k < met, "reach": False, "fast": False} for k in range(200)]
    found = from_runs(api.compile(SPEC), runs)
    assert found.meets_hard is expected is found.to_json()["meets_hard"]
    assert found.to_json()["hard"] == met / 200
