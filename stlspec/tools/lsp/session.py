"""One sitting of an editor with the server: messages in, answers and diagnostics out, until it says `exit`.

In: two streams. Out: the exit code: 0 if the editor took its leave properly, else 1. Messages are handled one after
the other; diagnostics are worked out when no message has come for a moment, so that fast typing is not checked letter
by letter. The loop is our own because that of pygls ends at a header that it cannot read, never waits, and leaves
requests that it cannot read without an answer.
"""

import logging
import queue
import time
from collections.abc import Callable
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcException

from stlspec.tools.lsp import convert
from stlspec.tools.lsp.server import SpecServer, build, log
from stlspec.tools.lsp.transport import END, Inbox, Message, Read, framed

QUIET = 0.12
"""Seconds without a change after which diagnostics are worked out."""
PATIENCE = 0.6
"""Seconds after which they are, whatever comes in."""
_PARSE_ERROR, _INVALID_REQUEST, _NOT_READY, _CANCELLED = -32700, -32600, -32002, -32800

Write = Callable[[bytes], object]


def serve(read: Read, write: Write) -> int:
    """Talk to an editor until it leaves.

    Args:    read: returns bytes from the editor, none at the end. write: sends all bytes that it is given.
    Returns: the exit code of the process.
    """
    logging.getLogger("pygls").setLevel(logging.CRITICAL)
    return _Session(Inbox(read), write).run()


class _Out:
    """The stream to the editor, which may break at any time."""

    def __init__(self, write: Write) -> None:
        self._write = write
        self.broken = False

    def write(self, data: bytes) -> None:
        if not self.broken:
            try:
                self._write(data)
            except (OSError, ValueError) as error:
                self.broken = True
                log(f"the editor has gone: {error}")

    def close(self) -> None:
        """Leave the stream to its owner."""


class _Session:
    def __init__(self, inbox: Inbox, write: Write) -> None:
        self._inbox = inbox
        self._out = _Out(write)
        self._server: SpecServer = build()
        self._server.protocol.set_writer(self._out)
        self._ready = False
        self._since = self._last = 0.0
        self._pending = False
        self._sent: dict[str, tuple[int | None, list[types.Diagnostic]]] = {}

    def run(self) -> int:
        """Handle messages until the editor leaves, or its stream ends."""
        while not self._out.broken:
            if self._pending and time.monotonic() >= self._since + PATIENCE:
                self._publish()
            try:
                message = self._inbox.get(self._rest() if self._pending else None)
            except queue.Empty:
                self._publish()
                continue
            if message is END:
                log("the editor has gone without `exit`")
                break
            if isinstance(message, dict) and message.get("method") == "exit":
                break
            self._handle(message)
            self._note_change()
        return 0 if self._server.stopping else 1

    def _rest(self) -> float:
        """Return for how many seconds no message may come before diagnostics are worked out."""
        return max(0.0, min(self._last + QUIET, self._since + PATIENCE) - time.monotonic())

    def _note_change(self) -> None:
        if self._server.changed:
            self._last = time.monotonic()
            self._since = self._since if self._pending else self._last
            self._pending, self._server.changed = True, False

    def _handle(self, message: Message) -> None:
        """Handle one message; whatever is wrong with it is answered, or logged if it asks for no answer."""
        if not isinstance(message, dict):
            self._refuse(None, _PARSE_ERROR, str(message))
            return
        name, method = message.get("id"), message.get("method")
        asks = "id" in message and "method" in message
        problem = self._problem(message)
        if problem is not None:
            code, text = problem
            if asks or code == _INVALID_REQUEST:
                self._refuse(name if isinstance(name, int | str) else None, code, text)
            return
        try:
            if "method" in message:
                message.setdefault("params", None)
            self._server.protocol.handle_message(self._server.protocol.structure_message(message))
        except JsonRpcException as error:
            log(f"{method}: {error.message}")
            if asks:
                self._refuse(name, error.code, f"{method}: {error.message}")
        except Exception as error:
            log(f"{method} could not be handled: {type(error).__name__}: {str(error)[:200]}")
            if asks:
                self._refuse(name, JsonRpcException.CODE, f"{method} could not be handled")
        if method == types.INITIALIZE:
            self._ready = True

    def _problem(self, message: dict[str, Any]) -> tuple[int, str] | None:
        """Say why a message is not to be handled."""
        method = message.get("method", "")
        if message.get("jsonrpc") != "2.0" or not isinstance(method, str):
            return _INVALID_REQUEST, "a message that is no JSON-RPC 2.0"
        if "id" not in message and "method" not in message:
            return _INVALID_REQUEST, "a message without method and id"
        if "id" in message and not isinstance(message["id"], int | str):
            return _INVALID_REQUEST, "an id that is neither a number nor a text"
        if "id" in message and self._inbox.cancelled(message["id"]):
            return _CANCELLED, "taken back"
        if self._server.stopping:
            return _INVALID_REQUEST, "after shutdown there is only exit"
        if self._ready == (method == types.INITIALIZE):
            return (
                (_INVALID_REQUEST, "initialize comes once") if self._ready else (_NOT_READY, "initialize comes first")
            )
        return None

    def _refuse(self, name: int | str | None, code: int, text: str) -> None:
        self._out.write(framed({"jsonrpc": "2.0", "id": name, "error": {"code": code, "message": text}}))

    def _publish(self) -> None:
        """Send the diagnostics of every file of which they, or its version, changed."""
        self._pending = False
        server = self._server
        try:
            findings = server.space.findings()
        except Exception as error:
            log(f"diagnostics failed, a fault of stlspec: {type(error).__name__}: {str(error)[:200]}")
            return
        versions = {document.uri: document.version for document in server.space.documents}
        for uri in [*findings, *(self._sent.keys() - findings.keys())]:
            found = findings.get(uri, ())
            shown = [convert.shown(server.space, d, related=server.shows_related) for d in found]
            state = (versions.get(uri), shown)
            if self._sent.get(uri) != state:
                server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, shown, state[0]))
            self._sent[uri] = state
            if uri not in findings:
                del self._sent[uri]
