"""Plain results as the types of the protocol.

In: locations, diagnostics, edits. Out: objects of `lsprotocol`.
"""

from collections.abc import Iterable, Sequence

from lsprotocol import types

from stlspec.errors import Diagnostic, Edit
from stlspec.source import SourceText
from stlspec.tools.lsp.completion import Item
from stlspec.tools.lsp.documents import Change
from stlspec.tools.lsp.edits import Action
from stlspec.tools.lsp.outline import Symbol
from stlspec.tools.lsp.positions import Place
from stlspec.tools.lsp.workspace import Location, Workspace

SOURCE = "stlspec"
_UNUSED = ("L615", "L616", "L617", "L618")
"""Codes of what could be left out; editors show it faded."""
_ITEM_KINDS = {
    "signal": types.CompletionItemKind.Variable,
    "param": types.CompletionItemKind.Constant,
    "let": types.CompletionItemKind.Function,
    "requirement": types.CompletionItemKind.Property,
    "argument": types.CompletionItemKind.Variable,
    "word": types.CompletionItemKind.Keyword,
    "function": types.CompletionItemKind.Function,
    "unit": types.CompletionItemKind.Unit,
    "value": types.CompletionItemKind.Value,
    "file": types.CompletionItemKind.File,
    "folder": types.CompletionItemKind.Folder,
    "code": types.CompletionItemKind.EnumMember,
}
_SYMBOL_KINDS = {
    "spec": types.SymbolKind.Module,
    "use": types.SymbolKind.File,
    "signal": types.SymbolKind.Variable,
    "param": types.SymbolKind.Constant,
    "let": types.SymbolKind.Field,
    "template": types.SymbolKind.Function,
    "hard": types.SymbolKind.Property,
    "soft": types.SymbolKind.Property,
    "expect": types.SymbolKind.Event,
}
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


def item(space: Workspace, source: SourceText, found: Item) -> types.CompletionItem:
    """Return what may be written at the cursor."""
    return types.CompletionItem(
        label=found.text,
        kind=_ITEM_KINDS[found.kind],
        detail=found.detail or None,
        documentation=found.doc or None,
        sort_text=f"{found.order}{found.text}",
        filter_text=found.text,
        text_edit=types.TextEdit(span_range(space.location(source, found.span)), found.text),
    )


def symbol(space: Workspace, source: SourceText, found: Symbol) -> types.DocumentSymbol:
    """Return a statement for the list of an editor."""
    return types.DocumentSymbol(
        name=found.name,
        kind=_SYMBOL_KINDS[found.kind],
        range=span_range(space.location(source, found.span)),
        selection_range=span_range(space.location(source, found.name_span)),
        detail=found.detail or None,
    )


def symbol_information(uri: str, found: types.DocumentSymbol) -> types.SymbolInformation:
    """Return a statement in the older form, for an editor that knows no other."""
    return types.SymbolInformation(types.Location(uri, found.range), found.name, found.kind)


def workspace_edit(
    space: Workspace, changes: Iterable[tuple[SourceText, Iterable[Edit]]], *, versioned: bool
) -> types.WorkspaceEdit:
    """Return edits of several texts; with the versions that they are of, if the editor checks these."""
    made = {space.uri(source.name): text_edits(space, source, edits) for source, edits in changes}
    if not versioned:
        return types.WorkspaceEdit(changes=made)
    versions = {document.uri: document.version for document in space.documents}
    return types.WorkspaceEdit(
        document_changes=[
            types.TextDocumentEdit(types.OptionalVersionedTextDocumentIdentifier(uri, versions.get(uri)), list(edits))
            for uri, edits in made.items()
        ]
    )


def action(space: Workspace, found: Action, *, versioned: bool, related: bool) -> types.CodeAction:
    """Return a way out of a diagnostic."""
    return types.CodeAction(
        title=found.title,
        kind=types.CodeActionKind.QuickFix,
        diagnostics=[shown(space, found.found, related=related)],
        is_preferred=found.likely or None,
        edit=workspace_edit(space, [(found.source, found.edits)], versioned=versioned),
    )
