"""The nearest value that flips a predicate is found, whatever the predicate computes, and written with few digits."""

import math

import pytest

import stlspec
from stlspec.compiler.bundle import Signal
from stlspec.semantics.changes import Change, direction, flipping_changes


def changes(formula, values, sample, at=None, low=None, high=None):
    """Changes of x for the first predicate of a formula."""
    bundle = stlspec.compile(f"signal x\nhard h: {formula}\n")
    trace = bundle.evaluate({"x": values})["h"].origin.trace
    at = sample if at is None else at
    return flipping_changes(
        bundle.nodes, bundle.requirements[0].root, trace, at, Signal("x", low=low, high=high), sample
    )


@pytest.mark.parametrize(
    ("formula", "value", "expected"),
    [
        ("x >= 1", 0, [(1, False)]),
        ("x > 1", 0, [(1, True)]),
        ("x >= 0", -1, [(0, False)]),
        ("x > 0", -1, [(0, True)]),
        ("x < 1", 5, [(1, True)]),
        ("3 * x - 2 >= 7", 0, [(3, False)]),
        ("x >= 1e-9", -1, [(1e-9, False)]),
        ("x <= 1e30", 2e30, [(1e30, False)]),
        ("abs(x) <= 2", 5, [(2, False)]),
        ("abs(x) >= 2", 0.5, [(2, False), (-2, False)]),
        ("x == 3", 5, [(3, False)]),
        ("x != 3", 3, [(3, True), (3, True)]),
        ("max(x, 4) > 9", 0, [(9, True)]),
        ("sqrt(x) >= 3", 4, [(9, False)]),
        ("x * 0 >= 1", 4, []),
        ("exp(x) <= 1", 2, [(0, False)]),
    ],
)
def test_the_nearest_bounds_above_and_below(formula, value, expected):
    found = changes(formula, [value], 0)
    assert [(c.bound, c.strict) for c in found] == expected


def test_a_strict_bound_is_missed_by_one_float_and_no_more():
    (change,) = changes("x > 1", [0], 0)
    assert change.value == math.nextafter(1, 2)
    (change,) = changes("x >= 1", [0], 0)
    assert change.value == 1.0


def test_the_declared_range_is_kept_to():
    assert changes("x >= 1", [0], 0, high=0.5) == []
    assert [c.bound for c in changes("abs(x) >= 2", [0.5], 0, low=0)] == [2.0]


def test_a_sample_before_the_predicate_counts_where_it_looks_back():
    (up,) = changes("delta(x) <= 2", [0, 5], 0, at=1)
    assert (up.sample, up.bound) == (0, 3.0)
    (down,) = changes("delta(x) <= 2", [0, 5], 1)
    assert (down.sample, down.bound) == (1, 2.0)


def test_an_infinite_sample_is_brought_back():
    (change,) = changes("x <= 2", [math.inf], 0)
    assert (change.before, change.bound) == (math.inf, 2.0)


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("always (x >= 1)", 1),
        ("always (x <= 1)", -1),
        ("not eventually (x < 1)", 1),
        ("always (-2 * x > y)", -1),
        ("always (min(x, y) > 1) and eventually (x > 3)", 1),
        ("x > 1 implies y > 1", -1),
        ("0 < x < 1", None),
        ("abs(x) > 1", None),
        ("x - y > x", None),
        ("delta(x) > 1", None),
        ("y > 1", 0),
        ("x / 4 >= 1 until y > 1", 1),
    ],
)
def test_the_way_a_signal_works(formula, expected):
    bundle = stlspec.compile(f"signal x\nsignal y\nhard h: {formula}\n")
    assert direction(bundle.nodes, bundle.requirements[0].root, "x") == expected


def test_a_change_is_said_in_words():
    change = Change("d", 3, 0.0, 1.0, False, 1.0)
    assert change.text == "d at sample 3 from 0 to 1"
    assert Change("d", 3, 0.0, 1.0, False, 1.0, beyond=True).target == "at least 1"
    assert Change("d", 3, 0.0, 1.0, True, 1.1, beyond=True).target == "more than 1"
    assert Change("d", 3, 2.0, 1.0, True, 0.9).target == "just below 1"
    assert Change("p", 3, 0.0, 1.0, False, 1.0, boolean=True).text == "p at sample 3 from false to true"
