"""Columns: the values of one signal as a caller has them, made float64.

In: a list, an array, a masked array, of numbers or Booleans. Out: a fresh array with time along the first axis, or
a diagnostic that names the first value that is no number. What the values may be is checked by `make_trace`.
"""

import struct
import sys
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stlspec.compiler.printing import number_text
from stlspec.errors import DataError, diagnostic

Floats = NDArray[np.float64]


_LARGEST_SINGLE = 3e38


def to_column(
    name: str, values: ArrayLike, file: str | None, kind: str = "real", numbers: Sequence[int] = (), first: int = 0
) -> Floats:
    """Convert the values of one signal to float64.

    Not in the paper, which takes traces as given.

    Args:    name, file, numbers: of the signal, its file and its traces, for messages. values: (n_samples,) numbers or
             Booleans, or (n_traces, n_samples) of them. kind: "real" or "bool". first: the number of the first sample.
    Returns: a fresh array, (n_samples,), or time-major (n_samples, n_traces).
    Raises:  DataError D806, D813: a value is no number, or there is no column of them.
    """
    values = unmasked(values)
    try:
        raw = np.asarray(_packed(values))
    except (ValueError, TypeError, OverflowError):
        raise _error("D813", file, what=f"'{name}'", problem="has rows of unequal length or depth") from None
    if raw.ndim not in (1, 2):
        problem = "is a single value" if raw.ndim == 0 else f"has {raw.ndim} dimensions"
        raise _error("D813", file, what=f"'{name}'", problem=problem)
    if raw.dtype.kind not in "biuf":
        raw = _converted(values, name, kind, numbers, file, first)
    with np.errstate(over="ignore"):
        result = np.array(raw.T, dtype=np.float64, order="C", copy=True)
    if kind == "bool":
        wrong = (result != 0) & (result != 1) & ~np.isnan(result)
        if wrong.any():
            at = first_true(wrong)
            raise _bad_value(name, kind, result[at], at, numbers, file, first)
    return result


def _packed(values: Any) -> Any:
    """Turn a list of plain numbers into an array, faster than numpy reads it; leave anything else as it is."""
    if not isinstance(values, list | tuple) or not values or type(values[0]) not in (float, int, bool):
        return values
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a complex of numpy only warns that it loses its imaginary part
            return np.frombuffer(struct.pack(f"{len(values)}d", *values))
    except (TypeError, OverflowError, struct.error, Warning):
        return values


def _converted(values: ArrayLike, name: str, kind: str, numbers: Sequence[int], file: str | None, first: int) -> Floats:
    """Convert what numpy does not see as numbers; the first value that is none is reported."""
    objects = np.asarray(values, dtype=object)
    result = np.empty(objects.shape)
    for at, value in np.ndenumerate(objects):
        try:
            if isinstance(value, (str, bytes, complex, np.complexfloating)):
                raise TypeError
            result[at] = value
        except (TypeError, ValueError, OverflowError):
            raise _bad_value(name, kind, value, at[::-1], numbers, file, first) from None
    return result


def _bad_value(
    name: str, kind: str, value: object, at: tuple[int, ...], numbers: Sequence[int], file: str | None, first: int
) -> DataError:
    shown = number_text(float(value)) if isinstance(value, (float, np.floating)) else _clipped(repr(value))
    where = str(first + at[0]) if len(at) == 1 else f"{at[0]} of trace {numbers[at[1]] if numbers else at[1]}"
    hint = "write true, false, 1 or 0" if kind == "bool" else "write a number, inf or -inf"
    return _error("D806", file, signal=name, value=shown, sample=where, type=kind, help=hint)


def _clipped(text: str) -> str:
    return text if len(text) <= 30 else text[:29] + "…"


def snapped(values: Floats, low: float, high: float) -> None:
    """Write a bound over values beyond it that are what 32 bits make of it: -1.2 comes back as -1.2000000476837158.

    Not in the paper: environments, sensors and files measure in 32 bits, but bounds are declared in 64.
    """
    for bound, beyond in ((low, values < low), (high, values > high)):
        if beyond.any() and abs(bound) < _LARGEST_SINGLE:
            values[beyond & (values == float(np.float32(bound)))] = bound


def first_true(mask: NDArray[np.bool_]) -> tuple[int, ...]:
    """Return the index of the first True, earliest sample first; not in the paper."""
    return tuple(int(i) for i in np.unravel_index(int(mask.argmax()), mask.shape))


def unmasked(values: Any) -> Any:
    """Return samples with NaN where a masked array hides them, since a hidden value is no sample.

    Not in the paper: an interface.
    """
    # Where there is a masked array, this has been imported; importing it here would take time and memory.
    masked = getattr(sys.modules.get("numpy.ma"), "MaskedArray", ())
    if isinstance(values, masked):
        kind = np.float64 if values.dtype.kind in "biuf" else object
        return values.astype(kind).filled(np.nan)
    if isinstance(values, list | tuple) and values and not isinstance(values[0], int | float):
        return [unmasked(row) if isinstance(row, masked) else row for row in values]
    return values


def _error(code: str, file: str | None, **fields: Any) -> DataError:
    return DataError([diagnostic(code, file=file, **fields)])
