"""From beginning to end in a process of its own: what ends it, what remains, and that nothing is left running."""

import contextlib
import http.client
import json
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from stlspec.demos import load_demonstrations
from stlspec.envs.catalogue import make_environment
from stlspec.errors import UsageError
from stlspec.tools.record.recording import record

SPEC = "signal d_obs\nhard avoid: always (d_obs >= 1)\n"
MAP = "..G\n.#.\nS..\n"


class Started:
    """A recorder in a process of its own, and a page without a browser."""

    def __init__(self, folder: Path, *words: str, script: str = "") -> None:
        (folder / "spec.stl").write_text(SPEC)
        (folder / "map.txt").write_text(MAP)
        world = ["--env", "stlspec/GridWorld-v0", "--map", "map.txt", "-o", "out.jsonl"]
        command = ["-c", script] if script else ["-m", "stlspec", "record", "spec.stl", *world, *words]
        self.process = subprocess.Popen(
            [sys.executable, *command],
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.url = urlsplit(re.search(r"http://\S+", self.process.stderr.readline()).group(0))
        self.revision = 0

    def post(self, place: str, /, **request) -> dict:
        link = http.client.HTTPConnection(self.url.netloc, timeout=10)
        headers = {"Content-Type": "application/json", "Origin": f"http://{self.url.netloc}"}
        link.request("POST", self.url.path + place, json.dumps({**request, "revision": self.revision}), headers)
        found = json.loads(link.getresponse().read())
        link.close()
        self.revision = found.get("revision", self.revision)
        return found

    def end(self, *, within: float = 10.0) -> tuple[int, str, str]:
        out, err = self.process.communicate(timeout=within)
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection((self.url.hostname, self.url.port), timeout=2)
        return self.process.returncode, out, err


@pytest.fixture
def start(tmp_path: Path) -> Iterator:
    started: list[Started] = []

    def begin(*words: str, script: str = "") -> Started:
        started.append(Started(tmp_path, *words, script=script))
        return started[-1]

    yield begin
    for one in started:
        if one.process.poll() is None:
            one.process.kill()
            one.process.communicate()


def test_the_page_ends_it_and_the_account_is_a_document(start, tmp_path: Path) -> None:
    recorder = start("--format", "json")
    for action in (2, 2, 3):
        recorder.post("act", do="act", action=action)
    recorder.post("act", do="save", name="a")
    recorder.post("finish")
    code, out, _ = recorder.end()
    assert code == 0
    document = json.loads(out)
    assert document["schema"] == "stlspec.record/1"
    (row,) = document["demonstrations"]
    assert (row["name"], row["samples"], row["label"], row["rank"]) == ("a", 4, "good", 1)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_it_and_what_was_done_is_saved_and_said(start, tmp_path: Path, number: int) -> None:
    recorder = start()
    recorder.post("act", do="act", action=2)
    recorder.post("act", do="save", name="a")
    recorder.post("act", do="act", action=2)
    recorder.process.send_signal(number)
    code, _, err = recorder.end()
    assert code == 130
    assert "saved 2 demonstrations in out.jsonl: 'a', 'demo 2' ('demo 2' was unfinished)" in err
    assert [d.n_samples for d in load_demonstrations([tmp_path / "out.jsonl"])] == [2, 2]


IMPATIENT = """import sys
from pathlib import Path
from stlspec.envs.catalogue import make_environment
from stlspec.tools.record.recording import record
world = make_environment("stlspec/GridWorld-v0", None, Path("map.txt").read_text().split())
told = record(None, world, Path("out.jsonl"), patience=0.5, ready=lambda url: print(url, file=sys.stderr, flush=True))
print(told.account)
"""


def test_it_ends_some_time_after_its_page_was_closed(start, tmp_path: Path) -> None:
    recorder = start(script=IMPATIENT)
    recorder.post("act", do="act", action=2)
    with socket.create_connection((recorder.url.hostname, recorder.url.port)) as link:
        link.sendall(f"GET {recorder.url.path}events HTTP/1.1\r\nHost: {recorder.url.netloc}\r\n\r\n".encode())
        link.recv(100)
        time.sleep(1.2)
        assert recorder.process.poll() is None, "the page is still open"
    code, out, _ = recorder.end(within=20)
    assert code == 0
    assert "saved 1 demonstration in out.jsonl" in out


def test_a_kill_while_saving_leaves_a_whole_file(start, tmp_path: Path) -> None:
    """Save without a pause and kill at some moment; the file holds whole demonstrations, all that were confirmed."""
    (tmp_path / "out.jsonl").write_text('{"name": "old", "states": [[0, 0]]}\n')
    recorder = start()
    confirmed: list[str] = []

    def press() -> None:
        with contextlib.suppress(OSError, http.client.HTTPException):
            while True:
                recorder.post("act", do="act", action=2)
                name = f"d{len(confirmed)}"
                if not recorder.post("act", do="save", name=name)["refused"]:
                    confirmed.append(name)

    presser = threading.Thread(target=press)
    presser.start()
    time.sleep(1.0)
    recorder.process.kill()
    recorder.process.communicate()
    presser.join(10)
    names = [d.name for d in load_demonstrations([tmp_path / "out.jsonl"])]
    assert len(confirmed) > 3
    assert names[: len(confirmed) + 1] == ["old", *confirmed]
    assert len(names) <= len(confirmed) + 2, "one more may have been saved, but not confirmed"


def test_a_port_that_is_taken_is_told(tmp_path: Path) -> None:
    world = make_environment("FrozenLake-v1", {"is_slippery": False})
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(UsageError, match="D887") as caught:
            record(None, world, tmp_path / "a.jsonl", port=taken.getsockname()[1])
    assert "in use" in caught.value.diagnostics[0].message
    assert not list(tmp_path.iterdir())
