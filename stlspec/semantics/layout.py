"""What a caller handed in: one trace, a batch, or traces of unequal length.

In: for each signal a sequence of numbers, a two-dimensional array, or a list of sequences. Out: groups of
traces with common times, each of which is evaluated as one batch. Nothing is checked here that `make_trace`
checks.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stlspec.columns import unmasked
from stlspec.compiler.printing import counted
from stlspec.errors import DataError, UsageError, diagnostic
from stlspec.traces import whole_stamps


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Traces with common times: `numbers` says which; None if there is only one trace, not in a batch."""

    signals: Mapping[str, ArrayLike]
    time: ArrayLike | None
    numbers: Sequence[int] | None


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """The groups of a call's traces; `ragged` if the traces are of unequal length."""

    groups: tuple[Group, ...]
    ragged: bool = False


def own_time(names: Collection[str], signals: Mapping[str, Any], time: Any = None) -> Any:
    """Return the stamps of a call: those under the key 'time' of its data, as in files, else those of their own.

    Not in the paper: it serves the interface.

    Args:   names: the declared signals; a signal that is called 'time' keeps its key.
            signals: the data of a trace or a batch, or one sample. time: the stamps that were given apart.
    Raises: UsageError D880: there are stamps in both places.
    """
    if "time" in names or not isinstance(signals, Mapping):
        return time
    stamps = signals.get("time")
    if stamps is not None and time is not None:
        what = "the time stamps are given twice: as `time=` and under the key 'time'"
        raise UsageError([diagnostic("D880", what=what, help="leave out one of the two")])
    return time if stamps is None else stamps


def arrange(names: Sequence[str], signals: Mapping[str, Any], time: Any = None, file: str | None = None) -> Layout:
    """Sort traces into groups with common length and times.

    Not in the paper: it serves the interface.

    Args:
        names: the declared signals; others are ignored.
        signals: for each name (n_samples,) values, (n_traces, n_samples), or n_traces sequences.
        time: None, (n_samples,) stamps common to all traces, or n_traces sequences of stamps.
        file: where the data come from, for messages.

    Returns: the groups, in the order of their first traces.

    Raises:
        DataError: `signals` is no mapping, or the signals do not have the same number of traces.
    """
    if not isinstance(signals, Mapping):
        problem = f"is a {type(signals).__name__}, not a mapping from names to values"
        raise _shape_error("'signals'", problem, file)
    columns = {name: signals[name] for name in names if name in signals}
    depths = {name: _depth(values) for name, values in columns.items()}
    if max(depths.values(), default=1) < 2 and (time is None or _depth(time) < 2):
        return Layout((Group(signals, time, None),))
    if any(depth < 2 for depth in depths.values()) or not columns:
        raise _shape_error("'time' or a signal", "has one row for each trace, but another has not", file)
    if (time is None or _depth(time) < 2) and not any(_is_uneven(v) for v in columns.values()):
        count = len(next(iter(columns.values())))
        return Layout((Group(columns, time, range(count)),))
    return _by_length_and_time(columns, time, file)


def _shape_error(what: str, problem: str, file: str | None) -> DataError:
    return DataError([diagnostic("D813", file=file, what=what, problem=problem)])


def _depth(values: Any) -> int:
    """Return how many levels of sequences there are, judging by the first element."""
    if isinstance(values, (list, tuple)):
        return 1 + (_depth(values[0]) if values else 0)
    return int(getattr(values, "ndim", 0))


def _is_uneven(values: Any) -> bool:
    if not isinstance(values, (list, tuple)):
        return False
    return len({len(row) if hasattr(row, "__len__") else -1 for row in values}) > 1


def _by_length_and_time(columns: Mapping[str, Any], time: Any, file: str | None) -> Layout:
    other, first = next(iter(columns.items()))
    count = len(first)
    own_times = time is not None and _depth(time) >= 2
    for name, rows in [*columns.items(), *([("time", time)] if own_times else [])]:
        if len(rows) != count:
            raise _shape_error(f"'{name}'", f"has {len(rows)} traces, but '{other}' has {count}", file)
    groups: dict[tuple[Any, ...], list[int]] = {}
    lengths = set()
    for number in range(count):
        length = _row_length(columns, number, file)
        lengths.add(length)
        groups.setdefault((length, _key(time[number], number) if own_times else None), []).append(number)
    return Layout(
        tuple(
            Group(
                {name: [rows[i] for i in numbers] for name, rows in columns.items()},
                time[numbers[0]] if own_times else time,
                tuple(numbers),
            )
            for numbers in groups.values()
        ),
        ragged=len(lengths) > 1,
    )


def _row_length(columns: Mapping[str, Any], number: int, file: str | None) -> int:
    """Return the length of one trace, which is that of each of its signals."""
    expected, other = -1, ""
    for name, rows in columns.items():
        if not hasattr(rows[number], "__len__"):
            raise _shape_error(f"'{name}'", f"has a single value where trace {number} should be", file)
        length = len(rows[number])
        if not other:
            expected, other = length, name
        elif length != expected:
            place = f"trace {number}" if file is None else f"{file}, trace {number}"
            raise DataError(
                [
                    diagnostic(
                        "D805",
                        file=place,
                        signal=name,
                        samples=counted(length, "sample"),
                        other=other,
                        expected=expected,
                    )
                ]
            )
    return expected


def _key(stamps: Any, number: int) -> Any:
    """Return a key that is equal for equal stamps; stamps that are no numbers are refused later."""
    try:
        whole = whole_stamps(stamps)
        return (np.asarray(unmasked(stamps), dtype=np.float64) if whole is None else whole).tobytes()
    except (TypeError, ValueError, OverflowError):
        return number
