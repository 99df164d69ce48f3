"""CSV that comes through a pipe, some megabytes at a time.

In: a binary stream. Out: the columns that are wanted, block after block. The rules are those of `readers.csv`: a
header, one row a sample; `time` and `episode` mean the same. Neither a line nor a block is longer than a bound, so
that memory does not grow with the input. A block whose wanted columns hold nothing but numbers is converted whole.
"""

import csv
import io
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from stlspec.errors import DataError
from stlspec.readers.csv import FLOATS_TELL_APART, column_of_words, header_of, ragged, stamps_of, whole_column
from stlspec.readers.model import Array, refusal

BLOCK_BYTES = 2**22
LINE_AT_MOST = 2**20
_EXPECTED = "a header with the names of the columns, then one row a sample"


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Some samples in a row. time: as in `Recording`. columns: those that are wanted, (n_samples,) each."""

    time: Array | None
    columns: Mapping[str, Array]
    n_samples: int


class CsvStream:
    """Reads a header at once and rows when they are asked for; names: of all columns."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        """Read the header. Raises: DataError D832, D833, D835, D836: there is none."""
        self._stream, self._file = stream, Path(name)
        self._line = 0
        self._rest = b""
        self._episode: str | None = None
        self.names = self._header()

    def _header(self) -> list[str]:
        """Read up to the first line that is not blank."""
        for data in self._lines():
            start = data.lstrip(b"\xef\xbb\xbf \t\r\n")
            if not start:
                self._line += data.count(b"\n")
                continue
            if start[:1] in b"{[":
                hint = "put JSON into a file that ends in .json or .jsonl"
                raise refusal("D836", self._file, format="CSV", reason="it begins like JSON", where="", help=hint)
            self._line += data[: len(data) - len(start)].count(b"\n") + 1
            line, _, rest = start.partition(b"\n")
            # What follows the header goes back before what has not been read yet.
            self._rest = rest + self._rest
            return self._named(self._decoded(line, self._line))
        raise refusal("D833", self._file, expected=_EXPECTED)

    def _named(self, line: str) -> list[str]:
        try:
            return header_of(next(csv.reader([line], strict=True)), self._file)
        except csv.Error as error:
            raise self._broken(str(error), self._line) from None

    def blocks(self, wanted: Collection[str]) -> Iterator[Block]:
        """Give the samples, block after block.

        Not in the paper: a file format.

        Args:   wanted: names of columns, each of which is there.
        Raises: DataError D832, D834, D836, D898: rows that cannot be used; the line is named.
        """
        used = [n for n in self.names if n in wanted or n in ("time", "episode")]
        # With no column at all some column still tells the number of samples.
        used = used if set(used) - {"episode"} else [*used, *[n for n in self.names if n != "episode"][:1]]
        at = [self.names.index(n) for n in used]
        for data in self._lines():
            columns = self._numbers(data, used, at) or self._words(data, used, at)
            self._line += data.count(b"\n") + (not data.endswith(b"\n"))
            if columns:
                n_samples = len(next(iter(columns.values())))
                yield Block(columns.pop("time", None), columns, n_samples)

    def _lines(self) -> Iterator[bytes]:
        """Cut the input after ends of lines, into blocks of bounded size."""
        while True:
            data = self._stream.read(BLOCK_BYTES)
            held = self._rest + data
            end = held.rfind(b"\n") + 1 if data else len(held)
            self._rest = held[end:]
            if len(self._rest) > LINE_AT_MOST:
                line = self._line + held.count(b"\n") + 1
                hint = "is it a table? a row ends with the line"
                raise self._broken(f"the line is longer than {LINE_AT_MOST:,} bytes", line, hint)
            if end:
                yield held[:end]
            if not data:
                return

    def _numbers(self, data: bytes, used: Sequence[str], at: Sequence[int]) -> dict[str, Array] | None:
        """Convert the wanted columns of a block at once; None if it holds anything but rows of numbers."""
        if "episode" in used or data.isspace() or not self._is_table(data):
            return None
        try:
            table = np.loadtxt(io.BytesIO(data), delimiter=",", comments=None, ndmin=2, usecols=at, encoding="latin1")
        except ValueError:
            return None
        columns = dict(zip(used, np.ascontiguousarray(table.T), strict=True))
        if "time" in columns and np.abs(columns["time"]).max() >= FLOATS_TELL_APART:
            text = io.StringIO(data.decode("latin1"))
            columns["time"] = whole_column(text, self.names.index("time"), columns["time"])
        return columns

    def _is_table(self, data: bytes) -> bool:
        """Say whether every line has as many columns as the header, and no quotes: columns may then be skipped."""
        raw = np.frombuffer(data, dtype=np.uint8)
        ends = np.flatnonzero(raw == ord("\n"))
        if not data.endswith(b"\n"):
            ends = np.append(ends, len(raw))
        before = np.searchsorted(np.flatnonzero(raw == ord(",")), ends)
        return (
            bool((np.diff(before, prepend=0) == len(self.names) - 1).all())
            and (len(self.names) > 1 or bool((np.diff(ends, prepend=-1) > 1).all()))
            and data.isascii()
            and b'"' not in data
            and b"\0" not in data
        )

    def _words(self, data: bytes, used: Sequence[str], at: Sequence[int]) -> dict[str, Array] | None:
        """Convert a block word by word; None if all its lines are blank."""
        reader = csv.reader(io.StringIO(self._decoded(data, self._line + 1), newline=""), strict=True)
        rows: list[list[str]] = []
        try:
            for row in reader:
                if len(row) == len(self.names):
                    rows.append([row[i] for i in at])
                elif row:
                    ragged(row, self.names, self._line + reader.line_num, self._file)
        except csv.Error as error:
            raise self._broken(str(error), self._line + reader.line_num) from None
        if not rows:
            return None
        words = dict(zip(used, zip(*rows, strict=True), strict=True))
        labels = words.pop("episode", ())
        self._check_episode(labels)
        return {n: (stamps_of if n == "time" else column_of_words)(column) for n, column in words.items()}

    def _check_episode(self, labels: Sequence[str]) -> None:
        for label in dict.fromkeys(labels):
            label = label.strip()
            if self._episode is None:
                self._episode = label
            if label != self._episode:
                raise refusal("D898", self._file, first=self._episode[:40], other=label[:40])

    def _decoded(self, data: bytes, line: int) -> str:
        at = data.find(b"\0")
        if at < 0:
            try:
                return data.decode("utf-8")
            except UnicodeDecodeError as error:
                at = error.start
        where = f" (of line {line + data.count(10, 0, at)} on)"
        raise refusal("D832", self._file, offset=at, line=where, byte=f"0x{data[at]:02x}")

    def _broken(self, reason: str, line: int, hint: str = "") -> DataError:
        hint = hint or "put values that hold a comma or a quote in double quotes, and close them on the same line"
        return refusal("D836", self._file, format="CSV", reason=reason, where=f" (line {line})", help=hint)
