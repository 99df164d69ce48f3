"""Windowed operators agree with their definition, sample by sample, on even and uneven time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stlspec.semantics import scans, windows
from stlspec.semantics.windows import Grid
from tests.counting import counting

INF = np.inf
INTERVALS = [(0, 0), (0, 1), (0, 3), (2, 5), (3, None), (0, None), (7, 7), (5, 400), (900, 2000), (10**15, None)]


def even(n, spacing=1):
    return Grid(np.arange(n) * spacing, spacing)


def uneven(n, seed=0):
    return Grid(np.cumsum(np.random.default_rng(seed).integers(1, 4, n)), None)


def window(grid, interval, i, past=False):
    """Samples in the window, by looking at each; a mask."""
    ahead = grid.times[i] - grid.times if past else grid.times - grid.times[i]
    return (ahead >= interval[0]) & (ahead <= (INF if interval[1] is None else interval[1]))


def slide(values, grid, interval, pick, empty, past=False):
    rows = [values[window(grid, interval, i, past)] for i in range(len(values))]
    return np.array([pick(r, axis=0) if len(r) else np.full(values.shape[1:], empty) for r in rows])


def until(left, right, grid, interval):
    result = np.full(len(left), -INF)
    for i in range(len(left)):
        for j in np.flatnonzero(window(grid, interval, i)):
            result[i] = max(result[i], min(right[j], left[i:j].min(initial=INF)))
    return result


def samples(shape, seed=0):
    return np.random.default_rng(seed).choice([-2.0, -1.0, 0.5, 1.0, 2.0, 3.0], size=shape)


@pytest.mark.parametrize("interval", INTERVALS)
@pytest.mark.parametrize("grid", [even(1), even(60), even(60, 3), uneven(60), uneven(1)])
@pytest.mark.parametrize("columns", [(), (3,)])
def test_windows_hold_the_samples_in_their_interval(interval, grid, columns):
    values = samples((len(grid.times), *columns))
    copy = values.copy()
    expected = slide(values, grid, interval, np.min, INF)
    assert np.array_equal(windows.always(values, grid, interval), expected)
    expected = slide(values, grid, interval, np.max, -INF)
    assert np.array_equal(windows.eventually(values, grid, interval), expected)
    expected = slide(values, grid, interval, np.min, INF, past=True)
    assert np.array_equal(windows.historically(values, grid, interval), expected)
    expected = slide(values, grid, interval, np.max, -INF, past=True)
    assert np.array_equal(windows.once(values, grid, interval), expected)
    assert np.array_equal(values, copy)


@pytest.mark.parametrize("interval", INTERVALS)
@pytest.mark.parametrize("grid", [even(60), even(60, 3), uneven(60), uneven(1)])
@pytest.mark.parametrize("count", [1, 2, 7, 59])
def test_a_short_out_takes_the_first_samples_and_the_last_of_a_past_operator(interval, grid, count):
    n = len(grid.times)
    count = min(count, n)
    left, right = samples((n, 2), 1), samples((n, 2), 2)
    for future, past in ((windows.always, windows.historically), (windows.eventually, windows.once)):
        out = np.empty((count, 2))
        assert np.array_equal(future(left, grid, interval, out), future(left, grid, interval)[:count])
        assert np.array_equal(past(left, grid, interval, out), past(left, grid, interval)[n - count :])
    out = np.empty((count, 2))
    expected = windows.until(left, right, grid, interval)[:count]
    assert np.array_equal(windows.until(left, right, grid, interval, out), expected)
    expected = windows.since(left, right, grid, interval)[n - count :]
    assert np.array_equal(windows.since(left, right, grid, interval, out), expected)


@pytest.mark.parametrize(("count", "expected"), [(0, [1, 2, 3]), (1, [2, 3, 9]), (3, [9, 9, 9]), (10**20, [9, 9, 9])])
def test_a_shift_brings_later_samples_and_what_is_beyond_the_end(count, expected):
    out = np.zeros(3)
    windows.shift(np.array([1.0, 2.0, 3.0]), count, 9.0, out)
    assert out.tolist() == expected


@pytest.mark.parametrize("interval", INTERVALS)
@pytest.mark.parametrize("grid", [even(40), even(40, 3), uneven(40), even(1), uneven(1)])
def test_until_and_since_count_left_up_to_but_not_at_the_switch(interval, grid):
    left, right = samples(len(grid.times), 1), samples(len(grid.times), 2)
    expected = until(left, right, grid, interval)
    assert np.array_equal(windows.until(left, right, grid, interval), expected)
    mirrored = until(left[::-1], right[::-1], grid.reversed(), interval)[::-1]
    assert np.array_equal(windows.since(left, right, grid, interval), mirrored)


@pytest.mark.parametrize(
    "width", [1, 2, 3, 4, 96, 97, 100, 130, 1000, 2500, 2531, 2532, 2533, 2563, 2999, 4999, 5000, 6000]
)
@pytest.mark.parametrize(("columns", "wide"), [(1, 2048), (40, 2048), (1, 96), (3, 96)])
def test_long_traces_are_cut_into_blocks_without_a_seam(width, columns, wide, monkeypatch):
    monkeypatch.setattr(windows, "_BLOCK", 512)
    monkeypatch.setattr(windows, "_WIDE", wide)
    values = np.random.default_rng(0).standard_normal((5000, columns))
    padded = np.concatenate([values, np.full((width, columns), INF)])
    expected = np.lib.stride_tricks.sliding_window_view(padded, width, axis=0)[:5000].min(axis=-1)
    assert np.array_equal(windows.always(values, even(5000), (0, width - 1)), expected)
    assert np.array_equal(windows.historically(values[::-1], even(5000), (0, width - 1)), expected[::-1])


@pytest.mark.parametrize("make_grid", [even, uneven])
@pytest.mark.parametrize("interval", [(0, None), (0, 30), (5, 60), (40, None), (500, 600)])
def test_long_until_is_scanned_in_two_levels_without_a_seam(make_grid, interval, monkeypatch):
    monkeypatch.setattr(scans, "_SMALL", 64)
    grid = make_grid(700)
    left, right = samples(700, 3), samples(700, 4)
    left[::7] = 5.0
    assert np.array_equal(windows.until(left, right, grid, interval), until(left, right, grid, interval))


@settings(deadline=None)
@given(st.data())
def test_a_batch_equals_its_traces_one_by_one(data):
    n, k = data.draw(st.integers(1, 30)), data.draw(st.integers(1, 4))
    grid = data.draw(st.sampled_from([even(n), even(n, 4), uneven(n, n)]))
    low = data.draw(st.integers(0, 12))
    interval = (low, data.draw(st.none() | st.integers(low, low + 12)))
    left, right = samples((n, k), data.draw(st.integers(0, 99))), samples((n, k), data.draw(st.integers(0, 99)))
    for operator in (windows.always, windows.once):
        alone = [operator(left[:, j].copy(), grid, interval) for j in range(k)]
        assert np.array_equal(operator(left, grid, interval), np.stack(alone, axis=1))
    for operator in (windows.until, windows.since):
        alone = [operator(left[:, j].copy(), right[:, j].copy(), grid, interval) for j in range(k)]
        assert np.array_equal(operator(left, right, grid, interval), np.stack(alone, axis=1))


def test_index_windows_are_ranges_that_hold_exactly_the_window():
    for grid in (even(20), even(20, 3), uneven(20)):
        for interval in INTERVALS:
            begin, end = windows.index_windows(grid, interval)
            for i in range(20):
                expected = np.flatnonzero(window(grid, interval, i)).tolist()
                assert list(range(begin[i], end[i])) == expected


@settings(deadline=None, max_examples=50)
@given(st.integers(1, 200), st.integers(0, 400), st.sampled_from([1, 7, 64]), st.integers(0, 99))
def test_stamps_are_looked_up_in_blocks_without_a_seam(n, ahead, block, seed):
    grid = uneven(n, seed)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(windows, "_LOOKUP", block)
        begin, end = windows.index_windows(grid, (ahead, ahead + 3))
    for i in range(n):
        inside = np.flatnonzero(window(grid, (ahead, ahead + 3), i))
        assert list(range(begin[i], end[i])) == inside.tolist()


@pytest.mark.parametrize("jumps", [[1, 2, 3], [1, 1, 1, 50], [1, 400], [1] * 60 + [90] * 3])
@pytest.mark.parametrize("interval", [(0, 5), (0, 60), (20, 45), (2, 3)])
def test_uneven_windows_of_any_mix_of_lengths_hold_their_samples(jumps, interval, monkeypatch):
    monkeypatch.setattr(windows, "_BLOCK", 64)
    grid = Grid(np.cumsum(np.random.default_rng(1).choice(jumps, 700)), None)
    values = np.random.default_rng(2).standard_normal((700, 2))
    assert np.array_equal(windows.always(values, grid, interval), slide(values, grid, interval, np.min, INF))
    expected = slide(values, grid, interval, np.max, -INF, past=True)
    assert np.array_equal(windows.once(values, grid, interval), expected)


def test_times_near_the_limit_of_int64_do_not_overflow():
    grid = Grid(np.array([0, 2**61, 2**62 - 1]), None)
    values = np.array([1.0, 2.0, 3.0])
    assert windows.eventually(values, grid, (0, 2**62)).tolist() == [3, 3, 3]
    assert windows.eventually(values, grid, (2**62 - 1, 2**63)).tolist() == [3, -INF, -INF]
    assert windows.always(values, grid, (10**30, None)).tolist() == [INF, INF, INF]


@pytest.mark.parametrize("operator", [windows.always, windows.once, windows.until, windows.since])
@pytest.mark.parametrize("make_grid", [even, uneven])
def test_the_work_grows_little_with_the_window_and_not_with_the_trace(operator, make_grid):
    work = {}
    for n in (20_000, 100_000):
        operands = np.random.default_rng(0).standard_normal((2 if operator in (windows.until, windows.since) else 1, n))
        for width in (10, 100, 1000, 10_000):
            with counting(scans, windows) as counter:
                operator(*operands, make_grid(n), (0, width))
            work[n, width] = counter.operations / n
    assert max(work.values()) <= 4 * min(work.values())
    assert work[100_000, 1000] <= 1.2 * work[20_000, 1000]
