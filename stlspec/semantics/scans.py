"""Suffix scans: running extremum and running until, from the last sample back to the first.

In: arrays (n_samples, n_traces), time along axis 0. Out: at every sample the scan of all samples from it on.
Both scans are associative. A long array is taken block by block from its end; a block is cut into lanes that
are scanned side by side, one numpy call a step for all lanes, and what lies behind a lane is then added to
all its samples at once. So there is no loop over samples, and all scratch memory stays in the cache.
"""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_SMALL = 4096
_BLOCK = 2**16
_STEPS = 32
_MANY_TRACES = 64


def suffix_extremum(extremum: np.ufunc, values: Floats, out: Floats) -> None:
    """Write to out[i] the extremum of values[i:].

    Paper: robustness of the unbounded always and eventually.

    Args:    extremum: np.minimum or np.maximum. values: (n_samples, n_traces). out: the same shape, another
             array.
    """
    n, k = values.shape
    if n * k <= _SMALL:
        extremum.accumulate(values[::-1], axis=0, out=out[::-1])
        return
    if k >= _MANY_TRACES:
        out[-1] = values[-1]
        for i in range(n - 2, -1, -1):
            extremum(values[i], out[i + 1], out=out[i])
        return
    beyond = np.full((1, k), np.inf if extremum is np.minimum else -np.inf)
    for block in _blocks(n, k):
        _extremum_of_block(extremum, values[block], beyond, out[block])
        beyond = out[block.start : block.start + 1]


def suffix_until(left: Floats, right: Floats, out: Floats) -> None:
    """Write to out[i] the robustness of the unbounded `left until right` at sample i.

    Paper: robustness of until. It obeys u[i] = max(right[i], min(left[i], u[i+1])) with u = -inf past the
    end, and the composition of two such clamps is again one:
    max(q, min(p, max(Q, min(P, x)))) = max(max(q, min(p, Q)), min(min(p, P), x)).

    Args:    left, right: (n_samples, n_traces). out: the same shape, another array.
    """
    n, k = left.shape
    beyond = np.full((1, k), -np.inf)
    if n * k <= _SMALL:
        _until_by_doubling(left, right, beyond, out)
        return
    if k >= _MANY_TRACES:
        _until_by_rows(left, right, out)
        return
    for block in _blocks(n, k):
        _until_of_block(left[block], right[block], beyond, out[block])
        beyond = out[block.start : block.start + 1]


def _blocks(n: int, k: int) -> list[slice]:
    """Cut n samples into blocks, the last one first."""
    rows = max(_BLOCK // k, 2)
    return [slice(max(0, end - rows), end) for end in range(n, 0, -rows)]


def _extremum_of_block(extremum: np.ufunc, values: Floats, beyond: Floats, out: Floats) -> None:
    lanes = _to_lanes(values, np.inf if extremum is np.minimum else -np.inf)
    for j in range(len(lanes) - 2, -1, -1):
        extremum(lanes[j], lanes[j + 1], out=lanes[j])
    heads = np.concatenate([lanes[0], beyond])
    extremum.accumulate(heads[::-1], axis=0, out=heads[::-1])
    extremum(lanes, heads[1:], out=lanes)
    _from_lanes(lanes, out)


def _until_of_block(left: Floats, right: Floats, beyond: Floats, out: Floats) -> None:
    lows, highs = _to_lanes(left, np.inf), _to_lanes(right, -np.inf)
    scratch = np.empty(lows.shape[1:])
    for j in range(len(lows) - 2, -1, -1):
        np.minimum(lows[j], highs[j + 1], out=scratch)
        np.maximum(highs[j], scratch, out=highs[j])
        np.minimum(lows[j], lows[j + 1], out=lows[j])
    heads = np.concatenate([highs[0], beyond])
    _until_by_doubling(lows[0], highs[0], beyond, heads[:-1])
    np.minimum(lows, heads[1:], out=lows)
    np.maximum(highs, lows, out=highs)
    _from_lanes(highs, out)


def _until_by_doubling(left: Floats, right: Floats, beyond: Floats, out: Floats) -> None:
    """Scan with every call twice as far; `beyond`: the value after the last sample."""
    lows = left.copy()
    out[...] = right
    span = 1
    while span < len(out):
        reached = np.minimum(lows[:-span], out[span:])
        out[:-span] = np.maximum(out[:-span], reached)
        lows[:-span] = np.minimum(lows[:-span], lows[span:])
        span *= 2
    np.maximum(out, np.minimum(lows, beyond), out=out)


def _until_by_rows(left: Floats, right: Floats, out: Floats) -> None:
    out[-1] = right[-1]
    scratch = np.empty(out.shape[1])
    for i in range(len(out) - 2, -1, -1):
        np.minimum(left[i], out[i + 1], out=scratch)
        np.maximum(right[i], scratch, out=out[i])


def _to_lanes(values: Floats, padding: float) -> Floats:
    """Copy to (n_steps, n_lanes, n_traces): lane r holds samples r * n_steps and on; the last is padded."""
    n, k = values.shape
    steps = min(n, _STEPS)
    n_full = n // steps
    rest = n - n_full * steps
    lanes = np.empty((steps, n_full + (rest > 0), k))
    by_lane = lanes.transpose(1, 0, 2)
    by_lane[:n_full] = values[: n_full * steps].reshape(n_full, steps, k)
    if rest:
        by_lane[n_full, :rest] = values[n_full * steps :]
        by_lane[n_full, rest:] = padding
    return lanes


def _from_lanes(lanes: Floats, out: Floats) -> None:
    n, k = out.shape
    steps = len(lanes)
    n_full = n // steps
    # Splitting one axis never copies, also where `out` runs backwards in time.
    out[: n_full * steps].reshape(n_full, steps, k)[...] = lanes[:, :n_full].transpose(1, 0, 2)
    rest = n - n_full * steps
    if rest:
        out[n_full * steps :] = lanes[:rest, n_full]
