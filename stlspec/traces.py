"""Traces: sampled signals on integer time, validated once.

In: the columns of one recording (or of a batch of recordings) and the spec's declarations. Out: an immutable
`Trace` whose arrays nobody else holds. Time becomes int64 ticks here, relative to the first stamp, and is
rounded here only: from then on every window is found by integer arithmetic, so every engine finds the same.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stlspec.columns import first_true, snapped, to_column, unmasked
from stlspec.compiler.bundle import Signal, TimeBase
from stlspec.compiler.notation import off_period
from stlspec.compiler.printing import counted, number_text
from stlspec.errors import DataError, diagnostic
from stlspec.lang.spelling import closest_column

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# A window ends at most one trace length after its sample, so twice the longest trace must fit into int64.
_LONGEST_TICKS = 2.0**62
_INT64_MOST = np.iinfo(np.int64).max
# Ticks of up to this many samples are kept for the next trace of the same length.
_LONGEST_SHARED = 2**20
_PERIOD_TOLERANCE = 0.01 * (1 + 1e-9)


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """Sampled signals; of one recording, or of a batch of recordings with common times.

    ticks: since the first sample, strictly increasing: int64, (n_samples,), or a range where no stamps tell them.
    signals: float64, (n_samples,), for a batch time-major (n_samples, n_traces); Booleans are 1.0 and 0.0.
    spacing: ticks between samples if it is the same everywhere (or there is one sample), else None.
    ticks_per_unit, unit: of the spec's time. stamps: the time stamps as given, in `unit`, if they mean
    anything (not for `time step`). numbers: for a batch, the number of each trace in messages. first: the number
    of the first sample in messages, in a piece of a longer recording (`semantics.streaming`); its times go on.
    """

    ticks: Ints | range
    signals: Mapping[str, Floats]
    spacing: int | None
    ticks_per_unit: int
    unit: str = "step"
    stamps: Floats | None = None
    numbers: tuple[int, ...] | None = None
    file: str | None = None
    first: int = 0

    @property
    def n_samples(self) -> int:
        """Number of samples."""
        return len(self.ticks)

    @property
    def times(self) -> Ints:
        """The ticks of the samples as an array, (n_samples,); not to be written to."""
        return ticks_array(self.ticks)

    @property
    def n_traces(self) -> int:
        """Number of traces: 1 unless this is a batch."""
        return 1 if self.numbers is None else len(self.numbers)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of every signal."""
        return (self.n_samples,) if self.numbers is None else (self.n_samples, self.n_traces)

    def columns(self, first: int, end: int, n_samples: int) -> "Trace":
        """Return the first `n_samples` samples of the traces of a batch from number `first` in it up to `end`."""
        assert self.numbers is not None
        parts = {name: np.ascontiguousarray(values[:n_samples, first:end]) for name, values in self.signals.items()}
        return replace(self, ticks=self.ticks[:n_samples], signals=parts, numbers=self.numbers[first:end])

    def time(self, sample: int) -> float:
        """Return the time of a sample in the spec's unit, as it was given if it was given."""
        if self.stamps is not None:
            return float(self.stamps[sample])
        return int(self.ticks[sample]) / self.ticks_per_unit

    def place(self, sample: int, column: int = 0) -> str:
        """Name a sample in a message: "3", or "3 of trace 1" in a batch."""
        return str(self.first + sample) if self.numbers is None else f"{sample} of trace {self.numbers[column]}"


def make_trace(
    base: TimeBase,
    declared: Sequence[Signal],
    signals: Mapping[str, ArrayLike],
    time: ArrayLike | None = None,
    *,
    required: Collection[str] | None = None,
    numbers: Sequence[int] | None = None,
    file: str | None = None,
) -> Trace:
    """Check the columns of a recording against the declarations and make a trace of them.

    Not in the paper, which takes traces as given.

    Args:
        base: how the spec measures time.
        declared: the declared signals; other columns are ignored, but still tell how many samples there are.
        signals: for each name n_samples numbers or Booleans, or (n_traces, n_samples) of them for a batch.
        time: n_samples time stamps in the spec's unit, common to a batch.
        required: names of the signals that must be there; None: all declared ones.
        numbers: for a batch, the numbers of its traces in messages; None: from 0.
        file: where the data come from, for messages.

    Returns: the trace; its arrays are copies.

    Raises:
        DataError: a signal is missing, has a wrong length or shape, or a value that is no number, is NaN or
            outside its declared range; there are no samples; time does not increase, does not fit the
            period, or is absent where the spec needs it.
    """
    needed = {s.name for s in declared} if required is None else required
    columns: dict[str, Floats] = {}
    for signal in declared:
        if signal.name in signals:
            values = signals[signal.name]
            columns[signal.name] = to_column(signal.name, values, file, signal.type, numbers or ())
        elif signal.name in needed:
            raise _missing(signal.name, signals, file)
    shape = _common_shape(columns, signals, time, numbers, file)
    ticks, stamps = sample_ticks(base, shape[0], time, file)
    if len(shape) == 1:
        numbers = None
    elif numbers is None:
        numbers = range(shape[1])
    trace = Trace(
        ticks=ticks if isinstance(ticks, range) else _frozen(ticks),
        signals=MappingProxyType({name: _frozen(column) for name, column in columns.items()}),
        spacing=_spacing(base, ticks, stamps),
        ticks_per_unit=base.ticks_per_unit,
        unit=base.unit,
        stamps=None if stamps is None else _frozen(stamps),
        numbers=None if numbers is None else tuple(numbers),
        file=file,
    )
    check_values(trace, declared)
    return trace


def time_ticks(base: TimeBase, n: int, time: ArrayLike | None, file: str | None = None) -> Ints:
    """Return the ticks of n samples since the first, whatever period the spec declares.

    Not in the paper: exactness of time.

    Returns: int64, (n_samples,), strictly increasing; without stamps, those of the spec's period.
    Raises:  DataError D802, D805, D806, D810, D812: stamps are needed and missing, or cannot be used.
    """
    free = base if time is None else replace(base, kind="stamps", period=None)
    return ticks_array(sample_ticks(free, n, time, file)[0])


def ticks_array(ticks: Ints | range) -> Ints:
    """Return ticks as int64, (n_samples,); not to be written to, for traces of one length share them.

    Not in the paper: exactness of time.
    """
    if not isinstance(ticks, range):
        return ticks
    return _shared_ticks(ticks) if len(ticks) <= _LONGEST_SHARED else _array_of(ticks)


def whole_stamps(values: ArrayLike) -> Ints | None:
    """Return time stamps as int64 if all are whole numbers by their type that fit; else None.

    Not in the paper: exactness of time.
    """
    array = np.asarray(values)
    if array.dtype.kind not in "iu" or (array.dtype == np.uint64 and array.max(initial=0) > _INT64_MOST):
        return None
    return array.astype(np.int64)


def _frozen(values: NDArray[Any]) -> NDArray[Any]:
    values.flags.writeable = False
    return values


def _error(code: str, file: str | None, **fields: Any) -> DataError:
    return DataError([diagnostic(code, file=file, **fields)])


def _missing(name: str, signals: Mapping[str, ArrayLike], file: str | None) -> DataError:
    close = closest_column(name, [str(s) for s in signals])
    known = ", ".join(f"'{s}'" for s in list(signals)[:5])
    hint = f"did you mean '{close}'?" if close else f"the data has {known or 'no signals'}"
    return _error("D804", file, signal=name, help=f'{hint} (`from "{close}"` reads it)' if close else hint)


def _common_shape(
    columns: Mapping[str, Floats],
    signals: Mapping[str, ArrayLike],
    time: ArrayLike | None,
    numbers: Sequence[int] | None,
    file: str | None,
) -> tuple[int, ...]:
    """Return (n_samples,) or (n_samples, n_traces), the same for all signals."""
    shapes = {name: column.shape for name, column in columns.items()}
    if not shapes:
        # No declared signal is here (the formulas use `now` only): any column tells the length.
        others = list(signals.items())[:1] or ([] if time is None else [("time", time)])
        shapes = {name: to_column(name, values, file).shape for name, values in others}
    if not shapes:
        raise _error("D803", file, where=": there is neither a signal nor a time stamp")
    other, expected = next(iter(shapes.items()))
    for name, shape in shapes.items():
        if len(shape) != len(expected):
            raise _error("D813", file, what=f"'{name}'", problem=f"is not laid out like '{other}'")
        if shape[0] != expected[0]:
            raise _error(
                "D805", file, signal=name, samples=counted(shape[0], "sample"), other=other, expected=expected[0]
            )
        if shape != expected:
            problem = f"has {shape[1]} traces, but '{other}' has {expected[1]}"
            raise _error("D813", file, what=f"'{name}'", problem=problem)
    if 0 in expected:
        empty = f" in trace {numbers[0]}" if numbers else ""
        raise _error("D803", file, where=empty if expected[0] == 0 else ": the batch has no traces")
    return expected


def sample_ticks(
    base: TimeBase, n: int, time: ArrayLike | None, file: str | None, shift: int = 0
) -> tuple[Ints | range, Floats | None]:
    """Return the ticks of n samples since the first, and the stamps if they count.

    Not in the paper: exactness of time.

    Args:   shift: what is added to the number of a sample in messages.
    Raises: DataError D802, D805, D806, D810 to D813: stamps are needed and missing, or cannot be used.
    """
    if time is None:
        if base.kind == "stamps":
            raise _error("D810", file, unit=base.unit)
        return _even_ticks(n, base.period or 1), None
    time = unmasked(time)
    stamps = to_column("time", time, file)
    if stamps.ndim != 1:
        raise _error("D813", file, what="'time'", problem="has one row for each trace, but the signals do not")
    if len(stamps) != n:
        raise _error("D805", file, signal="time", samples=counted(len(stamps), "sample"), other="signals", expected=n)
    with np.errstate(all="ignore"):
        ticks = (stamps - stamps[0]) * base.ticks_per_unit
    kept = np.isfinite(stamps) & (np.abs(ticks) < _LONGEST_TICKS)
    if not kept.all():
        at = int((~kept).argmax())
        raise _error("D812", file, time=number_text(stamps[at]), sample=at + shift)
    whole = whole_stamps(time)
    if whole is None:
        rounded = np.rint(ticks).astype(np.int64)
    else:
        # Nanoseconds since 1970 are beyond what float64 tells apart: whole stamps stay whole until here.
        rounded = (whole - whole[0]) * base.ticks_per_unit
        ticks = rounded.astype(np.float64)
    given = stamps if whole is None else whole
    _check_increasing(given if base.kind != "stamps" else rounded, given, file, shift)
    if base.kind == "step":
        return _even_ticks(n, 1), None
    if base.kind == "period":
        rounded = _on_period(base, stamps, ticks, file, shift)
    return rounded, stamps


def _even_ticks(n: int, period: int) -> range:
    return range(0, n * period, period)


def _array_of(ticks: range) -> Ints:
    return np.arange(len(ticks), dtype=np.int64) * ticks.step + ticks.start


@lru_cache(maxsize=4)
def _shared_ticks(ticks: range) -> Ints:
    return _frozen(_array_of(ticks))


def _check_increasing(values: NDArray[Any], stamps: Floats | Ints, file: str | None, shift: int) -> None:
    wrong = values[1:] <= values[:-1]
    if wrong.any():
        at = int(wrong.argmax()) + 1
        previous, this = (str(s) if isinstance(s, int) else number_text(s) for s in stamps[at - 1 : at + 1].tolist())
        raise _error("D802", file, sample=at + shift, time=this, previous=previous)


def _on_period(base: TimeBase, stamps: Floats, ticks: Floats, file: str | None, shift: int) -> Ints:
    """Take stamps that are close to k periods after the first as exactly that."""
    period = base.period or 1
    periods = ticks / period
    whole = np.rint(periods)
    wrong = np.abs(periods - whole) > _PERIOD_TOLERANCE
    # Two stamps within the tolerance of the same multiple: the later one is not the next multiple.
    wrong[1:] |= whole[1:] <= whole[:-1]
    if wrong.any():
        at = int(wrong.argmax())
        length = f"{number_text(period / base.ticks_per_unit)} {base.unit}"
        shown = number_text(stamps[at])
        way = off_period(base, float(np.diff(stamps).min()))
        raise _error("D811", file, sample=at + shift, time=shown, period=length, unit=base.unit, help=way)
    return whole.astype(np.int64) * period


def _spacing(base: TimeBase, ticks: Ints | range, stamps: Floats | None) -> int | None:
    if stamps is None or len(ticks) == 1:
        return base.period or 1
    steps = np.diff(ticks)
    return int(steps[0]) if (steps == steps[0]).all() else None


def check_values(trace: Trace, declared: Sequence[Signal]) -> None:
    """Refuse NaN, and samples outside the range that their signal declares; `snapped` decides on its very edge.

    Not in the paper, which takes traces as given. Raises: DataError D801, D807.
    """
    for signal in declared:
        column = trace.signals.get(signal.name)
        if column is None:
            continue
        with np.errstate(invalid="ignore"):
            least = column.min()
        if np.isnan(least):
            at = first_true(np.isnan(column))
            raise _error("D801", trace.file, signal=signal.name, **_where(trace, at))
        low = -np.inf if signal.low is None else signal.low
        high = np.inf if signal.high is None else signal.high
        if (low, high) == (-np.inf, np.inf):
            continue
        outside = (column < low) | (column > high)
        if outside.any():
            column.flags.writeable = True  # nobody else holds it yet
            snapped(column, low, high)
            column.flags.writeable = False
            outside = (column < low) | (column > high)
        if outside.any():
            at = first_true(outside)
            bounds = {"low": number_text(low), "high": number_text(high)}
            value = number_text(column[at])
            where = _where(trace, at)
            raise _error("D807", trace.file, signal=signal.name, value=value, **bounds, **where)


def _where(trace: Trace, at: tuple[int, ...]) -> dict[str, str]:
    return {"sample": trace.place(*at), "time": number_text(trace.time(at[0]))}
