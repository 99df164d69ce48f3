"""A small editor: starts the language server as editors do, and talks to it over its standard streams.

It is strict: whatever the server writes that is no message of the protocol fails the test.
"""

import io
import json
import os
import queue
import re
import subprocess
import sys
import threading

from stlspec.tools.lsp.session import serve

PATIENCE = 60


class RefusedError(Exception):
    """The server answered with an error."""

    def __init__(self, error):
        super().__init__(error["message"])
        self.code = error["code"]


def outside():
    """A server in a process of its own, as editors have it."""
    pipe = subprocess.PIPE
    return subprocess.Popen([sys.executable, "-m", "stlspec", "lsp"], stdin=pipe, stdout=pipe, stderr=pipe)


class Inside:
    """A server in a thread."""

    def __init__(self):
        source, to_server = os.pipe()
        from_server, sink = os.pipe()
        self.stdin, self.stdout, self.stderr = os.fdopen(to_server, "wb"), os.fdopen(from_server, "rb"), io.BytesIO()
        self.code = None

        def run():
            with os.fdopen(sink, "wb") as out:
                self.code = serve(lambda most: os.read(source, most), lambda data: (out.write(data), out.flush()))
            os.close(source)

        self.thread = threading.Thread(target=run, daemon=True)
        self.thread.start()

    def wait(self, patience):
        self.thread.join(patience)
        return self.code


class Client:
    """One sitting. Documents are kept as the editor has them: `texts`, `versions`."""

    def __init__(self, *, encodings=None, start=True, folders=None, modern=True, inside=False):
        """inside: the server runs in a thread of this process, which starts sooner."""
        server = Inside() if inside else outside()
        self.stdin, self.stdout, self.stderr, self.wait = server.stdin, server.stdout, server.stderr, server.wait
        self.messages = queue.Queue()
        self.shown = {}
        self.texts, self.versions = {}, {}
        self.asked = []
        self.last = 0
        self.log = []
        listening = (self._listen, lambda: self.log.extend(self.stderr))
        self.threads = [threading.Thread(target=target, daemon=True) for target in listening]
        for thread in self.threads:
            thread.start()
        if start:
            general = {"positionEncodings": encodings} if encodings is not None else {}
            text = {
                "publishDiagnostics": {"relatedInformation": True},
                "rename": {"prepareSupport": True},
                "documentSymbol": {"hierarchicalDocumentSymbolSupport": True},
            }
            space = {
                "didChangeWatchedFiles": {"dynamicRegistration": True},
                "workspaceEdit": {"documentChanges": True},
            }
            capabilities = {"general": general, "textDocument": text, "workspace": space} if modern else {}
            params = {"processId": None, "rootUri": None, "capabilities": capabilities, "workspaceFolders": folders}
            self.capabilities = self.request("initialize", params)["capabilities"]
            self.notify("initialized", {})

    def _listen(self):
        stream = self.stdout
        try:
            while header := stream.readline():
                length = re.fullmatch(rb"Content-Length: (\d+)\r\n", header)
                assert length, f"no header: {header!r}"
                while (more := stream.readline()) != b"\r\n":
                    assert re.fullmatch(rb"[\w-]+: [^\r\n]+\r\n", more), f"no header: {more!r}"
                self.messages.put(json.loads(stream.read(int(length[1]))))
        except (AssertionError, ValueError) as error:
            self.messages.put(error)
        self.messages.put(None)

    def send(self, message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.raw(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))

    def raw(self, data):
        self.stdin.write(data)
        self.stdin.flush()

    def notify(self, method, params):
        self.send({"method": method, "params": params})

    def receive(self):
        message = self.messages.get(timeout=PATIENCE)
        if message is None or isinstance(message, Exception):
            raise AssertionError(f"the server has gone: {message}, {b''.join(self.log).decode()}")
        if message.get("method") == "textDocument/publishDiagnostics":
            params = message["params"]
            self.shown[params["uri"]] = (params.get("version"), params["diagnostics"])
        elif "method" in message and "id" in message:
            self.asked.append(message)
            self.send({"id": message["id"], "result": None})
        return message

    def request(self, method, params):
        self.last += 1
        self.send({"id": self.last, "method": method, "params": params})
        return self.answer(self.last)

    def answer(self, name):
        while True:
            message = self.receive()
            if "method" not in message and message.get("id") == name:
                if "error" in message:
                    raise RefusedError(message["error"])
                return message["result"]

    def open(self, uri, text):
        self.texts[uri], self.versions[uri] = text, 1
        item = {"uri": uri, "languageId": "stlspec", "version": 1, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": item})

    def change(self, uri, *changes):
        """Send changes: (start, end, text) with (line, character) places, or a whole text."""
        self.versions[uri] += 1
        events = [
            {"text": change}
            if isinstance(change, str)
            else {"range": {"start": place(change[0]), "end": place(change[1])}, "text": change[2]}
            for change in changes
        ]
        item = {"uri": uri, "version": self.versions[uri]}
        self.notify("textDocument/didChange", {"textDocument": item, "contentChanges": events})

    def close(self, uri):
        self.notify("textDocument/didClose", {"textDocument": {"uri": uri}})

    def diagnostics(self, uri, version=None):
        """Wait for the diagnostics of a version of a document, the last one if none is said."""
        version = self.versions[uri] if version is None else version
        while uri not in self.shown or self.shown[uri][0] != version:
            self.receive()
        return self.shown[uri][1]

    def at(self, method, uri, line, character, **more):
        """Ask about a place."""
        position = {"line": line, "character": character}
        return self.request(f"textDocument/{method}", {"textDocument": {"uri": uri}, "position": position, **more})

    def stop(self):
        """Leave properly. Returns: the exit code of the server."""
        self.request("shutdown", None)
        return self.leave()

    def leave(self):
        self.notify("exit", None)
        return self.ended()

    def ended(self):
        code = self.wait(PATIENCE)
        for thread in self.threads:
            thread.join(PATIENCE)
        for stream in (self.stdin, self.stdout, self.stderr):
            stream.close()
        while (message := self.messages.get(timeout=PATIENCE)) is not None:
            assert not isinstance(message, Exception), message
        return code


def place(at):
    return {"line": at[0], "character": at[1]}


def shape(diagnostics):
    """The codes and first lines of diagnostics."""
    return [(d["code"], d["range"]["start"]["line"]) for d in diagnostics]


def applied(text, edits):
    """Make the edits of the protocol in a text; columns are in UTF-16."""
    lines = re.split(r"(?<=\n)", text)

    def offset(at):
        line = lines[at["line"]].encode("utf-16-le")
        return sum(map(len, lines[: at["line"]])) + len(line[: 2 * at["character"]].decode("utf-16-le"))

    for edit in sorted(edits, key=lambda e: -offset(e["range"]["start"])):
        start, end = (offset(edit["range"][side]) for side in ("start", "end"))
        text = text[:start] + edit["newText"] + text[end:]
    return text
