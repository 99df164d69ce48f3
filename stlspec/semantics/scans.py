"""Suffix scans: running extremum and running until, from the last sample back to the first.

In: arrays (n_samples, n_traces), time along axis 0. Out: at every sample the scan of all samples from it on.
Both scans are associative, so a long array is cut into lanes that are scanned side by side, one numpy call a
step for all lanes; the heads of the lanes are scanned by the same function, and what lies behind a lane is
then added to all its samples at once. The number of numpy calls grows with the square root of the length.
"""

from math import isqrt

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_SMALL = 4096
_MANY_TRACES = 128


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
    identity = np.inf if extremum is np.minimum else -np.inf
    lanes = _to_lanes(values, identity)
    for j in range(len(lanes) - 2, -1, -1):
        extremum(lanes[j], lanes[j + 1], out=lanes[j])
    heads = np.empty(lanes.shape[1:])
    suffix_extremum(extremum, lanes[0], heads)
    extremum(lanes[:, :-1], heads[1:], out=lanes[:, :-1])
    _from_lanes(lanes, out)


def suffix_until(left: Floats, right: Floats, out: Floats) -> None:
    """Write to out[i] the robustness of the unbounded `left until right` at sample i.

    Paper: robustness of until. It obeys u[i] = max(right[i], min(left[i], u[i+1])) with u = -inf past the
    end, and the composition of two such clamps is again one:
    max(q, min(p, max(Q, min(P, x)))) = max(max(q, min(p, Q)), min(min(p, P), x)).

    Args:    left, right: (n_samples, n_traces). out: the same shape, another array.
    """
    n, k = left.shape
    if n * k <= _SMALL:
        _until_by_doubling(left, right, out)
        return
    if k >= _MANY_TRACES:
        _until_by_rows(left, right, out)
        return
    lows, highs = _to_lanes(left, np.inf), _to_lanes(right, -np.inf)
    scratch = np.empty(lows.shape[1:])
    for j in range(len(lows) - 2, -1, -1):
        np.minimum(lows[j], highs[j + 1], out=scratch)
        np.maximum(highs[j], scratch, out=highs[j])
        np.minimum(lows[j], lows[j + 1], out=lows[j])
    heads = np.empty(scratch.shape)
    suffix_until(lows[0], highs[0], heads)
    np.minimum(lows[:, :-1], heads[1:], out=lows[:, :-1])
    np.maximum(highs[:, :-1], lows[:, :-1], out=highs[:, :-1])
    _from_lanes(highs, out)


def _until_by_doubling(left: Floats, right: Floats, out: Floats) -> None:
    lows = left.copy()
    out[...] = right
    span = 1
    while span < len(out):
        reached = np.minimum(lows[:-span], out[span:])
        out[:-span] = np.maximum(out[:-span], reached)
        lows[:-span] = np.minimum(lows[:-span], lows[span:])
        span *= 2


def _until_by_rows(left: Floats, right: Floats, out: Floats) -> None:
    out[-1] = right[-1]
    scratch = np.empty(out.shape[1])
    for i in range(len(out) - 2, -1, -1):
        np.minimum(left[i], out[i + 1], out=scratch)
        np.maximum(right[i], scratch, out=out[i])


def _to_lanes(values: Floats, padding: float) -> Floats:
    """Copy to (n_steps, n_lanes, n_traces): lane r holds samples r * n_steps and on; the last is padded."""
    n, k = values.shape
    steps = min(n, max(2, isqrt(n * k) // 2))
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
