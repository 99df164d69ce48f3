"""Plain results as the types of the protocol.

In: locations, diagnostics, edits. Out: objects of `lsprotocol`.
"""

from collections.abc import Iterable, Sequence

from lsprotocol import types

from stlspec.errors import Diagnostic, Edit
from stlspec.source import SourceText
from stlspec.tools.lsp.documents import Change
from stlspec.tools.lsp.positions import Place
from stlspec.tools.lsp.workspace import Location, Workspace

SOURCE = "stlspec"
_UNUSED = ("L615", "L616", "L617", "L618")
"""Codes of what could be left out; editors show it faded."""
_NOWHERE = types.Range(types.Position(0, 0), types.Position(0, 0))


def place(position: types.Position) -> Place:
    """Return a position of the protocol as a place."""
    return Place(position.line, position.character)


def change(event: types.TextDocumentContentChangeEvent) -> Change:
    """Return a change of a buffer."""
    if isinstance(event, types.TextDocumentContentChangePartial):
        return Change(event.text, place(event.range.start), place(event.range.end))
    return Change(event.text)


def span_range(location: Location) -> types.Range:
    """Return the range of a location."""
    start, end = location.start, location.end
    return types.Range(types.Position(start.line, start.character), types.Position(end.line, end.character))


def link(location: Location) -> types.Location:
    """Return a location of the protocol."""
    return types.Location(location.uri, span_range(location))


def text_edits(space: Workspace, source: SourceText, edits: Iterable[Edit]) -> list[types.TextEdit]:
    """Return edits of one text."""
    return [types.TextEdit(span_range(space.location(source, edit.span)), edit.text) for edit in edits]


def shown(space: Workspace, found: Diagnostic, *, related: bool) -> types.Diagnostic:
    """Return a diagnostic; with its second places only where the editor shows them."""
    at = _NOWHERE
    if found.source is not None and found.span is not None:
        at = span_range(space.location(found.source, found.span))
    lines: Sequence[str] = (found.message, found.label, f"help: {found.help}" if found.help else "")
    return types.Diagnostic(
        range=at,
        message="\n".join(filter(None, lines)),
        severity=types.DiagnosticSeverity.Error if found.severity == "error" else types.DiagnosticSeverity.Warning,
        code=found.code,
        source=SOURCE,
        tags=[types.DiagnosticTag.Unnecessary] if found.code in _UNUSED else None,
        related_information=[
            types.DiagnosticRelatedInformation(link(space.location(label.source, label.span)), label.text)
            for label in found.labels
        ]
        if related and found.labels
        else None,
    )
