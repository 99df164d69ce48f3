"""The file that recordings go to: what it holds already stays as it is, byte for byte.

In: demonstrations as documents. Out: a JSONL or JSON file, whole or not at all. New demonstrations are put behind
what was there; if anything else changes the file in the meantime it is left alone, and says so.
"""

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stlspec.compiler.files import write_bytes
from stlspec.demos import Demonstration, load_demonstrations
from stlspec.errors import DataError, UsageError, diagnostic

Document = Mapping[str, Any]
SUFFIXES = (".jsonl", ".json")


class DemoFile:
    """A file of demonstrations that grows. existing: those that it held when it was opened."""

    def __init__(self, path: Path) -> None:
        """Look at the file, which need not exist.

        Raises: UsageError D886: its name or its folder is of no use; DataError: it holds something else.
        """
        self.path = path
        if path.suffix.lower() not in SUFFIXES:
            raise UsageError([_refusal(path, "recordings are saved as .jsonl or .json", "end its name in .jsonl")])
        folder = Path(os.path.realpath(path)).parent
        if not folder.is_dir():
            raise UsageError([_refusal(path, "its folder does not exist", "make the folder first")])
        if not os.access(folder, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
            raise UsageError([_refusal(path, "there is no permission to write it", "choose another file")])
        if path.exists() and not path.is_file():
            raise UsageError([_refusal(path, "it is no regular file", "choose another file")])
        self._base = path.read_bytes() if path.exists() else b""
        blank = not self._base.strip()
        self.existing: tuple[Demonstration, ...] = () if blank else load_demonstrations([path])
        self._base = b"" if blank else self._base
        self._written = path.read_bytes() if path.exists() else None

    def save(self, documents: Sequence[Document]) -> None:
        """Write what was there, and behind it the documents.

        Raises: DataError D886: something else has changed the file; InputError S092: it cannot be written.
        """
        current = self.path.read_bytes() if self.path.exists() else None
        if current != self._written:
            way = "choose another file for this recording; both are kept"
            raise DataError([_refusal(self.path, "another program has changed it during the recording", way)])
        jsonl = self.path.suffix.lower() == ".jsonl"
        data = appended_lines(self._base, documents) if jsonl else appended_list(self._base, documents)
        write_bytes(self.path, data)
        self._written = data

    def rescue(self, documents: Sequence[Document]) -> Path:
        """Write the documents to a new file for temporary ones, since they cannot go where they should."""
        handle, name = tempfile.mkstemp(prefix="stlspec-recording-", suffix=".jsonl")
        with os.fdopen(handle, "wb") as file:
            file.write(appended_lines(b"", documents))
        return Path(name)


def appended_lines(base: bytes, documents: Sequence[Document]) -> bytes:
    """Put documents behind the lines of a JSONL file. Not in the paper: a file format."""
    between = b"\n" if base and not base.endswith(b"\n") else b""
    return base + between + b"".join(_bytes(d) + b"\n" for d in documents)


def appended_list(base: bytes, documents: Sequence[Document]) -> bytes:
    """Put documents behind those of a JSON file, which holds one object or a list, without touching what is there.

    Not in the paper: a file format.
    """
    # A byte-order mark may only stand at the very beginning, where it may also be left out.
    old = base.removeprefix(b"\xef\xbb\xbf").strip()
    inside = old[1:-1].strip() if old.startswith(b"[") else old
    parts = [inside] if inside else []
    return b"[\n" + b",\n".join([*parts, *(_bytes(d) for d in documents)]) + b"\n]\n"


def _bytes(document: Document) -> bytes:
    return json.dumps(document, ensure_ascii=False, allow_nan=False).encode()


def _refusal(path: Path, problem: str, way: str) -> Any:
    return diagnostic("D886", file=str(path), problem=problem, help=way)
