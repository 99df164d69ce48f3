"""The page is served to this machine, this token, this origin; everything else is refused, and nothing is read."""

import http.client
import json
import socket
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from stlspec.tools.record import server as module
from stlspec.tools.record.desk import Desk
from stlspec.tools.record.server import PageServer

TOKEN = "the-token"


class Counter:
    """A sitting that counts what it is asked for."""

    revision = 0

    def about(self) -> dict[str, Any]:
        return {"about": True}

    def view(self) -> dict[str, Any]:
        return {"revision": self.revision}

    def act(self, request: dict[str, Any]) -> dict[str, Any]:
        self.revision += 1
        return {"asked": request}

    def frame(self) -> Any:
        return None


class Served:
    """A server with its threads, and a client that says exactly what it is told to."""

    def __init__(self) -> None:
        self.sitting, self.desk = Counter(), Desk()
        self.server = PageServer(0, TOKEN, self.desk, self.sitting)
        self.host = f"127.0.0.1:{self.server.server_port}"
        self.threads = [
            threading.Thread(target=self.desk.run, args=(lambda: False,)),
            threading.Thread(target=self.server.serve_forever, args=(0.05,)),
        ]
        for thread in self.threads:
            thread.start()

    def close(self) -> None:
        self.server.farewell()
        self.desk.close()
        self.server.shutdown()
        for thread in self.threads:
            thread.join(5)
        self.server.server_close()

    def raw(self, head: str, body: bytes = b"") -> tuple[int, bytes]:
        with socket.create_connection(("127.0.0.1", self.server.server_port), timeout=5) as link:
            link.sendall(head.replace("\n", "\r\n").encode("latin-1") + b"\r\n\r\n" + body)
            answer = http.client.HTTPResponse(link)
            answer.begin()
            return answer.status, answer.read()

    def get(self, path: str, **headers: str) -> tuple[int, bytes]:
        lines = {"Host": self.host, "Connection": "close"} | {k.replace("_", "-"): v for k, v in headers.items()}
        return self.raw(f"GET {path} HTTP/1.1\n" + "\n".join(f"{k}: {v}" for k, v in lines.items()))

    def post(self, path: str, body: bytes, **headers: str) -> tuple[int, bytes]:
        lines = {
            "Host": self.host, "Connection": "close", "Origin": f"http://{self.host}",
            "Content-Type": "application/json", "Content-Length": str(len(body)),
        } | {k.replace("_", "-"): v for k, v in headers.items()}  # fmt: skip
        return self.raw(f"POST {path} HTTP/1.1\n" + "\n".join(f"{k}: {v}" for k, v in lines.items() if v), body)


@pytest.fixture
def served() -> Iterator[Served]:
    found = Served()
    yield found
    found.close()


def test_the_page_and_its_parts_are_served_under_the_token(served: Served) -> None:
    for name in ("", "record.css", "page.css", "record.js", "icon.svg", "about", "view"):
        status, body = served.get(f"/{TOKEN}/{name}")
        assert status == 200
        assert len(body) > 10
    assert served.get(f"/{TOKEN}/frame.png")[0] == 404
    assert served.get(f"/{TOKEN}/?query")[0] == 200


@pytest.mark.parametrize(
    "path",
    [
        "/", "", "*", "/wrong/", "/wrong/view", f"/{TOKEN}", f"/{TOKEN}x/view", "/the-toke/view", "//", f"/x/{TOKEN}/",
        "/%00/view", "/\xff\xfe/view", f"http://evil.example/{TOKEN}x/",
    ],
)  # fmt: skip
def test_without_the_token_everything_is_refused(served: Served, path: str) -> None:
    assert served.get(path or "/") == (403, b"refused\n")
    assert served.post(path or "/", b"{}")[0] == 403


@pytest.mark.parametrize(
    "path",
    [
        "../pyproject.toml", "../../etc/passwd", "..%2f..%2fetc/passwd", "%2e%2e/record.py", "record.js/../server.py",
        "/etc/passwd", "./record.js", "record.html", "server.py", "record.js%00", "....//record.js", "events/x",
        "\\..\\server.py",
    ],
)  # fmt: skip
def test_paths_lead_nowhere_but_to_what_is_listed(served: Served, path: str) -> None:
    assert served.get(f"/{TOKEN}/{path}") == (404, b"refused\n")


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1", "127.0.0.1:1", "localhost", "[::1]", "", "127.0.0.1:{}x"]
)
def test_another_host_is_refused_so_that_no_name_can_be_rebound_to_us(served: Served, host: str) -> None:
    named = host.format(served.server.server_port)
    assert served.get(f"/{TOKEN}/view", Host=named)[0] == 403
    assert served.post(f"/{TOKEN}/act", b"{}", Host=named)[0] == 403


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://{}", "http://127.0.0.1:1", "http://{}/"])
def test_another_site_is_refused(served: Served, origin: str) -> None:
    named = origin.format(served.host)
    assert served.get(f"/{TOKEN}/view", Origin=named)[0] == 403
    assert served.post(f"/{TOKEN}/act", b"{}", Origin=named)[0] == 403
    assert served.sitting.revision == 0


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_a_request_that_the_browser_calls_foreign_is_refused(served: Served, site: str) -> None:
    assert served.get(f"/{TOKEN}/view", Sec_Fetch_Site=site)[0] == 403
    assert served.post(f"/{TOKEN}/act", b"{}", Sec_Fetch_Site=site)[0] == 403


@pytest.mark.parametrize(
    ("headers", "body", "status"),
    [
        ({}, b'{"do": "x"}', 200),
        ({"Origin": ""}, b"{}", 403),
        ({"Content-Type": "text/plain"}, b"{}", 403),
        ({"Content-Type": "application/x-www-form-urlencoded"}, b"{}", 403),
        ({}, b"not json", 400),
        ({}, b"[1]", 400),
        ({}, b"[" * 30_000, 400),
        ({}, b"\xff\xfe", 400),
        ({"Content-Length": "99999999"}, b"{}", 413),
        ({"Content-Length": "-1"}, b"{}", 413),
        ({"Content-Length": "x"}, b"{}", 413),
        ({"Content-Length": ""}, b"{}", 413),
    ],
)
def test_only_our_own_page_can_press_anything(served: Served, headers: dict, body: bytes, status: int) -> None:
    assert served.post(f"/{TOKEN}/act", body, **headers)[0] == status
    assert served.sitting.revision == (status == 200)


def test_every_answer_forbids_what_the_page_does_not_need(served: Served) -> None:
    link = http.client.HTTPConnection("127.0.0.1", served.server.server_port)
    for path in (f"/{TOKEN}/", f"/{TOKEN}/view", "/wrong/"):
        link.request("GET", path)
        answer = link.getresponse()
        answer.read()
        assert "default-src 'none'" in answer.headers["Content-Security-Policy"]
        assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
        assert answer.headers["X-Content-Type-Options"] == "nosniff"
        assert answer.headers["Referrer-Policy"] == "no-referrer"
        assert answer.headers["Cache-Control"] == "no-store"
        assert "Access-Control-Allow-Origin" not in answer.headers
        assert "Python" not in answer.headers["Server"]
    link.close()
    assert served.get(f"/{TOKEN}/", Origin=f"http://{served.host}")[0] == 200
    assert served.raw(f"OPTIONS /{TOKEN}/act HTTP/1.1\nHost: {served.host}\nConnection: close")[0] == 501
    assert served.raw(f"PUT /{TOKEN}/act HTTP/1.1\nHost: {served.host}\nConnection: close")[0] == 501


def test_it_listens_on_the_loopback_address_only(served: Served) -> None:
    assert served.server.server_address[0] == "127.0.0.1"


def stream(served: Served) -> socket.socket:
    link = socket.create_connection(("127.0.0.1", served.server.server_port), timeout=5)
    link.sendall(f"GET /{TOKEN}/events HTTP/1.1\r\nHost: {served.host}\r\n\r\n".encode())
    return link


def read_until(link: socket.socket, wanted: bytes) -> bytes:
    found = b""
    while wanted not in found:
        piece = link.recv(4096)
        assert piece, found
        found += piece
    return found


def test_the_stream_tells_revisions_at_once_and_the_end(served: Served) -> None:
    with stream(served) as link:
        read_until(link, b"data: 0\n\n")
        start = time.monotonic()
        served.post(f"/{TOKEN}/act", json.dumps({"do": "x"}).encode())
        read_until(link, b"data: 1\n\n")
        assert time.monotonic() - start < 1.5
        assert not served.server.deserted()
        served.server.farewell()
        read_until(link, b"event: end")


def test_a_change_while_the_page_is_being_told_is_not_slept_through(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_HEARTBEAT", 60.0)
    told = iter([0])
    # Whoever reads the revision first sees 0, everybody after that 1: it changed before the stream could wait.
    monkeypatch.setattr(Counter, "revision", property(lambda _: next(told, 1)))
    with stream(served) as link:
        found = read_until(link, b"data: 1\n\n")  # the link itself waits 5 s at most
    assert b"data: 0\n\n" in found


def test_it_is_deserted_some_time_after_the_last_page_was_closed(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_HEARTBEAT", 0.05)
    served.server.patience = 0.3
    time.sleep(0.5)
    assert not served.server.deserted(), "no page was opened yet"
    first, second = stream(served), stream(served)
    read_until(first, b"data: 0")
    read_until(second, b"data: 0")
    first.close()
    time.sleep(0.6)
    assert not served.server.deserted(), "one page is still open"
    second.close()
    limit = time.monotonic() + 5
    while not served.server.deserted() and time.monotonic() < limit:
        time.sleep(0.05)
    assert served.server.deserted()


def test_it_does_not_wait_for_a_first_page_for_ever(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    assert not served.server.deserted()
    monkeypatch.setattr(module, "_UNVISITED", 0.0)
    assert served.server.deserted()
    with stream(served) as link:
        read_until(link, b"data: 0")
        assert not served.server.deserted()


def test_pages_beyond_the_most_are_turned_away(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_MOST_STREAMS", 1)
    with stream(served) as link:
        read_until(link, b"data: 0")
        assert served.get(f"/{TOKEN}/events")[0] == 503


def test_when_the_desk_is_closed_requests_are_not_left_waiting(served: Served) -> None:
    served.desk.close()
    served.threads[0].join(5)
    assert served.get(f"/{TOKEN}/view")[0] == 503
