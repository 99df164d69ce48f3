"""The command refuses what cannot be timed, and says so when stlspec itself fails."""

import json

import pytest

from tests.benchmarks import run
from tests.benchmarks.contest import Arena, Figure, OwnFailureError
from tests.benchmarks.peers.measuring import CoarseClockError
from tests.benchmarks.table import Section


@pytest.fixture
def little(monkeypatch):
    """Replace what takes long: installing, and timing the yardstick."""
    monkeypatch.setattr(run, "check_clock", lambda: 1e-6)
    monkeypatch.setattr(Arena, "install", lambda self, tools: None)
    monkeypatch.setattr(Arena, "contest", lambda self, jobs: {label: Figure(1e-9, 1e-9, 1e-9) for label in jobs})
    monkeypatch.setattr(run, "Data", FakeData)


class FakeData:
    long = ""

    def __init__(self, folder, longest):
        pass

    def job(self, tool, *_, **__):
        return tool, {}


def test_a_coarse_clock_is_refused(monkeypatch, capsys, tmp_path):
    def coarse():
        raise CoarseClockError("ticks in steps of 4 ms")

    monkeypatch.setattr(run, "check_clock", coarse)
    assert run.main(["--work", str(tmp_path)]) == 2
    assert capsys.readouterr().err == "refused: ticks in steps of 4 ms\n"


def test_the_table_is_printed_and_written(little, monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(run.PARTS, "memory", lambda arena, data: Section("memory", notes=["a note"]))
    out = tmp_path / "out.json"
    assert run.main(["--only", "memory", "--json", str(out), "--work", str(tmp_path)]) == 0
    titles = [section["title"] for section in json.loads(out.read_text())["sections"]]
    assert titles == ["np.minimum over n = 1e6, before", "memory", "np.minimum over n = 1e6, after"]
    assert "a note" in capsys.readouterr().out


def test_a_failure_of_stlspec_ends_the_run(little, monkeypatch, capsys, tmp_path):
    def fail(arena, data):
        raise OwnFailureError("it cannot")

    monkeypatch.setitem(run.PARTS, "memory", fail)
    assert run.main(["--only", "memory", "--work", str(tmp_path)]) == 1
    assert "stlspec fails: it cannot" in capsys.readouterr().err
