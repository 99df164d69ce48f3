"""What is open in an editor, reviewed: each buffer with the files that it uses, open ones as they stand there.

In: buffers that open, change and close. Out: for each its syntax, its model and what `check` would report, worked out
when first asked for and kept until one of the files that it rests on changes; and what is to be shown in which file.
"""

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

from stlspec.compiler import files
from stlspec.compiler.model import Model
from stlspec.compiler.review import review_syntax
from stlspec.compiler.selection import Selection, configured
from stlspec.errors import Diagnostic, InputError
from stlspec.lang.incremental import Incremental
from stlspec.lang.parse import Syntax
from stlspec.lang.using import identity, parse_with_uses
from stlspec.source import SourceText, Span
from stlspec.tools.lsp.documents import Change, Document, uri_of
from stlspec.tools.lsp.folders import specs_under
from stlspec.tools.lsp.positions import DEFAULT, Encoding, Lines, Place


@dataclass(frozen=True, slots=True)
class Location:
    """A stretch of a file, as the editor names files and counts places."""

    uri: str
    start: Place
    end: Place


@dataclass(frozen=True, eq=False)
class Reviewed:
    """All that is known of one buffer; what the checks say of it is worked out when it is first asked for.

    syntax: None if its text is refused. rests_on: the identity of every file that was asked for.
    """

    document: Document
    syntax: Syntax | None = None
    rests_on: frozenset[str] = frozenset()

    @cached_property
    def _judged(self) -> tuple[tuple[Diagnostic, ...], Model | None]:
        if self.syntax is None:
            return ((self.document.refusal,) if self.document.refusal else ()), None
        selection, problems = _settings(self.document)
        review = review_syntax(self.syntax, None, selection)
        return (*problems, *review.diagnostics), review.result.model

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """What `check` reports."""
        return self._judged[0]

    @property
    def model(self) -> Model | None:
        """What is declared, with types, units and values; None if the text is refused."""
        return self._judged[1]

    @property
    def errors(self) -> bool:
        """Whether something keeps the spec from being compiled."""
        return any(found.severity == "error" for found in self.diagnostics)


class _Parsers:
    """A parser for each file, which remembers what it has read."""

    def __init__(self) -> None:
        self._known: dict[str, Incremental] = {}

    def __call__(self, source: SourceText, names: frozenset[str]) -> Syntax:
        return self._known.setdefault(source.name, Incremental()).parse(source, names)

    def keep(self, names: set[str]) -> None:
        """Forget all files but these."""
        self._known = {name: parser for name, parser in self._known.items() if name in names}


class Workspace:
    """The open buffers, by URI."""

    def __init__(self, encoding: Encoding = DEFAULT) -> None:
        self.encoding = encoding
        self._parse = _Parsers()
        self._documents: dict[str, Document] = {}
        self._reviewed: dict[str, Reviewed] = {}
        self._lines: dict[str, Lines] = {}
        self.folders: tuple[str, ...] = ()
        """Where the editor works: specs there count, too, where a name is sought."""

    @property
    def documents(self) -> tuple[Document, ...]:
        """The open buffers, in the order in which they were opened."""
        return tuple(self._documents.values())

    def open(self, uri: str, version: int, text: str) -> None:
        """Take in a buffer that an editor opens."""
        self._put(Document.opened(uri, version, text, self.encoding))

    def change(self, uri: str, version: int, changes: Iterable[Change]) -> None:
        """Change a buffer; one that was never opened is not known and stays so."""
        if uri in self._documents:
            self._put(self._documents[uri].changed(version, changes))

    def close(self, uri: str) -> None:
        """Forget a buffer: what the others use is the file on disk again."""
        document = self._documents.pop(uri, None)
        if document is not None:
            read = [self._reviewed[uri].syntax for uri in self._documents.keys() & self._reviewed.keys()]
            used = {file.source.name for syntax in read if syntax is not None for file in syntax.used}
            self._parse.keep(used | {other.name for other in self._documents.values()})
            self._forget(document)

    def refresh(self) -> None:
        """Forget all reviews: files on disk have changed, specs or settings."""
        self._reviewed.clear()
        self._lines.clear()

    def _put(self, document: Document) -> None:
        self._documents[document.uri] = document
        self._forget(document)

    def _forget(self, document: Document) -> None:
        """Forget the reviews that rest on a buffer."""
        self._reviewed.pop(document.uri, None)
        self._lines.clear()
        if document.is_file:
            key = identity(document.name)
            for uri in [uri for uri, known in self._reviewed.items() if key in known.rests_on]:
                del self._reviewed[uri]

    def reviewed(self, uri: str) -> Reviewed | None:
        """Return what is known of a buffer; None if it is not open."""
        document = self._documents.get(uri)
        if document is None:
            return None
        if uri not in self._reviewed:
            self._reviewed[uri] = self._read(document)
        return self._reviewed[uri]

    def _read(self, document: Document) -> Reviewed:
        if document.source is None:
            return Reviewed(document)
        rests_on: set[str] = set()
        load = partial(self._load, rests_on, {}) if document.is_file else None
        syntax = parse_with_uses(document.source, load, self._parse)
        return Reviewed(document, syntax, frozenset(rests_on))

    def roots(self, beside: str) -> Iterator[Syntax]:
        """Yield every spec that may name what another one declares: the open ones, and those of the folders.

        beside: a file in whose folder specs are sought if the editor works in no folder.
        Raises: InputError: the folders hold too many files.
        """
        seen = set()
        for document in self.documents:
            known = self.reviewed(document.uri)
            seen.add(identity(document.name))
            if known is not None and known.syntax is not None:
                yield known.syntax
        folders = self.folders or (os.path.dirname(beside),)  # noqa: PTH120 - a name, which need not be there
        for path in specs_under(folders, deep=bool(self.folders)):
            with suppress(InputError):  # what cannot be read says nothing
                if identity(path) not in seen and "use" in files.read_used(path).text:
                    yield self.parsed(path, {})

    def parsed(self, name: str, instead: Mapping[str, str]) -> Syntax:
        """Parse a file or an open buffer and what it uses, open ones as they stand in the editor.

        Args:    instead: texts that count in place of those of files, by the identity of the file.
        Raises:  InputError: it cannot be read.
        """
        load = partial(self._load, set[str](), instead)
        document = self._documents.get(name)
        if document is None or document.is_file:
            return parse_with_uses(load(name), load)
        text = document.source.text if document.source is not None else ""
        return parse_with_uses(SourceText(name, instead.get(identity(name), text)), None)

    def _load(self, asked: set[str], instead: Mapping[str, str], path: str) -> SourceText:
        """Return the text of a file: of its buffer if it is open."""
        key = identity(path)
        asked.add(key)
        if key in instead:
            return SourceText(path, instead[key])
        document = self._open_at(key)
        if document is None:
            return files.read_used(path)
        if document.source is None:
            raise InputError([document.refusal] if document.refusal else [])
        return document.source if document.name == path else SourceText(path, document.source.text)

    def _open_at(self, key: str) -> Document | None:
        return next((d for d in self._documents.values() if d.is_file and identity(d.name) == key), None)

    def _open_as(self, name: str) -> Document | None:
        """Return the buffer of a file by a name of it: often the very one that the buffer has."""
        same = next((d for d in self._documents.values() if d.name == name), None)
        return same or self._open_at(identity(name))

    def location(self, source: SourceText, span: Span) -> Location:
        """Return where a stretch of a text is in the editor."""
        document = self._open_as(source.name)
        if document is not None and document.source is not None and document.source.text == source.text:
            return Location(document.uri, *document.places(span))
        if source.name not in self._lines or self._lines[source.name].text != source.text:
            self._lines[source.name] = Lines(source.text, self.encoding)
        lines = self._lines[source.name]
        return Location(uri_of(source.name), lines.place(span.start), lines.place(span.end))

    def uri(self, name: str) -> str:
        """Return the URI of a file, as the editor names it if it is open."""
        document = self._open_as(name)
        return document.uri if document is not None else uri_of(name)

    def findings(self) -> dict[str, tuple[Diagnostic, ...]]:
        """Return what is to be shown in each file, by URI: every open one, and those used that have problems."""
        shown: dict[str, dict[Diagnostic, None]] = {uri: {} for uri in self._documents}
        for uri in self._documents:
            known = self.reviewed(uri)
            assert known is not None
            for found in known.diagnostics:
                home = uri if found.source is None else self.uri(found.source.name)
                shown.setdefault(home, {})[found] = None
        return {uri: tuple(found) for uri, found in shown.items()}


def _settings(document: Document) -> tuple[Selection, tuple[Diagnostic, ...]]:
    """Return the settings that hold for a buffer; what is wrong with them is said, and the default holds."""
    if not document.is_file:
        return Selection(), ()
    try:
        return configured(Path(document.name)), ()
    except InputError as error:
        return Selection(), error.diagnostics
