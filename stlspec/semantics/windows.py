"""Sliding windows: always, eventually, until and their past mirrors, for a whole signal at once.

In: robustness at every sample, (n_samples,) or time-major (n_samples, n_traces), the times, an interval in
ticks. Out: the operator's robustness at every sample, or at the first few (the last few of a past operator). The
past operators are the future ones on views that run backwards in time, so there is one kernel of each kind and no
special case for the past.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import Interval
from stlspec.semantics.scans import suffix_extremum, suffix_until
from stlspec.traces import ticks_array

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Two buffers of this many numbers stay in the processor's second-level cache.
_BLOCK = 2**15
# From this width on, doubling goes to _PIECE samples only, and the middle is taken in strides.
_WIDE, _PIECE, _STRIDE = 4096, 64, 32
# Of sorted stamps this many are looked up at a time.
_LOOKUP = 4096


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """When the samples are: ticks, as int64 or a range, and the ticks between neighbours where these are all equal."""

    ticks: Ints | range
    spacing: int | None

    def __len__(self) -> int:
        """How many samples there are."""
        return len(self.ticks)

    @property
    def times(self) -> Ints:
        """The ticks as an array, (n_samples,); not to be written to."""
        return ticks_array(self.ticks)

    def reversed(self) -> "Grid":
        """Return the same samples as seen backwards in time; where they are evenly spaced, it looks the same."""
        return self if self.spacing is not None else Grid(-self.times[::-1], None)


def always(values: Floats, grid: Grid, interval: Interval, out: Floats | None = None) -> Floats:
    """Return the least value in the window of every sample, +inf where the window is empty.

    Paper: robustness of always.

    Args:    values: (n_samples,) or (n_samples, n_traces). interval: closed, ticks ahead; (low, None) has no
             end. out: where to write, not overlapping `values`; it may be shorter, to have the first samples
             only; None: a new array.
    Returns: `out`, or the shape of `values`.
    """
    return _slide(np.minimum, values, grid, interval, out)


def eventually(values: Floats, grid: Grid, interval: Interval, out: Floats | None = None) -> Floats:
    """Return the greatest value in the window of every sample, -inf where the window is empty.

    Paper: robustness of eventually.

    Args:    as `always`.
    Returns: as `always`.
    """
    return _slide(np.maximum, values, grid, interval, out)


def historically(values: Floats, grid: Grid, interval: Interval, out: Floats | None = None) -> Floats:
    """Return `always` backwards in time, a short `out` the last samples; not in the paper, which has no past."""
    out = np.empty(values.shape) if out is None else out
    always(values[::-1], grid.reversed(), interval, out[::-1])
    return out


def once(values: Floats, grid: Grid, interval: Interval, out: Floats | None = None) -> Floats:
    """Return `eventually` backwards in time, a short `out` the last samples; not in the paper, which has no past."""
    out = np.empty(values.shape) if out is None else out
    eventually(values[::-1], grid.reversed(), interval, out[::-1])
    return out


def until(left: Floats, right: Floats, grid: Grid, interval: Interval, out: Floats | None = None) -> Floats:
    """Return the robustness of `left until[interval] right` at every sample; left counts on [t, t').

    Paper: robustness of until, by the identity
    p U[a,b] q = min(F[a,b] q, G[0,a) p, p U q at the first sample not before t + a): if p U q is decided
    after t + b, then p holds as well up to any sample of the window, and F[a,b] q names one.

    Args:    left, right: (n_samples,) or (n_samples, n_traces). interval, out: as `always`.
    Returns: `out`, or the shape of `left`.
    """
    low, high = interval
    out = np.empty(left.shape) if out is None else out
    unbounded = low == 0 and high is None and len(out) == len(left)
    onward = out if unbounded else np.empty(left.shape)
    suffix_until(_columns(left), _columns(right), _columns(onward))
    if unbounded:
        return out
    if grid.spacing is None:
        _until_uneven(left, right, index_windows(grid, interval), onward, out)
        return out
    shift(onward, -(-low // grid.spacing), -np.inf, out)
    scratch = onward[: len(out)]
    if low > 0:
        np.minimum(out, always(left, grid, (0, low - 1), scratch), out=out)
    if high is not None:
        np.minimum(out, eventually(right, grid, interval, scratch), out=out)
    return out


def since(left: Floats, right: Floats, grid: Grid, interval: Interval, out: Floats | None = None) -> Floats:
    """Return `until` backwards in time: left counts on (t', t]; not in the paper."""
    out = np.empty(left.shape) if out is None else out
    until(left[::-1], right[::-1], grid.reversed(), interval, out[::-1])
    return out


def index_windows(grid: Grid, interval: Interval) -> tuple[Ints, Ints]:
    """Return the windows as ranges of samples.

    Not in the paper: sampled time.

    Args:    interval: closed, ticks ahead.
    Returns: first and end (exclusive) of the window of every sample, (n_samples,) each; both never decrease,
             and first == end where the window is empty.
    """
    n, (low, high) = len(grid), interval
    index = np.arange(n, dtype=np.int64)
    if grid.spacing is not None:
        begin = np.minimum(index + min(-(-low // grid.spacing), n), n)
        count = n if high is None else min(high // grid.spacing + 1, n)
        end = np.minimum(index + count, n)
    else:
        times = grid.times
        span = int(times[-1]) - int(times[0])
        # Clipped to the length of the trace, which changes no window, so that the sums fit into int64.
        low, high = min(low, span + 1), span if high is None else min(high, span)
        begin = index if low == 0 else _positions(times, low, "left")
        end = np.full_like(index, n) if high == span else _positions(times, high, "right")
    return begin, np.maximum(begin, end)


def _positions(times: Ints, ahead: int, side: Literal["left", "right"]) -> Ints:
    """Return where times + ahead belong among the times; both ascend, so each block has a short range to search."""
    n = len(times)
    found = np.empty(n, dtype=np.int64)
    edges = [*np.searchsorted(times, times[::_LOOKUP] + ahead, side).tolist(), n]
    for number, first in enumerate(edges[:-1]):
        block = slice(number * _LOOKUP, (number + 1) * _LOOKUP)
        part = times[first : edges[number + 1] + 1]
        np.add(np.searchsorted(part, times[block] + ahead, side), first, out=found[block])
    return found


def _columns(values: Floats) -> Floats:
    """View as (n_samples, n_traces)."""
    return values if values.ndim == 2 else values[:, None]


def _slide(extremum: np.ufunc, values: Floats, grid: Grid, interval: Interval, out: Floats | None) -> Floats:
    out = np.empty(values.shape) if out is None else out
    low, high = interval
    if grid.spacing is not None:
        first = -(-low // grid.spacing)
        width = None if high is None else high // grid.spacing - first + 1
        _slide_even(extremum, _columns(values[first:]), width, _columns(out))
        return out
    begin, end = index_windows(grid, interval)
    if high is None:
        suffixes = np.empty(values.shape)
        suffix_extremum(extremum, _columns(values), _columns(suffixes))
        _gather(suffixes, begin, _identity(extremum), out)
    else:
        _slide_uneven(extremum, _columns(values), begin, end, _columns(out))
    return out


def _identity(extremum: np.ufunc) -> float:
    return np.inf if extremum is np.minimum else -np.inf


def _slide_even(extremum: np.ufunc, values: Floats, width: int | None, out: Floats) -> None:
    """Slide over `width` samples from sample i on, or all from there on; what is beyond the end is not there."""
    n = 0 if width is not None and width < 1 else min(len(values), len(out))
    out[n:] = _identity(extremum)
    n_whole = 0
    if width is not None and 0 < width < len(values):
        n_whole = min(n, len(values) - width + 1)
        slide = _widest_windows if width > n_whole else _whole_windows if width < _WIDE else _wide_windows
        slide(extremum, values[: n_whole + width - 1], width, out[:n_whole])
    if n_whole < n:
        # The windows that the end of the trace cuts off are suffixes.
        _suffixes(extremum, values[n_whole:], out[n_whole:n])


def _suffixes(extremum: np.ufunc, values: Floats, out: Floats) -> None:
    """Slide over all samples from sample i on; `out` may be shorter than `values`."""
    n = len(out)
    suffix_extremum(extremum, values[:n], out)
    if n < len(values):
        extremum(out, extremum.reduce(values[n:], axis=0), out=out)


def _whole_windows(extremum: np.ufunc, values: Floats, width: int, out: Floats) -> None:
    """Slide windows of `width` samples, none cut off, block by block."""
    n, k = out.shape
    rows = min(n, max(3 * width, _BLOCK // k))
    columns = min(k, max(8, -(-k // max(1, round(k * (rows + width) / _BLOCK)))))
    buffers = np.empty((2, (rows + width) * columns))
    for left in range(0, k, columns):
        for top in range(0, n, rows):
            target = out[top : top + rows, left : left + columns]
            piece = values[top : top + len(target) + width - 1, left : left + columns]
            _double(extremum, piece, width, target, buffers)


def _double(extremum: np.ufunc, piece: Floats, width: int, out: Floats, buffers: Floats) -> None:
    """Slide by repeated doubling: a window of 2k samples is two of k, and any window two that overlap."""
    if width == 1:
        out[...] = piece
        return
    current, span, turn = piece, 1, 0
    while 2 * span < width:
        rows = len(current) - span
        doubled = buffers[turn, : rows * out.shape[1]].reshape(rows, -1)
        extremum(current[:rows], current[span:], out=doubled)
        current, span, turn = doubled, 2 * span, 1 - turn
    shift = width - span
    extremum(current[: len(out)], current[shift : shift + len(out)], out=out)


def _wide_windows(extremum: np.ufunc, values: Floats, width: int, out: Floats) -> None:
    """Slide wide windows, none cut off: a piece at each end of the window, and the pieces in between.

    These begin at whole strides, so there are few of them, and a stride shares their extremum. The middle
    begins at the first whole stride after the sample, which the first piece reaches, and ends less than a
    piece before the window does.
    """
    n, shift = len(out), width - _PIECE
    # The last pieces have no place in `out`; they begin at a whole stride, like all blocks below.
    cut = (n - shift) // _STRIDE * _STRIDE
    _whole_windows(extremum, values[: n + _PIECE - 1], _PIECE, out)
    last = np.empty((n - cut, out.shape[1]))
    _whole_windows(extremum, values[cut + shift :], _PIECE, last)
    strides = np.concatenate([out[::_STRIDE], last[n + -n % _STRIDE - cut - shift :: _STRIDE]])
    count = width // _STRIDE - 2
    middles = np.empty((len(strides) - count + 1, out.shape[1]))
    _whole_windows(extremum, strides, count, middles)
    rows = max(_STRIDE, min(_BLOCK // out.shape[1], shift) // _STRIDE * _STRIDE)
    for begin, end, ends in ((0, cut, out[shift:]), (cut, n, last)):
        for top in range(begin, end, rows):
            target = out[top : min(top + rows, end)]
            extremum(target, ends[top - begin : top - begin + len(target)], out=target)
            _per_stride(extremum, middles[top // _STRIDE + 1 :], target)


def _widest_windows(extremum: np.ufunc, values: Floats, width: int, out: Floats) -> None:
    """Slide windows that all share their middle: before it a suffix, behind it what is read up to there."""
    n = len(out)
    _suffixes(extremum, values[:width], out)
    behind = np.empty((n - 1, out.shape[1]))
    if n > 1:
        suffix_extremum(extremum, values[: width - 1 : -1], behind[::-1])
    extremum(out[1:], behind, out=out[1:])


def _per_stride(extremum: np.ufunc, values: Floats, out: Floats) -> None:
    """Join value number i to stride number i of `out`; the last stride may be cut off."""
    n_whole = len(out) // _STRIDE
    whole = out[: n_whole * _STRIDE].reshape(n_whole, _STRIDE, out.shape[1])
    extremum(whole, values[:n_whole, None], out=whole)
    if n_whole * _STRIDE < len(out):
        rest = out[n_whole * _STRIDE :]
        extremum(rest, values[n_whole], out=rest)


def _slide_uneven(extremum: np.ufunc, values: Floats, begin: Ints, end: Ints, out: Floats) -> None:
    """Slide over the samples begin[i] to end[i], block by block."""
    n, k = out.shape
    begin, end = begin[:n], end[:n]
    rows = max(3 * int((end - begin).max()), _BLOCK // k, 1)
    for top in range(0, n, rows):
        block = slice(top, top + rows)
        first, last = int(begin[top]), int(end[block][-1])
        _block_uneven(extremum, values[first:last], begin[block] - first, end[block] - first, out[block])


def _block_uneven(extremum: np.ufunc, values: Floats, begin: Ints, end: Ints, out: Floats) -> None:
    lengths = end - begin
    shortest, longest = int(lengths.min()), int(lengths.max())
    if shortest == 0 or longest > 4 * shortest:
        _by_length(extremum, values, begin, end, out)
        return
    current, span = values, 1
    while 2 * span <= shortest:
        current, span = extremum(current[:-span], current[span:]), 2 * span
    # A window is at most eight pieces, which may overlap.
    last = end - span
    current.take(last, axis=0, out=out, mode="clip")
    for done in range(0, longest - span, span):
        extremum(out, current.take(np.minimum(begin + done, last), axis=0), out=out)


def _by_length(extremum: np.ufunc, values: Floats, begin: Ints, end: Ints, out: Floats) -> None:
    """Slide over windows of very unequal length, by doubling: each level serves the windows of its length."""
    lengths = end - begin
    out[lengths == 0] = _identity(extremum)
    # frexp counts the binary digits: level l holds lengths from 2**l to 2**(l+1) - 1, level -1 the length 0.
    levels = (np.frexp(lengths)[1] - 1).astype(np.int8)
    current, span = values, 1
    highest = int(levels.max())
    for level in range(highest + 1):
        chosen = np.flatnonzero(levels == level)
        if len(chosen):
            out[chosen] = extremum(current[begin[chosen]], current[end[chosen] - span])
        if level < highest:
            current, span = extremum(current[:-span], current[span:]), 2 * span


def _until_uneven(left: Floats, right: Floats, window: tuple[Ints, Ints], onward: Floats, out: Floats) -> None:
    """Write until, given the windows and, in `onward` (overwritten), until without bounds."""
    begin, end = window
    _gather(onward, begin, -np.inf, out)
    scratch = onward[: len(out)]
    _slide_uneven(np.minimum, _columns(left), np.arange(len(begin), dtype=np.int64), begin, _columns(scratch))
    np.minimum(out, scratch, out=out)
    _slide_uneven(np.maximum, _columns(right), begin, end, _columns(scratch))
    np.minimum(out, scratch, out=out)


def shift(values: Floats, count: int, beyond: float, out: Floats) -> None:
    """Write values[i + count] to out[i], `beyond` past the end.

    Paper: none; `next` shifts by one sample.
    """
    kept = max(0, min(len(out), len(values) - count))
    out[:kept] = values[count : count + kept]
    out[kept:] = beyond


def _gather(values: Floats, index: Ints, beyond: float, out: Floats) -> None:
    """Write values[index[i]] to out[i], `beyond` where the index is past the end."""
    n_inside = int(np.searchsorted(index[: len(out)], len(values)))
    out[:n_inside] = values[index[:n_inside]]
    out[n_inside:] = beyond
