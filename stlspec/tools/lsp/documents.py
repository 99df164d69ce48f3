"""The buffers of an editor: their text as it is typed, and what of it is a spec.

In: URIs, texts and changes from the editor. Out: `Document`, its text read under the limits of a file: what would be
refused there is refused here, with the same diagnostic. Nothing is changed in place: a change gives a new document.
"""

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote, unquote_to_bytes, urlsplit
from urllib.request import url2pathname

from stlspec.compiler import files
from stlspec.errors import Diagnostic, InputError, diagnostic
from stlspec.source import SourceText, Span
from stlspec.tools.lsp.positions import Encoding, Lines, Place

_SURROGATES = re.compile("[\ud800-\udfff]+")


@dataclass(frozen=True, slots=True)
class Change:
    """A stretch of a buffer and what stands there now; without a stretch, the whole text."""

    text: str
    start: Place | None = None
    end: Place | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Document:
    """One open buffer.

    name: its path, or its URI if it is no file. source: its text as the compiler reads it, None if it is refused;
    refusal: why. lines: of the text as the editor has it, from which `source` may lack a byte-order mark.
    """

    uri: str
    version: int
    lines: Lines
    name: str = field(init=False)
    source: SourceText | None = field(init=False)
    refusal: Diagnostic | None = field(init=False)

    def __post_init__(self) -> None:
        name = path_of(self.uri) or self.uri
        source, refusal = _read(self.lines.text, name)
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "source", source)
        object.__setattr__(self, "refusal", refusal)

    @classmethod
    def opened(cls, uri: str, version: int, text: str, encoding: Encoding) -> "Document":
        """Return the document of a buffer that an editor opens."""
        return cls(uri, version, Lines(_paired(text), encoding))

    @property
    def is_file(self) -> bool:
        """Whether the buffer is that of a file, so that it has a folder to find others in."""
        return self.name != self.uri

    @property
    def mark(self) -> int:
        """How many characters the editor's text has before the source begins: a byte-order mark or nothing."""
        return int(self.lines.text.startswith("\ufeff"))

    def changed(self, version: int, changes: Iterable[Change]) -> "Document":
        """Return the document after changes, each of the text that the one before it left."""
        lines = self.lines
        for change in changes:
            text = change.text
            if change.start is not None and change.end is not None:
                start, end = (lines.offset(at.line, at.character) for at in (change.start, change.end))
                text = lines.text[:start] + text + lines.text[max(start, end) :]
            lines = Lines(_paired(text), lines.encoding)
        return Document(self.uri, version, lines)

    def offset(self, place: Place) -> int:
        """Return the offset in `source` of a place in the buffer."""
        return max(0, self.lines.offset(place.line, place.character) - self.mark)

    def places(self, span: Span) -> tuple[Place, Place]:
        """Return where a stretch of `source` begins and ends in the buffer."""
        return self.lines.place(span.start + self.mark), self.lines.place(span.end + self.mark)


def _read(text: str, name: str) -> tuple[SourceText | None, Diagnostic | None]:
    """Read a text as a file with these characters would be read."""
    data = _SURROGATES.sub(lambda match: "\ufffd" * len(match[0]), text).encode()
    if len(data) > files.LARGEST_SPEC:
        return None, diagnostic("S093", file=name, size=len(data), limit=files.LARGEST_SPEC)
    try:
        return files.decode(data, name), None
    except InputError as error:
        return None, error.diagnostics[0]


def _paired(text: str) -> str:
    """Join halves of characters that came in two changes; a half that stays alone is kept, one for one."""
    return _SURROGATES.sub(
        lambda m: m[0].encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass"), text
    )


def path_of(uri: str) -> str | None:
    """Return the path that a URI names; None if it names no file, or none that can be."""
    try:
        parts = urlsplit(uri)
    except ValueError:
        return None
    if parts.scheme != "file" or not parts.path:
        return None
    path = os.fsdecode(unquote_to_bytes(parts.path))
    if "\0" in path:
        return None
    host = f"//{parts.netloc}" if parts.netloc and parts.netloc != "localhost" else ""
    return url2pathname(quote(host + path, errors="surrogateescape")) if os.name == "nt" else host + path


def uri_of(path: str) -> str:
    """Return the URI of a file."""
    return Path(os.path.abspath(path)).as_uri()  # noqa: PTH100 - `Path.resolve` would follow links
