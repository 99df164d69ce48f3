"""The samples of a recording: units of stamps, holes, and sampling again at a steady rate.

In: a recording and what the user asked for. Out: a recording whose samples can be evaluated, or one that still
has its holes, for the evaluation to refuse by place. Nothing is interpolated: between two samples a signal has the
value of the earlier one, so every value was measured.
"""

import difflib
import re
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from typing import Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.printing import number_text
from stlspec.errors import DataError, UsageError, diagnostic
from stlspec.lang.units import NANOSECONDS
from stlspec.readers.model import Array, Recording, column_of
from stlspec.traces import time_ticks

OnNan: TypeAlias = Literal["refuse", "hold", "drop"]
Ints = npt.NDArray[np.int64]

_PERIOD = re.compile(r"\s*([0-9]+\.?[0-9]*|\.[0-9]+)\s*([a-z]+)\s*")
_MOST_SAMPLES = 10**8


def check_on_nan(on_nan: str) -> None:
    """Refuse a word that names no treatment of NaN.

    Not in the paper: an interface.

    Raises: UsageError D880.
    """
    words = get_args(OnNan)
    if on_nan not in words:
        close = difflib.get_close_matches(str(on_nan).lower(), words, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"it is one of {', '.join(words)}"
        raise UsageError([diagnostic("D880", what=f"on_nan = {str(on_nan)[:30]!r} is no way to treat NaN", help=hint)])


def period_of(text: str) -> int:
    """Read a sampling period such as "100ms" or "0.5 s".

    Not in the paper: an interface.

    Returns: nanoseconds, >= 1.
    Raises:  UsageError D844: it is no positive time with a unit, or no whole number of nanoseconds.
    """
    found = _PERIOD.fullmatch(text)
    length = Fraction(0)
    if found and found[2] in NANOSECONDS:
        length = Fraction(found[1]) * NANOSECONDS[found[2]]
    if length <= 0 or length.denominator != 1 or length >= 2**62:
        raise UsageError([diagnostic("D844", text=str(text)[:40])])
    return int(length)


def in_unit_of(recording: Recording, base: TimeBase) -> Recording:
    """Convert stamps whose unit the file itself tells to the unit that the spec measures time in.

    Not in the paper: file formats.

    Returns: the recording; whole stamps stay whole where the units allow it, else they count from the first.
    """
    unit, time = recording.time_unit, recording.time
    if unit is None or time is None or base.kind == "step":
        return recording
    step, size = NANOSECONDS[unit], base.ticks_per_unit
    if step % size == 0:
        return replace(recording, time=time * (step // size), time_unit=None)
    ticks, first = (time - time[0]) * step, time[0] * step
    whole = size == 1 or (not (ticks % size).any() and first % size == 0)
    return replace(recording, time=(ticks + first) // size if whole else ticks / size, time_unit=None)


def resampled(
    recording: Recording, keys: Iterable[str], base: TimeBase, period: int, on_nan: OnNan, file: str
) -> Recording:
    """Take the value of every signal each `period`, from the first sample to the last.

    Not in the paper: robot logs, whose sensors have rates of their own and drop out.

    Args:    recording: as `settled` leaves it, but with "hold" before holes are filled: a signal holds its own
             last value, whenever that was. keys: the columns that a spec reads. period: nanoseconds.
             on_nan: with "hold", sampling begins where every signal has had a value; else there are no holes.
    Returns: the recording at a steady rate, its stamps in the unit of the spec; actions, which belong to steps
             that are gone, are left out.
    Raises:  DataError D801, D802, D810, D812: holes, or stamps that cannot be used; D845: too many samples would
             come out. UsageError D846: the spec counts samples, or its own period does not fit.
    """
    _check_period(base, period)
    columns = {key: recording.columns[key] for key in keys if key in recording.columns}
    ticks = time_ticks(base, recording.n_samples, recording.time, file)
    holes = {key: _holes(values) for key, values in columns.items()}
    if on_nan != "hold":
        _refuse_holes(recording, holes, base, ticks, file)
    begin = max((_first_value(ticks, hole, key, file) for key, hole in holes.items()), default=int(ticks[0]))
    count = (int(ticks[-1]) - begin) // period + 1
    if count > _MOST_SAMPLES:
        raise DataError([diagnostic("D845", file=file, count=f"{count:,}", most=f"{_MOST_SAMPLES:,}")])
    grid = begin + np.arange(count, dtype=np.int64) * period
    newest = np.searchsorted(ticks, grid, side="right") - 1
    taken = {key: values[newest] for key, values in recording.columns.items() if key not in columns}
    taken |= {key: _held_at(values, holes[key], newest) for key, values in columns.items()}
    return replace(
        recording,
        time=_stamps_of(grid, recording.time, base),
        columns=taken,
        states=None if recording.states is None else tuple(recording.states[k] for k in newest),
        actions=None,
    )


def _check_period(base: TimeBase, period: int) -> None:
    reason, way_out = "", ""
    if base.kind == "step":
        reason, way_out = "the spec counts samples", "write `time s`, or `time` with a period, in the spec"
    elif base.period and period % base.period:
        own = f"{number_text(base.period / base.ticks_per_unit)} {base.unit}"
        reason, way_out = f"the spec has a sample every {own}", f"use --resample {own.replace(' ', '')}, or a multiple"
    if reason:
        raise UsageError([diagnostic("D846", reason=reason, help=way_out)])


def _refuse_holes(
    recording: Recording, holes: dict[str, npt.NDArray[np.bool_]], base: TimeBase, ticks: Ints, file: str
) -> None:
    for key, hole in holes.items():
        if hole.any():
            sample = int(hole.argmax())
            time = float(ticks[sample] / base.ticks_per_unit if recording.time is None else recording.time[sample])
            raise DataError([diagnostic("D801", file=file, signal=key, sample=sample, time=number_text(time))])


def _first_value(ticks: Ints, hole: npt.NDArray[np.bool_], key: str, file: str) -> int:
    if hole.all():
        raise DataError([diagnostic("D801", file=file, signal=key, sample=0, time=number_text(0.0))])
    return int(ticks[hole.argmin()])


def _held_at(values: Array, hole: npt.NDArray[np.bool_], newest: Ints) -> Array:
    last = np.maximum.accumulate(np.where(hole, 0, np.arange(len(values))))
    return _again(values[last[newest]])


def _stamps_of(grid: Ints, time: Array | None, base: TimeBase) -> Array:
    """Return the stamps of ticks counted from the first stamp; whole where all can be."""
    size = base.ticks_per_unit
    if time is None:
        return grid / size
    if time.dtype.kind == "i" and not (grid % size).any():
        return np.asarray(grid // size + time[0])
    return np.asarray(grid / size + float(time[0]))


def settled(recording: Recording, keys: Iterable[str], on_nan: OnNan, file: str) -> Recording:
    """Treat the NaN in some columns as the user asked for.

    Not in the paper, which takes signals as given.

    Args:    keys: the columns. on_nan: "refuse" leaves them, for the evaluation to refuse; "hold" repeats the
             previous value; "drop" leaves out the sample.
    Raises:  DataError D803: no sample is left.
    """
    columns = {key: recording.columns[key] for key in keys if key in recording.columns}
    holes = {key: _holes(values) for key, values in columns.items()}
    holes = {key: hole for key, hole in holes.items() if hole.any()}
    if on_nan == "refuse" or not holes:
        return recording
    if on_nan == "hold":
        held = {key: _held(columns[key], hole) for key, hole in holes.items()}
        return replace(recording, columns={**recording.columns, **held})
    kept = np.flatnonzero(~np.logical_or.reduce(list(holes.values())))
    if not len(kept):
        raise DataError([diagnostic("D803", file=file, where=": every sample has a signal that is NaN")])
    actions = None if recording.actions is None else (None, *recording.actions)
    return replace(
        recording,
        time=None if recording.time is None else recording.time[kept],
        columns={key: _again(values[kept]) for key, values in recording.columns.items()},
        states=None if recording.states is None else tuple(recording.states[k] for k in kept),
        actions=None if actions is None else tuple(actions[k] for k in kept[1:]),
    )


def _holes(values: Array) -> npt.NDArray[np.bool_]:
    if values.dtype.kind == "f":
        return np.isnan(values)
    if values.dtype.kind == "O":
        return np.array([value != value for value in values.tolist()], dtype=np.bool_)
    return np.zeros(len(values), dtype=np.bool_)


def _held(values: Array, hole: npt.NDArray[np.bool_]) -> Array:
    """Repeat the last value before each hole; a hole at the beginning stays, and is refused later."""
    last = np.maximum.accumulate(np.where(hole, 0, np.arange(len(values))))
    return _again(values[last])


def _again(values: Array) -> Array:
    """Convert a column of objects again, which without its holes may be all Booleans."""
    return column_of(values.tolist()) if values.dtype.kind == "O" else values
