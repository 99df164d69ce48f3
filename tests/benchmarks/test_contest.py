"""Contestants are timed in turn; one that fails or hangs is reported and does not stop the others."""

import sys

import numpy as np
import pytest

from tests.benchmarks import contest
from tests.benchmarks.contest import Arena, Figure, OutOfTimeError, OwnFailureError, Worker

DRIVER = """
import json, sys, time
print(json.dumps({"version": "7"}), flush=True)
job = None
for line in sys.stdin:
    request = json.loads(line)
    if "prepare" in request:
        job = request["prepare"]
        answer = {"error": "no such formula"} if job.get("broken") else {"ready": True}
    elif "values" in request:
        answer = {"values": [job["seconds"]]}
    else:
        if job.get("dies"):
            sys.exit(3)
        time.sleep(60 if job.get("hangs") else 0)
        answer = {"seconds": job["seconds"]}
    print(json.dumps(answer), flush=True)
"""


@pytest.fixture
def arena(monkeypatch, tmp_path):
    """An arena whose contestants all run the little driver above."""
    (tmp_path / "with_tool.py").write_text(DRIVER)
    (tmp_path / "with_stlspec.py").write_text(DRIVER)
    monkeypatch.setattr(contest, "PEERS", tmp_path)
    found = Arena(tmp_path, quick=True, patience=5.0)
    monkeypatch.setattr(Arena, "worker", lambda self, tool: Worker(tool, sys.executable))
    return found


def test_a_figure_is_the_median_with_both_ends():
    assert Figure.of([3.0, 1.0, 2.0]) == Figure(2.0, 1.0, 3.0)


def test_every_contestant_gets_a_figure_and_its_version_is_kept(arena):
    figures = arena.contest({"a": ("tool", {"seconds": 2.0}), "b": ("stlspec", {"seconds": 4.0})})
    assert figures == {"a": Figure(2.0, 2.0, 2.0, (2.0,)), "b": Figure(4.0, 4.0, 4.0, (4.0,))}
    assert arena.versions == {"tool": "7", "stlspec": "7"}


@pytest.mark.parametrize(
    ("trouble", "told"),
    [({"broken": True}, "no such formula"), ({"dies": True}, "the process ended"), ({"hangs": True}, "no answer")],
)
def test_a_peer_in_trouble_is_told_and_the_others_go_on(arena, trouble, told):
    arena.patience = 1.0
    figures = arena.contest({"bad": ("tool", {"seconds": 1.0, **trouble}), "good": ("tool", {"seconds": 1.0})})
    assert told in figures["bad"].error
    assert figures["good"].median == 1.0


def test_a_peer_that_is_not_installed_is_told(arena):
    arena.missing["tool"] = "no compiler"
    assert arena.contest({"a": ("tool", {})})["a"].error == "not installed: no compiler"


def test_a_failure_of_stlspec_is_never_hidden(arena):
    with pytest.raises(OwnFailureError, match="no such formula"):
        arena.contest({"own": ("stlspec", {"broken": True})})


def test_a_worker_that_does_not_answer_is_ended(arena):
    worker = Worker("tool", sys.executable)
    worker.ask({"prepare": {"seconds": 1.0, "hangs": True}}, 5.0)
    with pytest.raises(OutOfTimeError):
        worker.ask({"measure": 0.0}, 0.1)
    assert worker.ask({"prepare": {"seconds": 1.0}}, 5.0) == {"ready": True}
    worker.stop()


def test_the_driver_of_stlspec_times_whole_calls(tmp_path):
    data = tmp_path / "data.npz"
    np.savez(data, x=np.array([1.0, 3.0, 2.0, 0.5]), y=np.zeros(4))
    job = {"kind": "trace", "texts": ["always[0, 2] (x >= 0)"], "data": str(data), "n": 4}
    worker = Worker("stlspec", sys.executable)
    try:
        for kind in ("trace", "every", "start", "pending", "minimum", "nothing"):
            assert worker.ask({"prepare": {**job, "kind": kind, "warm": 5}}, 30.0) == {"ready": True}
            assert 0 < worker.ask({"measure": 0.0}, 30.0)["seconds"] < 1
        worker.ask({"prepare": job}, 30.0)
        assert worker.ask({"values": True}, 30.0)["values"] == [1.0]
        (tail,) = worker.ask({"count": 20, "quantiles": [0.99]}, 30.0)["seconds"]
        assert 0 <= tail < 1
        with pytest.raises(RuntimeError, match="SpecError"):
            worker.ask({"prepare": {**job, "texts": ["always (x >"]}}, 30.0)
    finally:
        worker.stop()
