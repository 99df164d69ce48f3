"""What every reader gives back, and the checks that all formats share.

In: the columns, states and actions that a reader took from a file. Out: `Recording`, one for each episode,
whose parts all have one value a sample. Lengths are checked here, once, so that a reader only knows its
format; what the values mean is checked later, against the signals of a spec, since a column that no spec uses
does no harm.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from stlspec.compiler.printing import counted
from stlspec.errors import DataError, Diagnostic, diagnostic

BYTES_AT_MOST = 2**28
"""The size of the largest text file that is read; as Python objects it takes some ten times as much."""

Array: TypeAlias = npt.NDArray[Any]


@dataclass(frozen=True, eq=False)
class Recording:
    """One episode as a file has it.

    name: its own name, if it has one. time: (n_samples,), as written, without a unit; int64 where stamps are
    written as whole numbers, else float64.
    columns: for each name an array (n_samples,), float64 or bool; object where the values are neither.
    states: one a sample, as written. actions: one a sample but the first; actions[k] leads to sample k + 1.
    env: the environment it was made in, as described in the file. episode: what tells it from the other
    recordings of the file; None when it is the only one. time_unit: of the stamps, where the file itself tells
    it ("ns", "us", "ms", "s"); they are whole then. others: columns of the file that nobody asked for.
    """

    name: str | None = None
    time: Array | None = None
    columns: Mapping[str, Array] = field(default_factory=dict)
    states: tuple[Any, ...] | None = None
    actions: tuple[Any, ...] | None = None
    env: Mapping[str, Any] | None = None
    episode: str | None = None
    time_unit: str | None = None
    others: tuple[str, ...] = ()

    @property
    def n_samples(self) -> int:
        """The number of samples, that is the length of every column."""
        for part in (self.time, self.states, *self.columns.values()):
            if part is not None:
                return len(part)
        return 0


def refusal(code: str, file: Path, **fields: Any) -> DataError:
    """Make the error that refuses a file with one diagnostic.

    Not in the paper: error handling.

    Args: fields: what the templates of the code ask for.
    """
    return DataError([diagnostic(code, file=str(file), **fields)])


def repeated(names: Sequence[str]) -> str | None:
    """Return the first name that comes more than once.

    Not in the paper: error handling.
    """
    return next((name for name, times in Counter(names).items() if times > 1), None)


def required_file(file: Path, expected: str, at_most: int | None = None) -> None:
    """Refuse what is no regular file with something in it.

    Not in the paper: file access.

    Args:   expected: what the file should hold, for the message when it is empty. at_most: bytes.
    Raises: DataError D830: it is missing, no regular file or unreadable; D833: it is empty; D838: it is too
        large.
    """
    try:
        if not file.is_file():
            here = file.exists()
            reason, way = "there is no such file", "check the path"
            if file.is_dir():
                reason, way = "it is a directory", "name the files inside it"
            elif here:
                reason, way = "it is no regular file", "CSV from a pipe is scored by `stlspec score SPEC - < PIPE`"
            raise refusal("D830", file, reason=reason, help=way)
        size = file.stat().st_size
    except (OSError, ValueError) as error:
        raise _unreadable(file, error) from None
    if at_most is not None and size > at_most:
        raise refusal("D838", file, size=f"{size:,}", limit=f"{at_most:,}")
    if size == 0 and at_most is None:
        raise refusal("D833", file, expected=expected)


def _unreadable(file: Path, error: OSError | ValueError) -> DataError:
    # pathlib raises ValueError for a name with a NUL in it.
    reason = getattr(error, "strerror", None) or str(error)
    return refusal("D830", file, reason=reason, help="check the path")


def read_bytes(file: Path, expected: str, at_most: int = BYTES_AT_MOST) -> bytes:
    """Read a whole file, its size bounded.

    Not in the paper: file access.

    Args:   expected: what the file should hold, for the message when it is empty.
    Raises: DataError D830: it is missing, no regular file or unreadable; D833: it is empty; D838: it is too
        large.
    """
    required_file(file, expected, at_most)
    try:
        data = file.read_bytes()
    except OSError as error:
        raise _unreadable(file, error) from None
    if not data:
        raise refusal("D833", file, expected=expected)
    return data


def read_text(file: Path, expected: str) -> str:
    """Read a UTF-8 text file, without its byte-order mark.

    Not in the paper: file access.

    Raises: DataError D832: it is no UTF-8 text; otherwise as `read_bytes`.
    """
    data = read_bytes(file, expected)
    at = data.find(b"\0")
    if at < 0:
        try:
            return data.decode("utf-8").removeprefix("\ufeff")
        except UnicodeDecodeError as error:
            at = error.start
    line = f" (line {data.count(10, 0, at) + 1})"
    raise refusal("D832", file, offset=at, line=line, byte=f"0x{data[at]:02x}")


def number_of_word(word: str) -> float | bool | str:
    """Read one value that was written as text: true, false, a number, inf, nan; empty is NaN, else the text.

    Not in the paper: file formats.
    """
    bare = word.strip()
    if bare.lower() in ("true", "false"):
        return bare.lower() == "true"
    if not bare:
        return math.nan
    try:
        return float(bare) if "_" not in bare else word
    except ValueError:
        return word


def column_of(values: Sequence[Any]) -> Array:
    """Turn values, each a number, a Boolean or something else, into a column.

    Not in the paper: file formats.

    Returns: (n_samples,) float64 if all are numbers, bool if all are Booleans, else object.
    """
    kinds = set(map(type, values))
    if kinds <= {int, float}:
        try:
            return np.array(values, dtype=np.float64)
        except OverflowError:
            values = [_finite_or_infinite(value) for value in values]
            return np.array(values, dtype=np.float64)
    if kinds == {bool}:
        return np.array(values, dtype=np.bool_)
    column = np.empty(len(values), dtype=object)
    column[:] = values
    return column


def time_of(values: Sequence[Any]) -> Array:
    """Turn time stamps into a column that keeps whole numbers whole; otherwise as `column_of`.

    Not in the paper: exactness of time.
    """
    if set(map(type, values)) == {int} and max(map(abs, values)) < 2**63:
        return np.array(values, dtype=np.int64)
    return column_of(values)


def _finite_or_infinite(value: float) -> float:
    try:
        return float(value)
    except OverflowError:
        # A whole number beyond 1e308: the same rule as for the text "1e999", which reads as inf.
        return math.inf if value > 0 else -math.inf


def checked(recording: Recording, file: Path) -> Recording:
    """Return the recording if all its parts fit together.

    Not in the paper: error handling.

    Raises: DataError D803: no samples; D805: parts of unequal length; D839: not one action for each step.
    """
    parts: dict[str, Any] = {"time": recording.time, **recording.columns, "states": recording.states}
    lengths = {name: len(part) for name, part in parts.items() if part is not None}
    where = f" in episode {recording.episode}" if recording.episode is not None else ""
    first = next(iter(lengths), None)
    if first is None or not any(lengths.values()):
        raise refusal("D803", file, where=where)
    problems: list[Diagnostic] = [
        diagnostic(
            "D805", file=str(file), signal=name, samples=counted(n, "sample"), other=first, expected=lengths[first]
        )
        for name, n in lengths.items()
        if n != lengths[first]
    ]
    if not problems and recording.actions is not None and len(recording.actions) != lengths[first] - 1:
        problems.append(
            diagnostic("D839", file=str(file), length=len(recording.actions), samples=f"{lengths[first]} samples")
        )
    if problems:
        raise DataError(problems)
    return recording


def episode_rows(labels: Sequence[Any]) -> list[tuple[str, npt.NDArray[np.int64]]]:
    """Group the rows of a file by their episode, in the order in which episodes begin.

    Not in the paper: file formats.

    Returns: for each episode its label and the indices of its rows.
    """
    rows: dict[str, list[int]] = {}
    for index, label in enumerate(labels):
        rows.setdefault(str(label).strip(), []).append(index)
    return [(label, np.array(found, dtype=np.int64)) for label, found in rows.items()]


def plain(value: Any) -> Any:
    """Return an array or a NumPy number as plain Python values.

    Not in the paper: an interface.
    """
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
