"""The witness is the earliest sample of a predicate that the value comes from."""

import random

import numpy as np
import pytest

from stlspec.compiler.ir import Builder
from stlspec.semantics.witness import decide
from stlspec.traces import make_trace
from tests.oracle import INEXACT, NotANumberError, Oracle
from tests.strategies import DECLARED, STEP, random_case, random_signals


def by_brute_force(case, at):
    """Witness from all deciding (predicate, sample) pairs, found by walking the definition."""
    oracle = Oracle(case.nodes, case.signals, case.times, case.ticks_per_unit)
    oracle.rho(case.root)
    found, ran_out = oracle.deciding(case.root, at)
    if not found:
        return -1, -1, False, ran_out
    sample, predicate, sign = min((i, index, s) for index, i, s in found)
    return sample, predicate, sign < 0, False


def engine(case, at):
    decision = decide(case.nodes, case.root, case.trace(), at)
    return (
        int(decision.samples[0]),
        int(decision.predicates[0]),
        bool(decision.negated[0]),
        bool(decision.vacuous[0]),
    )


@pytest.mark.parametrize("seed", range(3))
def test_witnesses_are_those_of_the_brute_force_definition(seed):
    rng = random.Random(seed)
    kinds = set()
    for _ in range(200):
        case = random_case(rng, depth=4, longest=12)
        if any(node.op in INEXACT for node in case.nodes):
            continue
        at = rng.randrange(len(case.times))
        try:
            expected = by_brute_force(case, at)
        except NotANumberError:
            continue
        kinds.add((expected[0] >= 0, expected[3]))
        assert engine(case, at) == expected, case
    assert kinds == {(True, False), (False, True), (False, False)}


def test_witnesses_of_a_batch_are_those_of_its_traces():
    rng = random.Random(11)
    compared = 0
    while compared < 60:
        case = random_case(rng, depth=4, longest=12)
        if any(node.op in INEXACT | {"div", "sqrt", "add", "sub", "delta", "rate", "mul"} for node in case.nodes):
            continue
        n = len(case.times)
        several = [random_signals(rng, n) for _ in range(3)]
        time = None if case.base.kind == "step" else [t / 10 for t in case.times]
        at = rng.randrange(n)
        batch = {name: [s[name] for s in several] for name in case.signals}
        together = decide(case.nodes, case.root, make_trace(case.base, DECLARED, batch, time), at)
        for j, signals in enumerate(several):
            alone = decide(case.nodes, case.root, make_trace(case.base, DECLARED, signals, time), at)
            for name in ("samples", "predicates", "negated", "vacuous"):
                assert getattr(together, name)[j] == getattr(alone, name)[0]
        compared += 1


def decided(build, at=0, **signals):
    builder = Builder()
    root = build(builder)
    trace = make_trace(STEP, [s for s in DECLARED if s.name in signals], signals)
    decision = decide(builder.nodes, root, trace, at)
    return int(decision.samples[0]), int(decision.predicates[0]), bool(decision.vacuous[0])


def above(builder, name, bound):
    return builder.add("ge", [builder.add("signal", value=name), builder.add("const", value=float(bound))])


def test_always_is_decided_by_its_worst_sample_and_among_equals_by_the_earliest():
    def build(b):
        return b.add("always", [above(b, "x", 1)], interval=(0, None))

    assert decided(build, x=[3, 0, 2, 0]) == (1, 2, False)
    assert decided(build, at=2, x=[3, 0, 2, 0]) == (3, 2, False)


def test_until_is_decided_by_the_left_operand_where_it_fails_first():
    def build(b):
        return b.add("until", [above(b, "x", 0), above(b, "y", 0)], interval=(0, None))

    assert decided(build, x=[1, -1, 1], y=[-5, -5, 5])[:2] == (1, 2)
    assert decided(build, x=[9, 9, 9], y=[-5, -2, -3])[:2] == (1, 4)


def test_an_empty_window_is_vacuous_and_has_no_witness():
    def build(b):
        return b.add("always", [above(b, "x", 1)], interval=(5, 9))

    assert decided(build, x=[1, 2, 3]) == (-1, -1, True)


def test_a_value_that_a_predicate_shares_with_an_empty_window_is_not_vacuous():
    def build(b):
        empty = b.add("always", [above(b, "x", 1)], interval=(5, 9))
        return b.add("and", [empty, b.add("bool", value="b")])

    assert decided(build, x=[1, 2, 3], b=[True, False, False]) == (0, 4, False)


def test_a_constant_is_neither_vacuous_nor_has_it_a_witness():
    assert decided(lambda b: b.add("always", [b.add("true")], interval=(0, None)), x=[1]) == (-1, -1, False)


def test_next_off_the_end_is_vacuous():
    assert decided(lambda b: b.add("next", [above(b, "x", 1)]), x=[1]) == (-1, -1, True)


def test_of_several_predicates_at_one_sample_the_first_in_the_dag_is_the_witness():
    def build(b):
        return b.add("and", [above(b, "y", 1), above(b, "x", 1)])

    assert decided(build, x=[0], y=[0]) == (0, 2, False)


def test_a_long_trace_is_explained_in_linear_work():
    x = np.ones(200_000)
    x[150_000] = -3

    def build(b):
        inner = b.add("eventually", [above(b, "x", 0)], interval=(0, 1000))
        return b.add("always", [b.add("or", [inner, above(b, "x", 0)])], interval=(0, None))

    x[150_000:151_001] = -3
    assert decided(build, x=x)[0] == 150_000
