"""CSV: a header with the names of signals, one row a sample.

In: a file; the columns `time`, `episode` and `action` have their own meaning, every other one is a signal.
Out: one `Recording` an episode. Columns are converted whole, and word by word only where a column is not all
numbers, so that a large file costs little more than splitting it.
"""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from stlspec.readers.model import (
    Array,
    Recording,
    checked,
    column_of,
    episode_rows,
    number_of_word,
    read_text,
    refusal,
    repeated,
)

FLOATS_TELL_APART = 2.0**53
"""Whole numbers below this are the same as floats."""
_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}
"""A header of one column that holds one of these was meant as several: a semicolon, or a tab, as spreadsheets write."""
_EXPECTED = "a header with the names of the columns, then one row a sample"


def read(path: Path) -> list[Recording]:
    """Read a CSV file.

    Not in the paper: a file format.

    Raises: DataError D803, D805, D830, D832 to D836, D838, D840: the file cannot be used.
    """
    stream = io.StringIO(read_text(path, _EXPECTED), newline="")
    reader = csv.reader(stream, strict=True)
    try:
        header = next((header_of(row, path) for row in reader if row), None)
        if header is None:
            raise refusal("D833", path, expected=_EXPECTED)
        columns = _numbers(stream, header)
        if columns is not None:
            return [checked(Recording(time=columns.pop("time", None), columns=columns), path)]
        rows = _rows(reader, header, path)
    except csv.Error as error:
        where = f" (line {reader.line_num})"
        hint = "put values that hold a comma or a quote in double quotes, and close them"
        raise refusal("D836", path, format="CSV", reason=str(error), where=where, help=hint) from None
    if not rows:
        raise refusal("D803", path, where=": the file has a header and nothing else")
    return _recordings(dict(zip(header, zip(*rows, strict=True), strict=True)), path)


def _numbers(stream: io.StringIO, header: Sequence[str]) -> dict[str, Array] | None:
    """Convert all rows at once, which is thrice as fast; None, and the stream where it was, if that fails."""
    begin = stream.tell()
    if not {"episode", "action"} & set(header) and stream.read(1).strip():
        stream.seek(begin)
        try:
            table = np.loadtxt(stream, delimiter=",", comments=None, ndmin=2, dtype=np.float64)
        except ValueError:
            # Words, holes, quotes or ragged rows: the slow path reads them, or says what is wrong.
            table = np.empty((0, 0))
        if table.shape[1] == len(header):
            columns = dict(zip(header, np.ascontiguousarray(table.T), strict=True))
            if "time" in columns and np.abs(columns["time"]).max() >= FLOATS_TELL_APART:
                stream.seek(begin)
                columns["time"] = whole_column(stream, header.index("time"), columns["time"])
            return columns
    stream.seek(begin)
    return None


def whole_column(stream: io.StringIO, at: int, floats: Array) -> Array:
    """Read one column again as whole numbers; it stays as it is if it holds anything else.

    Not in the paper: exactness of time.
    """
    try:
        return np.loadtxt(
            stream,
            delimiter=",",
            comments=None,
            usecols=at,
            ndmin=1,
            dtype=np.int64,
            converters={at: int},
            encoding=None,
        )
    except (ValueError, OverflowError):
        return floats


def _rows(reader: Any, header: Sequence[str], path: Path) -> list[list[str]]:
    """Split the text; every row comes out as long as the header."""
    rows: list[list[str]] = []
    for row in reader:
        if len(row) == len(header):
            rows.append(row)
        elif row:
            ragged(row, header, reader.line_num, path)
    return rows


def _recordings(words: dict[str, tuple[str, ...]], path: Path) -> list[Recording]:
    labels = words.pop("episode", None)
    actions = words.pop("action", None)
    stamps = words.pop("time", None)
    time = None if stamps is None else stamps_of(stamps)
    columns = {name: column_of_words(column) for name, column in words.items()}
    groups = [(None, slice(None))] if labels is None else _groups(labels)
    return [
        checked(
            Recording(
                time=None if time is None else time[at],
                columns={name: column[at] for name, column in columns.items()},
                actions=None if actions is None else _actions(actions, at, path),
                episode=label,
            ),
            path,
        )
        for label, at in groups
    ]


def header_of(row: Sequence[str], path: Path) -> list[str]:
    """Return the names of the columns. Not in the paper: a file format. Raises: DataError D835: it is no header."""
    names = [name.strip() for name in row]
    if "" in names:
        hint = "name every column; with pandas, write to_csv(..., index=False)"
        raise refusal("D835", path, reason=f"column {names.index('') + 1} of the header has no name", help=hint)
    if all(isinstance(number_of_word(name), float) for name in names):
        hint = "the first row names the columns, such as time,x,y"
        raise refusal("D835", path, reason="the first row holds numbers, not names of columns", help=hint)
    for separator, called in _OTHER_SEPARATORS.items():
        if len(names) == 1 and separator in names[0]:
            hint = "write the file again with commas between columns, and a point in decimal numbers"
            raise refusal("D835", path, reason=f"the columns of the header are separated by {called}", help=hint)
    twice = repeated(names)
    if twice is not None:
        reason = f"the header has the column '{twice[:60]}' twice"
        raise refusal("D835", path, reason=reason, help="give each column a name of its own")
    return names


def ragged(row: Sequence[str], header: Sequence[str], line: int, path: Path) -> NoReturn:
    """Refuse a row that is not as long as the header. Not in the paper: a file format. Raises: DataError D834."""
    hint = "give the row one value for every column"
    found = f"{len(row)} column{'s' if len(row) != 1 else ''}"
    raise refusal("D834", path, line=line, found=found, expected=len(header), help=hint)


def column_of_words(words: Sequence[str]) -> Array:
    """Convert a column of text, whole if it is all numbers. Not in the paper: a file format."""
    try:
        column = np.array(words, dtype=np.float64)
    except ValueError:
        return column_of([number_of_word(word) for word in words])
    # Python reads 1_0 as ten, and so does NumPy; no spreadsheet does.
    return column if not any("_" in word for word in words) else column_of(list(map(number_of_word, words)))


def stamps_of(words: Sequence[str]) -> Array:
    """Convert time stamps, to whole numbers if all are written as such. Not in the paper: exactness of time."""
    if not any("_" in word for word in words):
        try:
            return np.array([int(word) for word in words], dtype=np.int64)
        except (ValueError, OverflowError):
            pass
    return column_of_words(words)


def _groups(labels: Sequence[str]) -> list[tuple[str | None, Any]]:
    groups = episode_rows(labels)
    return [(label if len(groups) > 1 else None, at) for label, at in groups]


def _actions(words: Sequence[str], at: Any, path: Path) -> tuple[Any, ...]:
    """Take the actions of one episode: none in its first row, one in every other."""
    own = [word.strip() for word in np.array(words, dtype=object)[at]]
    if own[0]:
        raise refusal("D840", path, reason=f"the first row of an episode has the action '{own[0][:40]}'")
    if "" in own[1:]:
        sample = own.index("", 1)
        raise refusal("D840", path, reason=f"sample {sample} of an episode has no action")
    return tuple(_action(word) for word in own[1:])


def _action(word: str) -> int | float | bool | str:
    value = number_of_word(word)
    if isinstance(value, float) and value.is_integer():
        return int(value)
    return value
