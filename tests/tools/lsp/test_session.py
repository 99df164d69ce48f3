"""No message ends the server but `exit`, and every request is answered."""

import io
import json
import os
import threading

import pytest

from stlspec.tools.lsp import server, session, transport
from tests.tools.lsp.client import Client, RefusedError, shape

URI = "untitled:1"
TEXT = "signal x\nhard a: always (x > 0)\n"


@pytest.fixture(scope="module")
def client():
    client = Client(inside=True)
    yield client
    assert client.stop() == 0


def alive(client):
    """Ask for something that only a server in order can answer."""
    client.open(URI, TEXT)
    found = client.at("hover", URI, 1, 8)
    client.close(URI)
    return "every sample" in found["contents"]["value"]


@pytest.mark.parametrize(
    "body",
    [
        b"{",
        b"[]",
        b"null",
        b"\xff\xfe",
        b'{"id": 1, "method": "textDocument/hover"}',
        b'{"jsonrpc": "2.0"}',
        b'{"jsonrpc": "2.0", "id": {}, "method": "shutdown"}',
        b'{"jsonrpc": "2.0", "method": 5, "id": 1}',
        b"[" * 50_000,
    ],
)
def test_what_is_no_request_is_answered_with_an_error(client, body):
    client.raw(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
    while "error" not in (message := client.receive()):
        pass
    assert message["error"]["code"] in (-32700, -32600)
    assert alive(client)


@pytest.mark.parametrize(
    ("method", "params", "code"),
    [
        ("textDocument/hover", None, -32602),
        ("textDocument/hover", {"textDocument": 5, "position": {}}, -32602),
        ("textDocument/hover", {"textDocument": {"uri": URI}, "position": {"line": "a", "character": 0}}, -32602),
        ("no/such", {}, -32601),
        ("initialize", {"capabilities": {}}, -32600),
        ("workspace/executeCommand", {"command": "rm"}, -32602),
    ],
)
def test_a_request_that_cannot_be_read_or_done_is_answered(client, method, params, code):
    with pytest.raises(RefusedError) as caught:
        client.request(method, params)
    assert caught.value.code == code
    assert alive(client)


@pytest.mark.parametrize(
    ("method", "params"),
    [
        ("no/such", {}),
        ("$/cancelRequest", {"id": 99}),
        ("$/cancelRequest", {}),
        ("textDocument/didOpen", {"textDocument": {}}),
        (
            "textDocument/didOpen",
            {"textDocument": {"uri": "//[", "languageId": "", "version": 0, "text": "signal \ud800"}},
        ),
        ("textDocument/didChange", {"textDocument": {"uri": "file:///none", "version": 2}, "contentChanges": []}),
        ("textDocument/didClose", {"textDocument": {"uri": "file:///none"}}),
        ("notebookDocument/didClose", {"notebookDocument": {"uri": "a"}, "cellTextDocuments": []}),
    ],
)
def test_a_notification_that_makes_no_sense_is_passed_over(client, method, params):
    client.notify(method, params)
    assert alive(client)


def test_an_absurd_length_and_bytes_between_messages_are_passed_over(client):
    client.raw(b"Content-Length: 99999999999999999999\r\n\r\n\r\nhello\r\n")
    assert alive(client)


@pytest.mark.parametrize("place", [(0, 10**6), (10**6, 0), (2**31 - 1, 2**31 - 1)])
def test_a_place_outside_the_text_is_its_end(client, place):
    client.open(URI, TEXT)
    assert client.at("hover", URI, *place) is None or place[0] == 0
    client.change(URI, (place, place, " "))
    assert isinstance(client.diagnostics(URI), list)
    client.close(URI)


def test_a_text_that_is_refused_is_one_diagnostic(client):
    client.open(URI, "signal x\0")
    assert shape(client.diagnostics(URI)) == [("S091", 0)]
    client.change(URI, TEXT)
    assert client.diagnostics(URI) == []
    client.close(URI)


def test_fast_typing_is_checked_when_it_rests(client):
    client.open(URI, "")
    typed = TEXT[:40]
    for i, letter in enumerate(typed):
        place = (typed[:i].count("\n"), i - typed.rfind("\n", 0, i) - 1)
        client.change(URI, (place, place, letter))
    seen = []
    while not seen or seen[-1] != client.versions[URI]:
        message = client.receive()
        if message.get("method") == "textDocument/publishDiagnostics":
            seen.append(message["params"]["version"])
    assert len(seen) < len(typed) / 2
    client.close(URI)


def test_before_initialize_and_after_shutdown_requests_are_refused():
    client = Client(start=False, inside=True)
    with pytest.raises(RefusedError) as caught:
        client.at("hover", URI, 0, 0)
    assert caught.value.code == -32002
    client.request("initialize", {"capabilities": {}})
    client.request("shutdown", None)
    with pytest.raises(RefusedError) as caught:
        client.at("hover", URI, 0, 0)
    assert caught.value.code == -32600
    assert client.leave() == 0


class Pair:
    """A server in a thread of this process, with a stream to it and what it wrote."""

    def __init__(self, write=None):
        self.written = bytearray()
        source, self.sink = os.pipe()
        self.code = None

        def run():
            self.code = session.serve(lambda most: os.read(source, most), write or self.written.extend)
            os.close(source)

        self.thread = threading.Thread(target=run)
        self.thread.start()

    def send(self, *messages):
        for message in messages:
            os.write(self.sink, session.framed({"jsonrpc": "2.0", **message}))

    def end(self):
        os.close(self.sink)
        self.thread.join(60)
        return self.code


INITIALIZE = {"id": 0, "method": "initialize", "params": {"capabilities": {}}}
HOVER = {
    "method": "textDocument/hover",
    "params": {"textDocument": {"uri": URI}, "position": {"line": 0, "character": 0}},
}


def test_an_editor_that_goes_without_a_word_ends_the_server(capfd):
    pair = Pair()
    pair.send(INITIALIZE)
    assert pair.end() == 1
    assert "without `exit`" in capfd.readouterr().err


def test_an_editor_that_no_longer_reads_ends_the_server(capfd):
    def gone(data):
        raise BrokenPipeError("gone")

    pair = Pair(gone)
    pair.send(INITIALIZE)
    pair.thread.join(60)
    assert pair.end() == 1
    assert "the editor has gone" in capfd.readouterr().err


def test_a_request_taken_back_while_it_waits_is_not_worked_on(monkeypatch):
    taken_back = threading.Event()
    note, handle = transport.Inbox._note, session._Session._handle

    def noted(self, message):
        note(self, message)
        if isinstance(message, dict) and message.get("method") == "$/cancelRequest":
            taken_back.set()

    def handled(self, message):
        taken_back.wait(60)
        handle(self, message)

    monkeypatch.setattr(transport.Inbox, "_note", noted)
    monkeypatch.setattr(session._Session, "_handle", handled)
    pair = Pair()
    pair.send(INITIALIZE, {"id": 1, **HOVER}, {"method": "$/cancelRequest", "params": {"id": 1}}, {"id": 2, **HOVER})
    assert pair.end() == 1
    answers = [json.loads(body) for body in transport.bodies(io.BytesIO(pair.written).read)]
    assert [(a["id"], a.get("error", {}).get("code")) for a in answers] == [(0, None), (1, -32800), (2, None)]


def test_a_fault_of_ours_is_an_answer_and_a_line_in_the_log(monkeypatch):
    def broken(*_):
        raise ZeroDivisionError("secret")

    log = []
    said = threading.Event()
    monkeypatch.setattr(server, "log", log.append)
    monkeypatch.setattr(session, "log", lambda text: (log.append(text), said.set()))
    monkeypatch.setattr(server, "hover", broken)
    monkeypatch.setattr(server.Workspace, "findings", broken)
    item = {"uri": URI, "languageId": "stlspec", "version": 1, "text": TEXT}
    pair = Pair()
    pair.send(INITIALIZE, {"method": "textDocument/didOpen", "params": {"textDocument": item}}, {"id": 1, **HOVER})
    assert said.wait(60)
    pair.send({"id": 2, "method": "shutdown"}, {"method": "exit"})
    assert pair.end() == 0
    assert b"a fault of stlspec: ZeroDivisionError" in pair.written
    # which comes first is a matter of the machine: diagnostics are worked out when nothing waits
    assert sorted(line.split(",")[0] for line in log) == ["diagnostics failed", "textDocument/hover failed"]
