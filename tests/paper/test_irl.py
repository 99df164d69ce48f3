"""What comes back from the baseline's process is checked; whatever goes wrong there is a result that says so."""

import json
import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest

from stlspec.documents import DamageError
from stlspec.paper import irl
from stlspec.paper.cases import case_of
from stlspec.paper.irl import SCHEMA, IrlResult, ask, measure, read_answer
from stlspec.paper.tabular import make_tabular

GOOD = {
    "schema": SCHEMA, "versions": {"imitation": "1.0.1"}, "steps": 3, "seconds": 2.5, "step_seconds": 0.8,
    "gradient": 0.1, "gap": 0.2, "ended": "steps", "reward": [0.5] * 16,
}  # fmt: skip


@pytest.fixture(scope="module")
def tabular():
    case = case_of("lake-4")
    return make_tabular(case.bundle(), case.environment(), case.experts(3))


@pytest.fixture
def ready(monkeypatch):
    """This interpreter stands in for that of the baseline."""
    monkeypatch.setattr(irl, "find", lambda *_: sys.executable)


def script(folder, body):
    path = folder / "script.py"
    path.write_text("import json, os, sys, time\n" + textwrap.dedent(body))
    return path


def replying(folder, answer):
    return script(folder, f"open(sys.argv[2], 'w').write({answer!r})")


def test_an_answer_is_read_as_it_was_written(tabular, tmp_path):
    found = ask(sys.executable, tabular, steps=3, seconds=1, script=replying(tmp_path, json.dumps(GOOD)))
    assert found.reward == (0.5,) * 16
    assert (found.steps, found.seconds, found.step_seconds, found.ended) == (3, 2.5, 0.8, "steps")
    assert found.versions == (("imitation", "1.0.1"),)


def test_the_tables_arrive_as_they_are(tabular, tmp_path):
    echo = f"""
        import numpy as np
        problem = dict(np.load(sys.argv[1], allow_pickle=False))
        good = json.loads({json.dumps(GOOD)!r})
        good["reward"] = [float(x) for x in problem["visits"]]
        good["gap"] = float(problem["probabilities"].sum()) + int(problem["horizon"])
        good["steps"] = int(problem["steps"])
        json.dump(good, open(sys.argv[2], "w"))
    """
    found = ask(sys.executable, tabular, steps=2, seconds=1, script=script(tmp_path, echo))
    assert found.reward == tuple(tabular.visits)
    assert found.gap == tabular.probabilities.sum() + tabular.horizon
    assert found.steps == 2


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"schema": "other/1"}, "schema"),
        ({"reward": [0.5] * 15}, "16 finite numbers"),
        ({"reward": [float("nan")] * 16}, "16 finite numbers"),
        ({"reward": [10**400] * 16}, "16 finite numbers"),
        ({"reward": ["1"] * 16}, "16 finite numbers"),
        ({"reward": None}, "16 finite numbers"),
        ({"steps": 0}, "from 1 to 3"),
        ({"steps": 4}, "from 1 to 3"),
        ({"steps": True}, "from 1 to 3"),
        ({"seconds": -1}, "'seconds'"),
        ({"step_seconds": float("inf")}, "'step_seconds'"),
        ({"gradient": "0"}, "'gradient'"),
        ({"gap": [0]}, "'gap'"),
        ({"ended": "never"}, "'ended'"),
        ({"ended": ["steps"]}, "'ended'"),
        ({"versions": ["1"]}, "'versions'"),
        ({"versions": {"a": 1}}, "'versions'"),
    ],
)
def test_a_hostile_answer_is_refused(tmp_path, change, problem):
    path = tmp_path / "answer.json"
    path.write_text(json.dumps(GOOD | change))
    with pytest.raises(DamageError, match=problem):
        read_answer(path, 16, 3)


@pytest.mark.parametrize("text", ["", "{", "[]", "\x00", "[" * 100_000])
def test_what_is_no_answer_at_all_is_refused(tabular, tmp_path, text):
    with pytest.raises(DamageError):
        ask(sys.executable, tabular, steps=3, seconds=1, script=replying(tmp_path, text))


def test_no_answer_and_too_large_an_answer_are_refused(tabular, tmp_path, monkeypatch):
    with pytest.raises(DamageError, match="No such file"):
        ask(sys.executable, tabular, steps=3, seconds=1, script=script(tmp_path, "pass"))
    monkeypatch.setattr(irl, "_LARGEST_ANSWER", 100)
    with pytest.raises(DamageError, match="larger than 100 bytes"):
        ask(sys.executable, tabular, steps=3, seconds=1, script=replying(tmp_path, json.dumps(GOOD)))


def test_a_process_that_fails_is_quoted_by_its_last_line(tabular, tmp_path):
    failing = script(tmp_path, "print('x' * 10**6, file=sys.stderr)\nsys.exit('no \\x1b[31mmodule')")
    with pytest.raises(DamageError, match=r"failed: no \[31mmodule$"):
        ask(sys.executable, tabular, steps=3, seconds=1, script=failing)


def test_a_process_that_takes_too_long_is_killed(tabular, tmp_path):
    slow = script(tmp_path, f"open({str(tmp_path / 'pid')!r}, 'w').write(str(os.getpid()))\ntime.sleep(60)")
    began = time.perf_counter()
    with pytest.raises(DamageError, match="longer than 2 s"):
        ask(sys.executable, tabular, steps=3, seconds=1, limit=2, script=slow)
    assert time.perf_counter() - began < 20
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


@pytest.mark.skipif(os.name == "nt", reason="SIGKILL")
def test_killing_us_closes_the_input_of_the_process(tabular, tmp_path):
    waiting = script(
        tmp_path,
        f"""
        open({str(tmp_path / "ready")!r}, "w").close()
        while os.read(0, 1): pass
        open({str(tmp_path / "ended")!r}, "w").close()
        """,
    )
    caller = subprocess.Popen(
        [sys.executable, "-c",
         "import sys\nfrom pathlib import Path\nfrom stlspec.paper.irl import ask\n"
         "from stlspec.paper.tabular import make_tabular\nfrom stlspec.paper.cases import case_of\n"
         "c = case_of('lake-4')\nt = make_tabular(c.bundle(), c.environment(), c.experts(1))\n"
         f"ask(sys.executable, t, steps=3, seconds=60, script=Path({str(waiting)!r}))"]
    )  # fmt: skip
    wait_for(tmp_path / "ready")
    caller.send_signal(signal.SIGKILL)
    caller.wait()
    wait_for(tmp_path / "ended")


def wait_for(path):
    end = time.perf_counter() + 60
    while not path.exists():
        assert time.perf_counter() < end, f"{path.name} did not come"
        time.sleep(0.05)


def test_without_the_libraries_the_result_says_how_to_get_them(tmp_path):
    found = measure(case_of("lake-4"), case_of("lake-4").experts(2), folder=tmp_path)
    assert "python -m stlspec.paper.libraries" in found.skipped
    assert found.reward is None


def test_two_goals_are_skipped_with_the_reason(ready):
    case = case_of("two-goal-5")
    assert "the spec has 2" in measure(case, case.experts(2)).skipped


def test_a_failing_process_is_a_skipped_row(ready, monkeypatch, tmp_path):
    monkeypatch.setattr(irl, "SCRIPT", script(tmp_path, "sys.exit('broken')"))
    found = measure(case_of("lake-4"), case_of("lake-4").experts(2))
    assert found.skipped == "the process of MCE-IRL failed: broken"


@pytest.mark.parametrize(
    ("answer", "iterations", "seconds", "extrapolated", "note"),
    [
        ({}, 3, 2.5, False, "all 3 gradient steps taken, not converged (visits differ by up to 0.2)"),
        ({}, 1000, 800.0, True, "3 gradient steps timed, extrapolated to 1,000"),
        ({"ended": "converged"}, 1000, 2.5, False, "converged after 3 gradient steps"),
        ({"ended": "seconds", "steps": 2}, 10, 8.0, True, "2 gradient steps timed, extrapolated to 10"),
    ],
)
def test_times_are_measured_or_said_to_be_extrapolated(
    ready, monkeypatch, tmp_path, answer, iterations, seconds, extrapolated, note
):
    monkeypatch.setattr(irl, "SCRIPT", replying(tmp_path, json.dumps(GOOD | answer)))
    found = measure(case_of("lake-4"), case_of("lake-4").experts(2), iterations=iterations)
    assert (found.seconds, found.extrapolated, found.note) == (seconds, extrapolated, note)
    assert (found.reward is None) == extrapolated
    assert (found.n_states, found.horizon, found.demonstrations) == (16, 12, 2)


def test_large_tasks_are_timed_for_three_steps_and_huge_ones_in_sparse_form(ready, monkeypatch):
    asked = []

    def refuse(python, tabular, **options):
        asked.append(options)
        raise DamageError("enough")

    monkeypatch.setattr(irl, "ask", refuse)
    case = case_of("car-50")
    measure(case, case.experts(1))
    monkeypatch.setattr(irl, "MOST_DENSE", 10**6)
    measure(case, case.experts(1), steps=20)
    measure(case_of("lake-4"), case_of("lake-4").experts(1))
    assert [(o["steps"], o["sparse"]) for o in asked] == [(3, False), (20, True), (1000, False)]


def test_a_result_is_plain_json():
    found = IrlResult(None, reward=(0.5, 1.0), versions=(("torch", "2"),))
    assert json.loads(json.dumps(found.to_json(), allow_nan=False))["versions"] == {"torch": "2"}
