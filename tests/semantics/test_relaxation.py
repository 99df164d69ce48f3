"""What relaxation rules out is impossible: no values at the freed samples flip the verdict."""

import random
from itertools import product

import pytest

import stlspec
from stlspec.compiler.ranges import value_ranges
from stlspec.semantics.chains import values_below
from stlspec.semantics.relaxation import Relaxation, memory, signal_nodes


def relaxed(spec, **signals):
    bundle = stlspec.compile(spec)
    result = bundle.evaluate(signals)["h"]
    found = values_below(bundle.nodes, result.origin.root, result.origin.trace, 0)
    return Relaxation(found, result.origin.trace, value_ranges(bundle.nodes, bundle.signals, bundle.time))


def test_one_violation_can_be_mended_where_it_is_and_two_cannot():
    one = relaxed("signal x\nhard h: always (x > 0)\n", x=[1, -1, 1, 1])
    assert one.single_samples() == [1]
    two = relaxed("signal x\nhard h: always (x > 0)\n", x=[1, -1, 1, -1])
    assert two.single_samples() == []
    assert two.can_flip([(0, 4), (1, 4), (1, 3), (0, 0)]) == [True, True, False, False]
    assert two.indispensable([0, 1, 2, 3]) == [1, 3]


def test_of_many_samples_that_would_do_none_are_listed():
    assert relaxed("signal x\nhard h: eventually (x > 0)\n", x=[-1] * 100).single_samples() is None
    assert relaxed("signal x\nhard h: eventually (x > 0)\n", x=[-1] * 9).single_samples() == list(range(9))


def test_a_predicate_of_time_alone_and_one_beyond_its_range_are_not_free():
    assert relaxed("signal x\nhard h: always (now <= 1)\n", x=[1] * 3).can_flip([(0, 3)]) == [False]
    assert relaxed("signal x in [0, 1]\nhard h: eventually (x > 1)\n", x=[1] * 3).can_flip([(0, 3)]) == [False]
    assert relaxed("signal x in [0, 1]\nhard h: always (x >= 0)\n", x=[1] * 3).can_flip([(0, 3)]) == [False]


def test_a_change_reaches_as_far_as_a_predicate_looks_back():
    test = relaxed("signal x\nhard h: always (delta(x) <= 1)\n", x=[0, 0, 5, 5])
    assert test.single_samples() == [1, 2]


def test_how_far_nodes_look_back_and_on_which_signals_they_depend():
    bundle = stlspec.compile("signal x\nsignal y\nhard h: always (delta(delta(x)) > y)\n")
    root = bundle.requirements[0].root
    (predicate,) = bundle.nodes[root].children
    assert (memory(bundle.nodes)[predicate], memory(bundle.nodes)[root]) == (2, 0)
    assert signal_nodes(bundle.nodes)[root] == {"x", "y"}


FORMULAS = [
    "always (p implies eventually[0, 1] q)",
    "p until[0, 2] q",
    "eventually always[0, 1] p",
    "always[0, 2] p or eventually[1, 3] (p and q)",
    "next p iff eventually q",
    "once[0, 1] q or always (p since q)",
]


@pytest.mark.parametrize("formula", FORMULAS)
def test_against_all_values_of_a_sample(formula):
    spec = f"signal p: bool\nsignal q: bool\nhard h: {formula}\n"
    bundle = stlspec.compile(spec)
    rng = random.Random(formula)
    for _ in range(10):
        rows = {name: [rng.random() < 0.5 for _ in range(5)] for name in "pq"}
        before = bundle.evaluate(rows)["h"].verdict
        test = relaxed(spec, **rows)
        singles = test.single_samples()
        needed = test.indispensable(range(5))
        flips = set()
        for k, p, q in product(range(5), (False, True), (False, True)):
            changed = {"p": [*rows["p"]], "q": [*rows["q"]]}
            changed["p"][k], changed["q"][k] = p, q
            if bundle.evaluate(changed)["h"].verdict is not before:
                flips.add(k)
        assert flips <= set(singles)
        if flips:
            assert set(needed) <= set.intersection(*({k} for k in flips))
