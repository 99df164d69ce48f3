"""Readers by the end of a file's name.

In: a path. Out: the recordings of the file. The built-in formats are known without package metadata; other
packages add theirs through the entry point group `stlspec.readers`, under the name of the suffix: a callable
that takes a `Path` and returns a list of `Recording`. One that also takes `columns` is told which signals are
wanted and need not read others. A built-in cannot be replaced, so that installing a package never changes what an
existing file means.
"""

import difflib
import inspect
from collections.abc import Callable, Collection
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, TypeAlias

from stlspec.readers import csv, json, jsonl, minari, npz, parquet
from stlspec.readers.model import Recording, refusal

Reader: TypeAlias = Callable[..., list[Recording]]

GROUP = "stlspec.readers"
BUILT_IN: dict[str, Reader] = {
    "csv": csv.read,
    "json": json.read,
    "jsonl": jsonl.read,
    "npz": npz.read,
    "parquet": parquet.read,
}


def read_recordings(path: Path, columns: Collection[str] | None = None) -> list[Recording]:
    """Read all recordings of a file, by the reader that its suffix names.

    Not in the paper: file formats.

    Args:    path: of a file, or `minari:ID`. columns: the signals that are wanted; formats in which columns lie
             apart then leave out the others. None = all.
    Returns: at least one recording; a reader has at least one sample in each.
    Raises: DataError D831: no reader knows the suffix; D842: the reader cannot be loaded; others by the
        reader.
    """
    reader = minari.read if str(path).startswith(minari.SCHEME) else _reader(path)
    options: dict[str, Any] = {}
    if columns is not None and "columns" in inspect.signature(reader).parameters:
        options["columns"] = columns
    return reader(path, **options)


def _reader(path: Path) -> Reader:
    suffix = path.suffix.removeprefix(".").lower()
    if suffix in BUILT_IN:
        return BUILT_IN[suffix]
    added = {point.name.lower(): point for point in entry_points(group=GROUP)}
    if suffix in added:
        try:
            reader: Reader = added[suffix].load()
        except (ImportError, AttributeError) as error:
            reason = str(error).splitlines()[0][:200]
            raise refusal("D842", path, name=suffix, group=GROUP, reason=reason) from None
        return reader
    if not path.exists():
        raise refusal("D830", path, reason="there is no such file", help="check the path")
    if path.is_dir():
        raise refusal("D830", path, reason="it is a directory", help="name the files inside it")
    known = sorted({*BUILT_IN, *added})
    close = difflib.get_close_matches(suffix, known, 1)
    hint = f"did you mean .{close[0]}? " if close else ""
    raise refusal("D831", path, suffix=path.suffix, help=hint + "known are " + ", ".join(f".{x}" for x in known))
