"""Flips are never claimed without being so: every claim is held against the definition."""

import random
from dataclasses import replace
from itertools import product
from types import MappingProxyType

import pytest

import stlspec
from stlspec.compiler.bundle import BundleData
from stlspec.semantics.chains import find_chain, values_below
from stlspec.semantics.flips import find_flip
from stlspec.semantics.witness import decide
from tests.oracle import INEXACT, NotANumberError, Oracle
from tests.strategies import DECLARED, VALUES, random_case


def bundle_of(case):
    empty = MappingProxyType({})
    return BundleData("t", None, case.base, DECLARED, (), (), case.nodes, empty, (), (), ())


def flip_of(case, at):
    trace = case.trace()
    found = values_below(case.nodes, case.root, trace, at)
    decision = decide(case.nodes, case.root, trace, at)
    sample, predicate = int(decision.samples[0]), int(decision.predicates[0])
    chain = find_chain(found, None if sample < 0 else predicate, sample)
    return find_flip(bundle_of(case), found, chain, trace)


def verdict(case, at, changes=()):
    """The Boolean verdict by the definition, after (signal, sample, value) changes; None without a value."""
    signals = {name: list(values) for name, values in case.signals.items()}
    for name, sample, value in changes:
        signals[name][sample] = bool(value) if name == "b" else value
    try:
        return Oracle(case.nodes, signals, case.times, case.ticks_per_unit).holds(case.root)[at]
    except NotANumberError:
        return None


def cases(count, seed, longest, depth=4):
    rng = random.Random(seed)
    made = 0
    while made < count:
        case = random_case(rng, depth=depth, longest=longest)
        at = rng.randrange(len(case.times))
        if any(node.op in INEXACT for node in case.nodes) or verdict(case, at) is None:
            continue
        made += 1
        yield case, at


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_claimed_to_flip_the_verdict_flips_it_by_the_definition(seed):
    claimed = {"single": 0, "sample": 0, "several": 0}
    for case, at in cases(300, seed, longest=12):
        flip = flip_of(case, at)
        if not flip.changes:
            continue
        claimed[flip.kind] += 1
        changes = [(c.signal, c.sample, c.value) for c in flip.changes]
        assert verdict(case, at, changes) == (not verdict(case, at)), case
        samples = {c.sample for c in flip.changes}
        assert flip.least in (None, len(samples))
        for change in flip.changes:
            assert change.before == float(case.signals[change.signal][change.sample])
    assert claimed["single"] > 100
    assert claimed["several"] > 5


@pytest.mark.parametrize("seed", range(2))
def test_a_change_is_open_ended_only_if_values_farther_off_flip_the_verdict_too(seed):
    tested = 0
    for case, at in cases(300, seed, longest=12):
        flip = flip_of(case, at)
        if flip.kind != "single" or not flip.changes[0].beyond:
            continue
        (change,) = flip.changes
        tested += 1
        way = 1 if change.value > change.before else -1
        if change.boolean:
            continue
        for distance in (0.5, 3, 1000):
            turned = verdict(case, at, [(change.signal, change.sample, change.value + way * distance)])
            assert turned == (not verdict(case, at)), case
    assert tested > 50


@pytest.mark.parametrize("seed", range(2))
def test_a_bound_is_the_least_change_of_that_sample(seed):
    for case, at in cases(200, seed, longest=10):
        flip = flip_of(case, at)
        if flip.kind != "single" or flip.changes[0].boolean:
            continue
        (change,) = flip.changes
        if abs(change.before) == float("inf"):
            continue
        before = verdict(case, at)
        for part in (0.25, 0.5, 0.9, 0.999):
            value = change.before + part * (change.bound - change.before)
            assert verdict(case, at, [(change.signal, change.sample, value)]) in (before, None) or not change.beyond
        if change.strict:
            assert verdict(case, at, [(change.signal, change.sample, change.bound)]) in (before, None)


@pytest.mark.parametrize("seed", range(3))
def test_that_no_single_sample_suffices_is_true_of_every_sample_and_many_values(seed):
    grid = [*VALUES, -50.0, 50.0, 0.25, -0.75]
    kinds = {"several": 0, "impossible": 0}
    for case, at in cases(100, seed, longest=6, depth=3):
        flip = flip_of(case, at)
        if flip.kind not in kinds:
            continue
        kinds[flip.kind] += 1
        before = verdict(case, at)
        for sample in range(len(case.times)):
            for x, y, b in product(grid, grid, (True, False)):
                after = verdict(case, at, [("x", sample, x), ("y", sample, y), ("b", sample, b)])
                assert after in (before, None), (case, sample, x, y, b)
    assert min(kinds.values()) > 2


def explained(text, signals, name="h", time=None):
    from stlspec.semantics.explain import explain

    bundle = stlspec.compile(text)
    return explain(bundle, name, bundle.evaluate(signals, time)[name]).flip


@pytest.mark.parametrize(
    ("formula", "values", "expected"),
    [
        ("always (x >= 1)", [2, 0, 3], "x at sample 1 from 0 to at least 1"),
        ("always (x > 1)", [2, 0, 3], "x at sample 1 from 0 to more than 1"),
        ("always (x <= 1)", [1, 4, 1], "x at sample 1 from 4 to at most 1"),
        ("always (x < 1)", [0, 4, 0], "x at sample 1 from 4 to less than 1"),
        ("always (2 * x + 1 >= 4)", [2, 0, 3], "x at sample 1 from 0 to at least 1.5"),
        ("always (0.3 <= x + 0.1)", [2, 0, 3], "x at sample 1 from 0 to at least 0.2"),
        ("always (0 <= x <= 5)", [2, 9, 3], "x at sample 1 from 9 to 5"),
        ("always (abs(x) <= 2)", [2, -9, 0], "x at sample 1 from -9 to -2"),
        ("eventually (x == 3)", [2, 1], "x at sample 0 from 2 to 3"),
        ("always (x == 3)", [3], "x at sample 0 from 3 to just above 3"),
        ("always (x ** 2 <= 4)", [1, 5], "x at sample 1 from 5 to 2"),
        ("always (hypot(x - 3, 4) <= 5)", [1, -8], "x at sample 1 from -8 to 0"),
        ("always (delta(x) <= 2)", [0, 1, 5, 5], "x at sample 2 from 5 to 3"),
        ("always (x >= 0)", [float("inf"), 1], "x at sample 1 from 1 to less than 0"),
        ("always (x >= 0)", [float("-inf"), 1], "x at sample 0 from -inf to at least 0"),
    ],
)
def test_changes_are_said_in_the_words_that_are_true(formula, values, expected):
    (change,) = explained(f"signal x\nhard h: {formula}\n", {"x": values}).changes
    assert change.text == expected


def test_a_boolean_sample_is_turned_round():
    (change,) = explained("signal p: bool\nhard h: always p\n", {"p": [True, False]}).changes
    assert change.text == "p at sample 1 from false to true"


def test_a_change_keeps_to_the_declared_range():
    text = "signal x in [0, 10]\nsignal y\nhard h: always (x >= 12 or y >= 4)\n"
    (change,) = explained(text, {"x": [11 - 1, 9], "y": [9, -5]}).changes
    assert change.signal == "y"
    assert explained("signal x in [0, 10]\nhard h: always (x <= 10)\n", {"x": [10, 9]}).kind == "impossible"


def test_two_violations_need_two_changes():
    flip = explained("signal x\nhard h: always (x >= 1)\n", {"x": [0, 2, -1]})
    assert (flip.kind, flip.least) == ("several", 2)
    assert [(c.sample, c.bound) for c in flip.changes] == [(0, 1.0), (2, 1.0)]


def test_two_signals_of_one_sample_may_be_needed():
    text = "signal x\nsignal y\nhard h: eventually (x >= 1) and eventually (y >= 2)\n"
    flip = explained(text, {"x": [0, 0], "y": [0, 1]})
    assert flip.kind == "sample"
    assert {(c.signal, c.bound) for c in flip.changes} == {("x", 1.0), ("y", 2.0)}
    assert len({c.sample for c in flip.changes}) == 1


def test_what_depends_on_time_alone_is_not_promised_to_flip():
    assert explained("signal x\nhard h: always (now <= 5)\n", {"x": [1] * 9}).kind == "impossible"
    assert explained("signal x\nhard h: always[20, 30] (x > 0)\n", {"x": [1] * 9}).kind == "impossible"


def test_a_long_trace_takes_bounded_work():
    n = 20_000
    values = [1.0] * n
    values[100] = values[19_000] = -1.0
    flip = explained("signal x\nhard h: always eventually[0, 10] always[0, 3] (x > 0)\n", {"x": values})
    assert flip.kind in ("unknown", "single", "several", "impossible")
    flip = explained("signal x\nhard h: always (x > 0)\n", {"x": values})
    assert (flip.kind, flip.least) == ("several", 2)
    assert replace(flip.changes[0], sample=0).target == "more than 0"
