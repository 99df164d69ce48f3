"""Chains lead from the requirement to its witness, along values that the definition confirms."""

import random
from itertools import pairwise

import numpy as np
import pytest

from stlspec.compiler.ir import COMPARISONS, Builder
from stlspec.semantics.chains import bearing_samples, find_chain, values_below
from stlspec.semantics.witness import decide
from tests.oracle import INEXACT, NotANumberError, Oracle
from tests.strategies import STEP, Case, random_case


def exact_cases(count, seed, longest=12):
    """Random cases that the oracle evaluates to the last digit, each with its oracle and a sample."""
    rng = random.Random(seed)
    made = 0
    while made < count:
        case = random_case(rng, depth=4, longest=longest)
        if any(node.op in INEXACT for node in case.nodes):
            continue
        oracle = Oracle(case.nodes, case.signals, case.times, case.ticks_per_unit)
        try:
            oracle.rho(case.root)
        except NotANumberError:
            continue
        made += 1
        yield case, oracle, rng.randrange(len(case.times))


def chain_of(case, at):
    found = values_below(case.nodes, case.root, case.trace(), at)
    decision = decide(case.nodes, case.root, case.trace(), at)
    sample, predicate = int(decision.samples[0]), int(decision.predicates[0])
    return found, find_chain(found, None if sample < 0 else predicate, sample), decision


@pytest.mark.parametrize("seed", range(3))
def test_every_link_has_the_value_of_the_root_and_the_last_is_the_witness(seed):
    lengths = set()
    for case, oracle, at in exact_cases(200, seed):
        _, chain, decision = chain_of(case, at)
        assert (chain[0].index, chain[0].sample, chain[0].sign) == (case.root, at, 1)
        value, truth = oracle.rho(case.root)[at], oracle.holds(case.root)[at]
        for link in chain:
            assert oracle.rho(link.index)[link.sample] * link.sign == value
            assert oracle.holds(link.index)[link.sample] == (truth == (link.sign > 0))
        for link, below in pairwise(chain):
            assert below.index in case.nodes[link.index].children
        if decision.samples[0] >= 0:
            assert (chain[-1].index, chain[-1].sample) == (decision.predicates[0], decision.samples[0])
            assert (chain[-1].sign < 0) == bool(decision.negated[0])
        lengths.add(len(chain))
    assert len(lengths) > 3


@pytest.mark.parametrize("seed", range(3))
def test_a_chain_steps_only_to_pairs_that_decide_by_the_definition(seed):
    for case, oracle, at in exact_cases(100, seed, longest=8):
        _, chain, _ = chain_of(case, at)
        for link, below in pairwise(chain):
            if case.nodes[link.index].op == "not":
                assert below.sample == link.sample
                continue
            operands, _ = oracle._operands(case.nodes[link.index], link.index, link.sample)
            assert (below.index, below.sample) in operands


def test_without_a_predicate_the_chain_ends_at_the_empty_window_or_the_constant():
    kinds = set()
    for case, oracle, at in exact_cases(400, 5):
        _, chain, decision = chain_of(case, at)
        if decision.samples[0] >= 0:
            continue
        node, last = case.nodes[chain[-1].index], chain[-1].sample
        kinds.add(node.op)
        if node.interval is not None:
            assert oracle.window(node, last) == []
        else:
            beyond = {"next": last == len(case.times) - 1, "prev": last == 0, "true": True, "false": True}
            assert beyond[node.op]
    assert {"true", "always", "eventually"} <= kinds


def grid(build, **signals):
    """A formula over the rows of a step trace."""
    builder = Builder()
    root = build(builder)
    n = len(next(iter(signals.values())))
    columns = {"x": [0.0] * n, "y": [0.0] * n, "b": [True] * n} | signals
    return Case(tuple(builder.nodes), root, columns, list(range(n)), STEP)


def positive(builder, name):
    return builder.add("gt", [builder.add("signal", value=name), builder.add("const", value=0.0)])


def bearing(case, at=0, **options):
    found, chain, _ = chain_of(case, at)
    assert found.nodes[chain[-1].index].op in COMPARISONS
    return np.flatnonzero(bearing_samples(found, chain, **options)).tolist()


def test_violating_samples_of_always_are_all_samples_of_its_window_where_it_is_false():
    case = grid(lambda b: b.add("always", [positive(b, "x")], interval=(1, 4)), x=[-9, 1, -1, 1, -2, -3])
    assert bearing(case) == [2, 4]


def test_violating_samples_of_a_response_are_the_windows_in_which_it_is_missing():
    def build(b):
        response = b.add("eventually", [positive(b, "y")], interval=(0, 2))
        return b.add("always", [b.add("or", [b.add("not", [positive(b, "x")]), response])], interval=(0, None))

    case = grid(build, x=[9, -9, -9, -9, -9, 9, -9, -9, -9], y=[-3, 5, -3, -3, -3, -3, -2, -2, -3])
    assert bearing(case) == [5, 6, 7]
    assert bearing(case, fewest=True) == [6]


def test_violating_samples_of_until_are_where_the_left_side_has_lapsed():
    case = grid(
        lambda b: b.add("until", [positive(b, "x"), positive(b, "y")], interval=(0, None)),
        x=[2, 2, -1, -1, 2],
        y=[-5, -5, -5, -5, 2],
    )
    assert bearing(case) == [2, 3]


def test_bearing_samples_of_what_holds_are_those_that_make_it_hold():
    case = grid(lambda b: b.add("eventually", [positive(b, "x")], interval=(0, None)), x=[-1, 1, -1, 2, -1])
    assert bearing(case) == [1, 3]


def test_few_samples_hit_all_windows():
    def build(b):
        inner = b.add("eventually", [positive(b, "x")], interval=(0, 2))
        return b.add("always", [inner], interval=(0, 5))

    assert bearing(grid(build, x=[-1] * 8), fewest=True) == [0, 3, 6]


@pytest.mark.parametrize("seed", range(2))
def test_bearing_samples_have_the_truth_that_bears_out_the_verdict(seed):
    for case, oracle, at in exact_cases(150, seed):
        found, chain, decision = chain_of(case, at)
        if decision.samples[0] < 0:
            continue
        truth = oracle.holds(case.root)[at]
        for options in ({}, {"fewest": True}):
            mask = bearing_samples(found, chain, **options)
            assert mask[chain[-1].sample]
            for sample in np.flatnonzero(mask):
                assert oracle.holds(chain[-1].index)[sample] == (truth == (chain[-1].sign > 0))
