"""Suffix scans agree with their definition at every size at which they change method."""

import numpy as np
import pytest

from stlspec.semantics import scans

INF = np.inf
SHAPES = [(1, 1), (2, 1), (7, 3), (4096, 1), (4097, 1), (5000, 1), (150_001, 1), (700, 37), (9, 600), (600, 150)]


def samples(shape, seed):
    rng = np.random.default_rng(seed)
    return rng.choice([-INF, -2.0, -1.0, 0.5, 1.0, 2.0, 3.0, INF], size=shape)


def until_backwards(left, right):
    """The recurrence itself: u = max(q, min(p, next u)), -inf past the end."""
    result, after = np.empty(left.shape), np.full(left.shape[1], -INF)
    for i in range(len(left) - 1, -1, -1):
        after = result[i] = np.maximum(right[i], np.minimum(left[i], after))
    return result


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("extremum", [np.minimum, np.maximum])
@pytest.mark.parametrize("backwards", [False, True])
def test_suffix_extrema_are_running_extrema_from_the_end(shape, extremum, backwards):
    values, out = np.random.default_rng(1).standard_normal(shape), np.empty(shape)
    step = -1 if backwards else 1
    scans.suffix_extremum(extremum, values[::step], out[::step])
    expected = extremum.accumulate(values[::step][::-1], axis=0)[::-1]
    assert np.array_equal(out[::step], expected)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("backwards", [False, True])
def test_suffix_until_obeys_its_recurrence(shape, backwards):
    left, right, out = samples(shape, 2), samples(shape, 3), np.empty(shape)
    step = -1 if backwards else 1
    scans.suffix_until(left[::step], right[::step], out[::step])
    assert np.array_equal(out[::step], until_backwards(left[::step], right[::step]))


def test_blocks_and_lanes_leave_no_seam(monkeypatch):
    monkeypatch.setattr(scans, "_SMALL", 4)
    for n in range(1, 200):
        monkeypatch.setattr(scans, "_BLOCK", 2 * (1 + n % 60))
        monkeypatch.setattr(scans, "_STEPS", 1 + n % 7)
        left, right, out = samples((n, 2), n), samples((n, 2), -n % 997), np.empty((n, 2))
        scans.suffix_until(left, right, out)
        assert np.array_equal(out, until_backwards(left, right))
        scans.suffix_extremum(np.minimum, left, out)
        assert np.array_equal(out, np.minimum.accumulate(left[::-1], axis=0)[::-1])


def test_operands_are_left_alone():
    left, right = samples((5000, 2), 5), samples((5000, 2), 6)
    copies = left.copy(), right.copy()
    scans.suffix_until(left, right, np.empty(left.shape))
    scans.suffix_extremum(np.minimum, left, np.empty(left.shape))
    assert np.array_equal(left, copies[0])
    assert np.array_equal(right, copies[1])
