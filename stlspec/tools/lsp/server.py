"""The features of the language server, as pygls is told of them.

In: requests of the protocol. Out: answers, from the functions of the other modules; nothing is worked out here. The
buffers are kept by `Workspace`, not by pygls, which cuts lines at characters that end none and moves columns.
"""

import os
import sys
import traceback
from collections.abc import Callable, Generator
from typing import Any, TypeAlias

from lsprotocol import types
from pygls.exceptions import FeatureRequestError, JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol, lsp_method

from stlspec import __version__
from stlspec.errors import Diagnostic, StlspecError
from stlspec.tools.lsp import convert
from stlspec.tools.lsp.completion import completion
from stlspec.tools.lsp.documents import path_of
from stlspec.tools.lsp.edits import actions, formatting
from stlspec.tools.lsp.hover import hover
from stlspec.tools.lsp.navigation import definition, references
from stlspec.tools.lsp.outline import outline
from stlspec.tools.lsp.positions import DEFAULT, Encoding
from stlspec.tools.lsp.renaming import renamable, rename
from stlspec.tools.lsp.workspace import Reviewed, Workspace

_FAILED = -32803
"""The code of a request that is understood and cannot be done."""
_ENCODINGS: dict[str, Encoding] = {"utf-8": "utf-8", "utf-16": "utf-16", "utf-32": "utf-32"}

_Positioned: TypeAlias = (
    types.HoverParams
    | types.DefinitionParams
    | types.CompletionParams
    | types.ReferenceParams
    | types.PrepareRenameParams
    | types.RenameParams
)


def log(text: str) -> None:
    """Write a line for the log of the editor: on stderr, since stdout belongs to the protocol."""
    print(f"stlspec lsp: {text}", file=sys.stderr, flush=True)


class _Protocol(LanguageServerProtocol):
    """The protocol of pygls without its copies of the buffers."""

    def _passed_on(self, method: str, params: Any) -> Generator[Any, Any, None]:
        yield self.fm.features[method], (params,), None

    @lsp_method(types.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(self, params: types.DidOpenTextDocumentParams) -> Generator[Any, Any, None]:
        yield from self._passed_on(types.TEXT_DOCUMENT_DID_OPEN, params)

    @lsp_method(types.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(self, params: types.DidChangeTextDocumentParams) -> Generator[Any, Any, None]:
        yield from self._passed_on(types.TEXT_DOCUMENT_DID_CHANGE, params)

    @lsp_method(types.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(self, params: types.DidCloseTextDocumentParams) -> Generator[Any, Any, None]:
        yield from self._passed_on(types.TEXT_DOCUMENT_DID_CLOSE, params)


class SpecServer(LanguageServer):
    """A server with its workspace, and what the editor can show."""

    def __init__(self) -> None:
        super().__init__("stlspec", __version__, protocol_cls=_Protocol)
        self.space = Workspace()
        self.shows_related = self.checks_versions = self.nests_symbols = False
        """What the editor can do with answers."""
        self.changed = False
        """Whether something happened since diagnostics were last shown."""
        self.stopping = False

    def report_server_error(self, error: Exception, source: Any) -> None:
        """Write what has no answer to say it in to the log, not into a window of the editor."""
        if source is not FeatureRequestError:
            log(f"{source.__name__}: {error}")


def build() -> SpecServer:
    """Return a server with all features."""
    server = SpecServer()
    for method, (handler, options) in _FEATURES.items():
        server.feature(method, options)(_bound(server, method, handler))
    return server


def _bound(server: SpecServer, method: str, handler: Callable[[SpecServer, Any], Any]) -> Callable[[Any], Any]:
    """Return a handler for pygls: what goes wrong in it is an answer, and never the end of the server."""

    def handle(params: Any) -> Any:
        try:
            return handler(server, params)
        except JsonRpcException:
            raise
        except StlspecError as error:
            raise JsonRpcException("; ".join(_said(d) for d in error.diagnostics), _FAILED) from None
        except Exception as error:
            problem = f"{type(error).__name__}: {str(error)[:200]}"
            log(f"{method} failed, a fault of stlspec: {problem}")
            if os.environ.get("STLSPEC_DEBUG"):
                traceback.print_exc()
            raise JsonRpcException(f"a fault of stlspec: {problem}") from None

    return handle


def _said(found: Diagnostic) -> str:
    return f"{found.message} ({found.help})" if found.help else found.message


def _initialize(server: SpecServer, params: types.InitializeParams) -> None:
    encoding = server.workspace.position_encoding
    server.space = Workspace(_ENCODINGS.get(str(getattr(encoding, "value", encoding)), DEFAULT))
    shows = params.capabilities.text_document and params.capabilities.text_document.publish_diagnostics
    server.shows_related = bool(shows and shows.related_information)
    edits = params.capabilities.workspace and params.capabilities.workspace.workspace_edit
    server.checks_versions = bool(edits and edits.document_changes)
    symbols = params.capabilities.text_document and params.capabilities.text_document.document_symbol
    server.nests_symbols = bool(symbols and symbols.hierarchical_document_symbol_support)


def _initialized(server: SpecServer, _: types.InitializedParams) -> None:
    """Ask the editor to say when files change that specs rest on."""
    workspace = server.client_capabilities.workspace
    watches = workspace and workspace.did_change_watched_files
    if watches and watches.dynamic_registration:
        watchers = [types.FileSystemWatcher(f"**/{name}") for name in ("*.stl", "*.stlspec", "pyproject.toml")]
        options = types.DidChangeWatchedFilesRegistrationOptions(watchers)
        method = types.WORKSPACE_DID_CHANGE_WATCHED_FILES
        server.client_register_capability(types.RegistrationParams([types.Registration("files", method, options)]))


def _shutdown(server: SpecServer, _: None) -> None:
    server.stopping = True


def _open(server: SpecServer, params: types.DidOpenTextDocumentParams) -> None:
    item = params.text_document
    server.space.open(item.uri, item.version, item.text)
    server.changed = True


def _change(server: SpecServer, params: types.DidChangeTextDocumentParams) -> None:
    item = params.text_document
    server.space.change(item.uri, item.version, [convert.change(event) for event in params.content_changes])
    server.changed = True


def _close(server: SpecServer, params: types.DidCloseTextDocumentParams) -> None:
    server.space.close(params.text_document.uri)
    server.changed = True


def _disk(server: SpecServer, _: types.DidSaveTextDocumentParams | types.DidChangeWatchedFilesParams) -> None:
    server.space.refresh()
    server.changed = True


def _at(server: SpecServer, params: _Positioned) -> tuple[Reviewed, int] | None:
    """Return the buffer that a request is about, and the offset in it."""
    known = server.space.reviewed(params.text_document.uri)
    return (known, known.document.offset(convert.place(params.position))) if known is not None else None


def _hover(server: SpecServer, params: types.HoverParams) -> types.Hover | None:
    at = _at(server, params)
    found = hover(*at) if at is not None else None
    if at is None or found is None or at[0].syntax is None:
        return None
    content = types.MarkupContent(types.MarkupKind.Markdown, found.markdown)
    return types.Hover(content, convert.span_range(server.space.location(at[0].syntax.source, found.span)))


def _definition(server: SpecServer, params: types.DefinitionParams) -> types.Location | None:
    at = _at(server, params)
    found = definition(*at) if at is not None else None
    return convert.link(server.space.location(found.source, found.span)) if found is not None else None


def _formatting(server: SpecServer, params: types.DocumentFormattingParams) -> list[types.TextEdit] | None:
    known = server.space.reviewed(params.text_document.uri)
    if known is None or known.syntax is None:
        return None
    return convert.text_edits(server.space, known.syntax.source, formatting(known))


def _completion(server: SpecServer, params: types.CompletionParams) -> list[types.CompletionItem]:
    at = _at(server, params)
    if at is None or at[0].syntax is None:
        return []
    source = at[0].syntax.source
    return [convert.item(server.space, source, found) for found in completion(*at)]


def _folders(server: SpecServer) -> None:
    """Let the workspace know where the editor works now."""
    paths = [path_of(folder.uri) for folder in server.workspace.folders.values()] or [server.workspace.root_path]
    server.space.folders = tuple(path for path in paths if path)


def _references(server: SpecServer, params: types.ReferenceParams) -> list[types.Location]:
    at = _at(server, params)
    if at is None:
        return []
    _folders(server)
    found = references(server.space, *at)
    wanted = [place for place, declares in found if params.context.include_declaration or not declares]
    return [convert.link(server.space.location(place.source, place.span)) for place in wanted]


def _prepare_rename(server: SpecServer, params: types.PrepareRenameParams) -> types.Range | None:
    at = _at(server, params)
    if at is None or at[0].syntax is None:
        return None
    span = renamable(*at)
    return convert.span_range(server.space.location(at[0].syntax.source, span)) if span is not None else None


def _rename(server: SpecServer, params: types.RenameParams) -> types.WorkspaceEdit | None:
    at = _at(server, params)
    if at is None:
        return None
    _folders(server)
    made = rename(server.space, *at, params.new_name)
    changes = [(one.source, one.edits) for one in made]
    return convert.workspace_edit(server.space, changes, versioned=server.checks_versions)


def _code_actions(server: SpecServer, params: types.CodeActionParams) -> list[types.CodeAction]:
    known = server.space.reviewed(params.text_document.uri)
    only = params.context.only
    if known is None or (only is not None and not any(_is_quick_fix(kind) for kind in only)):
        return []
    start, end = (known.document.offset(convert.place(at)) for at in (params.range.start, params.range.end))
    can = {"versioned": server.checks_versions, "related": server.shows_related}
    return [convert.action(server.space, found, **can) for found in actions(known, start, end)]


def _is_quick_fix(kind: types.CodeActionKind | str) -> bool:
    return getattr(kind, "value", kind) in ("", types.CodeActionKind.QuickFix.value)


def _symbols(
    server: SpecServer, params: types.DocumentSymbolParams
) -> list[types.DocumentSymbol] | list[types.SymbolInformation]:
    uri = params.text_document.uri
    known = server.space.reviewed(uri)
    if known is None or known.syntax is None:
        return []
    found = [convert.symbol(server.space, known.syntax.source, one) for one in outline(known.syntax)]
    return found if server.nests_symbols else [convert.symbol_information(uri, one) for one in found]


_FEATURES: dict[str, tuple[Callable[[SpecServer, Any], Any], Any]] = {
    types.INITIALIZE: (_initialize, None),
    types.INITIALIZED: (_initialized, None),
    types.SHUTDOWN: (_shutdown, None),
    types.TEXT_DOCUMENT_DID_OPEN: (_open, None),
    types.TEXT_DOCUMENT_DID_CHANGE: (_change, None),
    types.TEXT_DOCUMENT_DID_CLOSE: (_close, None),
    types.TEXT_DOCUMENT_DID_SAVE: (_disk, types.SaveOptions()),
    types.WORKSPACE_DID_CHANGE_WATCHED_FILES: (_disk, None),
    types.TEXT_DOCUMENT_HOVER: (_hover, None),
    types.TEXT_DOCUMENT_DEFINITION: (_definition, None),
    types.TEXT_DOCUMENT_FORMATTING: (_formatting, None),
    types.TEXT_DOCUMENT_COMPLETION: (_completion, types.CompletionOptions(trigger_characters=['"', "/"])),
    types.TEXT_DOCUMENT_REFERENCES: (_references, None),
    types.TEXT_DOCUMENT_PREPARE_RENAME: (_prepare_rename, None),
    types.TEXT_DOCUMENT_RENAME: (_rename, types.RenameOptions(prepare_provider=True)),
    types.TEXT_DOCUMENT_CODE_ACTION: (
        _code_actions,
        types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix]),
    ),
    types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: (_symbols, None),
}
