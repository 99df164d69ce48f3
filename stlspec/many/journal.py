"""Rows written as they come, and where to go on after an interruption.

In: the lines of one file after the other. Out: the result file, which appears whole or not at all. Until then the
lines lie in `OUT.partial`, and `OUT.resume` says how many files, and how many bytes of the lines, are settled; what
lies beyond was cut off by an interruption and is dropped. Both depend on nothing but the order of the files, so a run
that was killed ends in the same bytes as one that was not. Parquet, which cannot be appended to, is made of the lines
at the end, some thousand rows at a time. A run that settled nothing leaves nothing behind.
"""

import json
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from stlspec.compiler.files import write_bytes
from stlspec.errors import InputError, UsageError, diagnostic

SCHEMA = "stlspec.scores/1"
SUFFIXES = (".jsonl", ".parquet")
_TEXTS = ("file", "name", "label")
_ROWS_AT_A_TIME = 8192
_FILES_BETWEEN_MARKS = 64


class Journal:
    """Takes the lines of one file after the other; changes its two files."""

    def __init__(self, out: Path, identity: Callable[[int], str]) -> None:
        """Go on where an interrupted run of the same work stopped, or begin.

        Args:   out: the result file, .jsonl or .parquet. identity: tells the work on the first so many files from any
                other; what comes after them does not count, so that a file which stopped a run can be taken out.
        Raises: UsageError D847: Parquet is wanted and its extra missing; D849: what lies there is of another work;
                D880: the suffix says neither format. InputError S092: it cannot be written.
        """
        if out.suffix not in SUFFIXES:
            what = f"`--out {out.name}` says no format"
            raise UsageError([diagnostic("D880", what=what, help="end it in .jsonl or .parquet")])
        if out.suffix == ".parquet":
            _pyarrow()  # before hours of work, not after them
        self.out, self.identity = out, identity
        self.partial = out.with_name(out.name + ".partial")
        self.mark = out.with_name(out.name + ".resume")
        self.files, self.counts = 0, [0, 0]
        size = self._resume()
        try:
            self.partial.parent.mkdir(parents=True, exist_ok=True)
            self.partial.touch()
            self._file: BinaryIO = self.partial.open("r+b")
            self._file.truncate(size)
            self._file.seek(size)
        except OSError as error:
            raise _unwritable(self.partial, error) from None
        self._marked = self.files

    def __enter__(self) -> "Journal":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Settle what has come, for an interrupted run to go on there."""
        if self._file.closed:
            return
        if self.files:
            self._settle()
        self._file.close()
        if not self.files:
            self.partial.unlink(missing_ok=True)
            self.mark.unlink(missing_ok=True)

    def add(self, lines: Sequence[str], failed: bool) -> None:
        """Take the lines of the next file. Raises: InputError S092: they cannot be written."""
        try:
            self._file.writelines(line.encode() + b"\n" for line in lines)
        except OSError as error:
            raise _unwritable(self.partial, error) from None
        self.files += 1
        self.counts[0] += len(lines)
        self.counts[1] += failed
        if self.files - self._marked >= _FILES_BETWEEN_MARKS:
            self._settle()

    def finish(self) -> None:
        """Let the result appear. Raises: InputError S092: it cannot be written."""
        self._settle()
        self._file.close()
        if self.out.suffix == ".jsonl":
            self.partial.replace(self.out)
        else:
            whole = self.out.with_name(self.out.name + ".whole")
            write_parquet(_documents(self.partial), whole)
            whole.replace(self.out)
            self.partial.unlink()
        self.mark.unlink(missing_ok=True)

    def _settle(self) -> None:
        try:
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise _unwritable(self.partial, error) from None
        document = {"schema": SCHEMA, "identity": self.identity(self.files), "files": self.files, "counts": self.counts}
        write_bytes(self.mark, (json.dumps({**document, "bytes": self._file.tell()}) + "\n").encode())
        self._marked = self.files

    def _resume(self) -> int:
        """Read the mark of an interrupted run; return the number of bytes that are settled."""
        try:
            document = json.loads(self.mark.read_text(encoding="utf-8"))
            sizes = [document["files"], document["bytes"], *document["counts"]]
            right = document["schema"] == SCHEMA and all(type(n) is int and n >= 0 for n in sizes) and len(sizes) == 4
            right = (
                right and document["identity"] == self.identity(sizes[0]) and self.partial.stat().st_size >= sizes[1]
            )
        except FileNotFoundError:
            return 0
        except (OSError, ValueError, KeyError, TypeError):
            right = False
        if not right:
            raise UsageError([diagnostic("D849", file=str(self.mark), out=str(self.out), partial=str(self.partial))])
        self.files, self.counts = sizes[0], sizes[2:]
        return int(sizes[1])


def _unwritable(path: Path, error: OSError) -> InputError:
    problem = (error.strerror or str(error)).lower()
    return InputError([diagnostic("S092", file=str(path), verb="write", problem=problem, help="check the path")])


def _documents(path: Path) -> Iterator[dict[str, Any]]:
    with path.open("rb") as file:
        for line in file:
            yield json.loads(line)


def write_parquet(documents: Iterable[dict[str, Any]], path: Path) -> None:
    """Write rows of scores as Parquet, one row a demonstration, some thousand at a time.

    Not in the paper: a file format.

    Args:   documents: as the lines of the journal. The columns are name, file, label, reward, and for each requirement
            NAME.robustness, NAME.verdict, NAME.vacuous, NAME.witness_sample and NAME.witness_time.
    Raises: UsageError D847: the extra is missing.
    """
    pa, pq = _pyarrow()
    writer: Any = None
    rows: list[dict[str, Any]] = []

    def flush() -> None:
        nonlocal writer
        if rows:
            table = pa.Table.from_pylist(rows, schema=_schema(pa, rows[0]))
            writer = writer or pq.ParquetWriter(path, table.schema)
            writer.write_table(table)
            rows.clear()

    for document in documents:
        rows.append(_flat(document))
        if len(rows) == _ROWS_AT_A_TIME:
            flush()
    flush()
    if writer is None:  # no file could be scored: a table of no rows, whose requirements nobody has named
        writer = pq.ParquetWriter(path, pa.schema([(key, pa.string()) for key in _TEXTS]))
    writer.close()


def _pyarrow() -> tuple[Any, Any]:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise UsageError([diagnostic("D847", what="writing Parquet", extra="parquet")]) from None
    return pa, pq


def _flat(document: dict[str, Any]) -> dict[str, Any]:
    row = {key: value for key, value in document.items() if key != "requirements"}
    for name, score in document["requirements"].items():
        witness = score["witness"] or {"sample": None, "time": None}
        row |= {f"{name}.{key}": score[key] for key in ("verdict", "vacuous")}
        row |= {f"{name}.{key}": float(score[key]) for key in ("robustness", "low", "high") if key in score}
        row |= {f"{name}.witness_sample": witness["sample"], f"{name}.witness_time": witness["time"]}
    return row


def _schema(pa: Any, row: dict[str, Any]) -> Any:
    kinds = {"verdict": pa.string(), "vacuous": pa.bool_(), "witness_sample": pa.int64()}
    return pa.schema(
        [(key, pa.string() if key in _TEXTS else kinds.get(key.rpartition(".")[2], pa.float64())) for key in row]
    )
