"""The page of a recording, served to this machine only.

In: requests to the loopback address. Out: the page, its state, a stream of revisions. A request is answered only if
it carries the token of this sitting in its path, is addressed to this very host and port, and does not come from
another site: a page elsewhere on the web that guesses the port can neither read nor press anything. Paths are looked
up in a table, never on the disk.
"""

import hmac
import json
import threading
import time
from collections.abc import Callable
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from typing import Any, Protocol

from stlspec.tools.record.desk import ClosedError, Desk
from stlspec.tools.record.frames import png

_LARGEST_REQUEST = 64 * 1024
_MOST_STREAMS = 16
_HEARTBEAT = 2.0
_FAREWELL = 1.0
_UNVISITED = 3600.0
PATIENCE = 15.0
"""So many seconds after the last page was closed nobody is expected back; a reload takes one or two."""
_ASSETS = {
    "": ("record.html", "text/html"),
    "record.css": ("record.css", "text/css"),
    "page.css": ("page.css", "text/css"),
    "record.js": ("record.js", "text/javascript"),
    "icon.svg": ("icon.svg", "image/svg+xml"),
}
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}


class Sitting(Protocol):
    """What the server needs of a session."""

    revision: int

    def about(self) -> dict[str, Any]: ...  # noqa: D102
    def view(self) -> dict[str, Any]: ...  # noqa: D102
    def act(self, request: dict[str, Any]) -> dict[str, Any]: ...  # noqa: D102
    def frame(self) -> Any: ...  # noqa: D102


class PageServer(ThreadingHTTPServer):
    """Serves one sitting under one token. Requests are answered by threads, the work is done at the desk."""

    daemon_threads = True
    allow_reuse_port = False
    request_queue_size = 64

    def __init__(self, port: int, token: str, desk: Desk, sitting: Sitting) -> None:
        """Bind to a port of the loopback address, 0 = any. Raises: OSError: it is taken."""
        self.token, self.desk, self.sitting = token, desk, sitting
        self.changed = threading.Condition()
        self.closing = False
        self._streams = 0
        self._left: float | None = None
        self._began: float | None = time.monotonic()
        self.patience = PATIENCE
        super().__init__(("127.0.0.1", port), _Handler)
        self.hosts = {f"{name}:{self.server_port}" for name in ("127.0.0.1", "localhost")}

    @property
    def url(self) -> str:
        """Where the page is."""
        return f"http://127.0.0.1:{self.server_port}/{self.token}/"

    def deserted(self) -> bool:
        """Tell whether every page that was open has been closed for some time, or none came for very long."""
        with self.changed:
            if self._began is not None and time.monotonic() - self._began > _UNVISITED:
                return True
            return self._left is not None and time.monotonic() - self._left > self.patience

    def news(self, told: int) -> bool:
        """Tell whether there is something that a page which knows revision `told` does not know."""
        return self.closing or self.sitting.revision != told

    def arrive(self) -> bool:
        """Count a page that listens; False if there are too many."""
        with self.changed:
            if self._streams >= _MOST_STREAMS:
                return False
            self._streams += 1
            self._left = self._began = None
            return True

    def leave(self) -> None:
        """Count a page that listens no more."""
        with self.changed:
            self._streams -= 1
            if not self._streams:
                self._left = time.monotonic()
                self.changed.notify_all()

    def tell(self) -> None:
        """Wake the streams: there is a new revision, or the end."""
        with self.changed:
            self.changed.notify_all()

    def farewell(self) -> None:
        """Tell all pages that it is over, and give them a moment to hear it."""
        with self.changed:
            self.closing = True
            self.changed.notify_all()
            self.changed.wait_for(lambda: not self._streams, timeout=_FAREWELL)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Stay silent when a browser hangs up."""


class _Handler(BaseHTTPRequestHandler):
    server: PageServer
    protocol_version = "HTTP/1.1"
    timeout = 30.0
    server_version, sys_version = "stlspec", ""

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002
        """Write no log: paths hold the token."""

    def do_GET(self) -> None:
        """Answer with an asset, the state, a frame or the stream of revisions."""
        name = self._admitted()
        if name is None:
            return
        if name in _ASSETS:
            file, kind = _ASSETS[name]
            package = "stlspec.pages" if file == "page.css" else "stlspec.tools.record"
            self._answer(200, files(package).joinpath(file).read_bytes(), f"{kind}; charset=utf-8")
        elif name == "events":
            self._stream()
        elif name in ("about", "view"):
            order = self.server.sitting.about if name == "about" else self.server.sitting.view
            self._json(order)
        elif name == "frame.png":
            self._frame()
        else:
            self._refuse(404)

    def do_POST(self) -> None:
        """Answer what the page asks to be done."""
        name = self._admitted()
        if name is None:
            return
        length = self.headers.get("Content-Length", "")
        if name not in ("act", "finish"):
            self._refuse(404)
        elif self.headers.get_content_type() != "application/json" or self.headers.get("Origin") is None:
            # A form of another site cannot send JSON without asking first, and a browser always names the origin.
            self._refuse(403)
        elif not length.isdecimal() or int(length) > _LARGEST_REQUEST:
            self._refuse(413)
        else:
            self._take(name, self.rfile.read(int(length)))

    def _take(self, name: str, body: bytes) -> None:
        try:
            request = json.loads(body)
        except (ValueError, RecursionError):
            request = None
        if not isinstance(request, dict):
            self._refuse(400)
        elif name == "finish":
            self._answer(200, b"{}", "application/json")
            self.server.desk.close()
        else:
            self._json(lambda: self.server.sitting.act(request))
            self.server.tell()

    def _admitted(self) -> str | None:
        """Return what is asked for under the token; None after refusing."""
        origin = self.headers.get("Origin")
        host = self.headers.get("Host", "")
        token, slash, name = self.path.split("?", 1)[0].removeprefix("/").partition("/")
        welcome = (
            host in self.server.hosts
            and origin in (None, f"http://{host}")
            and self.headers.get("Sec-Fetch-Site", "none") in ("none", "same-origin")
            and hmac.compare_digest(token.encode(), self.server.token.encode())
            and slash == "/"
        )
        if not welcome:
            self._refuse(403)
            return None
        return name

    def _json(self, order: Callable[[], dict[str, Any]]) -> None:
        try:
            found = self.server.desk.ask(order)
        except (ClosedError, TimeoutError):
            self._refuse(503)
            return
        self._answer(200, json.dumps(found, allow_nan=False).encode(), "application/json")

    def _frame(self) -> None:
        try:
            frame = self.server.desk.ask(self.server.sitting.frame)
        except (ClosedError, TimeoutError):
            self._refuse(503)
            return
        if frame is None:
            self._refuse(404)
        else:
            self._answer(200, png(frame), "image/png")

    def _stream(self) -> None:
        """Tell the page each new revision; its end tells us that the page was closed."""
        server = self.server
        if not server.arrive():
            self._refuse(503)
            return
        try:
            self.close_connection = True
            self._head(200, {"Content-Type": "text/event-stream", "Connection": "close"})
            while not server.closing:
                told = server.sitting.revision
                self.wfile.write(f"data: {told}\n\n".encode())
                self.wfile.flush()
                with server.changed:
                    # What changed while the page was being told woke nobody, so it is looked at before waiting.
                    server.changed.wait_for(partial(server.news, told), _HEARTBEAT)
            self.wfile.write(b"event: end\ndata: end\n\n")
        except OSError:
            return  # The page was closed.
        finally:
            server.leave()

    def _refuse(self, status: int) -> None:
        self.close_connection = True
        self._answer(status, b"refused\n", "text/plain")

    def _answer(self, status: int, body: bytes, kind: str) -> None:
        self._head(status, {"Content-Type": kind, "Content-Length": str(len(body))})
        if self.command != "HEAD":
            self.wfile.write(body)

    def _head(self, status: int, headers: dict[str, str]) -> None:
        self.send_response(status)
        for name, value in (headers | _HEADERS).items():
            self.send_header(name, value)
        self.end_headers()
