"""The command monitor: lines in, lines out, each before the next is read."""

import io
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from stlspec.cli import main, monitoring
from stlspec.cli.main import run

SPEC = """time step
signal d_obs in [0, inf]
signal d_goal
param T = 2
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually[0, T] (d_goal < 1)
"""
TIMED = 'time 100 ms\nsignal on : bool from "switch"\nhard stays: always[0, 200 ms] on\n'
SETUP = """
import sys
from stlspec.cli import main, monitoring
build = main.build
def with_monitor():
    app = build()
    if "monitor" not in [c.name for c in app.registered_commands]:
        app.command("monitor")(monitoring.monitor)
    return app
main.build = with_monitor
sys.exit(main.run(sys.argv[1:]))
"""

Run = Callable[..., tuple[int, list[str], str]]


@pytest.fixture
def spec(tmp_path: Path) -> str:
    path = tmp_path / "spec.stl"
    path.write_text(SPEC)
    return str(path)


@pytest.fixture
def monitored(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the command on some input; return exit code, lines on stdout, stderr."""
    build = main.build

    def with_monitor() -> object:
        app = build()
        if "monitor" not in [c.name for c in app.registered_commands]:
            app.command("monitor")(monitoring.monitor)
        return app

    monkeypatch.setattr(main, "build", with_monitor)

    def call(text: str | bytes, *words: str) -> tuple[int, list[str], str]:
        data = text.encode() if isinstance(text, str) else text
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))
        code = run(["monitor", *words])
        captured = capsys.readouterr()
        return code, captured.out.splitlines(), captured.err

    return call


def test_each_sample_gets_one_line_and_the_end_another(spec: str, monitored: Run) -> None:
    code, lines, err = monitored("d_obs,d_goal\n2,3\n1,0.5\n", spec)
    assert (code, err) == (0, "")
    assert lines == [
        "0: avoid undecided [-1, 1] now 1; reach undecided [-2, inf] now -2",
        "1: avoid undecided [-1, 0] now 0; reach satisfied [0.5, inf] now 0.5",
        "final: avoid satisfied 0; reach satisfied 0.5",
    ]


def test_json_lines_follow_the_contract(spec: str, monitored: Run) -> None:
    code, lines, _ = monitored('{"d_obs": "inf", "d_goal": 3}\n{"d_obs": 1, "d_goal": 0.5}\n', spec, "--format", "json")
    assert code == 0
    first, second, last = map(json.loads, lines)
    assert first == {
        "sample": 0,
        "time": 0.0,
        "requirements": {
            "avoid": {"low": -1.0, "high": "inf", "current": "inf", "verdict": "undecided"},
            "reach": {"low": -2.0, "high": "inf", "current": -2.0, "verdict": "undecided"},
        },
    }
    assert second["requirements"]["reach"]["verdict"] == "satisfied"
    assert last == {
        "final": True,
        "sample": 1,
        "time": 1.0,
        "requirements": {
            "avoid": {"robustness": 0.0, "verdict": "satisfied"},
            "reach": {"robustness": 0.5, "verdict": "satisfied"},
        },
    }


def test_every_gives_values_once_known_and_the_rest_at_the_end(spec: str, monitored: Run) -> None:
    text = "d_obs,d_goal\n2,3\n2,2\n2,1\n2,0\n"
    code, lines, err = monitored(text, spec, "--reading", "every", "--format", "json", "-p", "T=1")
    assert code == 0
    assert "'avoid' looks ahead without end" in err
    rows = [json.loads(line) for line in lines]
    reach = [(r["sample"], r["time"], r["robustness"], r["verdict"]) for r in rows if r["requirement"] == "reach"]
    assert reach == [
        (0, 0.0, -1.0, "violated"),
        (1, 1.0, 0.0, "violated"),
        (2, 2.0, 1.0, "satisfied"),
        (3, 3.0, 1.0, "satisfied"),
    ]
    assert [r["requirement"] for r in rows[:3]] == ["reach"] * 3
    assert [r["sample"] for r in rows[3:]] == [0, 1, 2, 3, 3]
    _, lines, _ = monitored(text, spec, "--reading", "every", "-p", "T=1")
    assert lines[0] == "0: reach violated -1"


def test_numbers_are_as_short_as_in_other_text_and_whole_in_json(spec: str, monitored: Run) -> None:
    data = "d_obs,d_goal\n1.3,0.7\n"  # 1.3 - 1 is 0.30000000000000004
    _, lines, _ = monitored(data, spec)
    assert lines[0].startswith("0: avoid undecided [-1, 0.3] now 0.3;") and lines[-1].startswith(
        "final: avoid satisfied 0.3;"
    )
    _, lines, _ = monitored(data, spec, "--format", "json")
    assert json.loads(lines[0])["requirements"]["avoid"]["high"] == 1.3 - 1
    _, lines, _ = monitored(data, spec, "--reading", "every")
    assert lines[0] == "0: avoid satisfied 0.3"


def test_time_stamps_booleans_and_sources(tmp_path: Path, monitored: Run) -> None:
    path = tmp_path / "timed.stl"
    path.write_text(TIMED)
    text = "time,switch,note\n5000,true,a\n5100,1,b\n\n5200,false,c\n"
    code, lines, _ = monitored(text, str(path), "--ends", "horizon")
    assert code == 0
    assert lines == [
        "0 at 5000: stays undecided [-inf, inf] now inf",
        "1 at 5100: stays undecided [-inf, inf] now inf",
        "2 at 5200: stays violated [-inf, -inf] now -inf",
        "final: stays violated -inf",
    ]


BAD = {
    "a ragged row": ("d_obs,d_goal\n1,2\n1\n", 3, "D890"),
    "no number": ("d_obs,d_goal\n1,2\nfast,2\n", 3, "D806"),
    "a hole": ("d_obs,d_goal\n1,2\n\n1,\n", 4, "D801"),
    "outside the range": ("d_obs,d_goal\n-1,2\n", 2, "D807"),
    "a missing signal": ("d_obs\n1\n", 2, "D804"),
    "a header of numbers": ("1,2\n1,2\n", 1, "D890"),
    "a column twice": ("x,x\n1,2\n", 1, "D890"),
    "an open quote": ('d_obs,d_goal\n"1,2\n', 2, "D890"),
    "broken JSON": ('{"d_obs": 1, "d_goal": 2}\n{"d_obs": 1,\n', 2, "D890"),
    "a JSON list": ('{"d_obs": 1, "d_goal": 2}\n[1, 2]\n', 2, "D890"),
    "null": ('{"d_obs": null, "d_goal": 2}\n', 1, "D806"),
    "NaN": ('{"d_obs": NaN, "d_goal": 2}\n', 1, "D801"),
    "a bomb of brackets": ('{"a": ' + "[" * 100_000 + "\n", 1, "D890"),
    "binary": (b"d_obs,d_goal\n\xff\xfe,1\n", 2, "D890"),
    "an endless line": (b"x" * (2**20 + 10), 1, "D890"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_line_ends_it_with_its_number(case: str, spec: str, monitored: Run) -> None:
    text, line, code = BAD[case]
    exit_code, _, err = monitored(text, spec)
    assert exit_code == 2
    assert f"error[{code}]" in err
    assert f"<stdin>:{line}" in err
    exit_code, lines, err = monitored(text, spec, "--format", "json")
    document = json.loads(lines[-1])
    assert (exit_code, document["schema"], document["exit"], err) == (2, "stlspec.error/1", 2, "")
    assert [(d["code"], d["file"], d["line"]) for d in document["diagnostics"]] == [(code, "<stdin>", line)]


def test_no_samples_are_an_error(spec: str, monitored: Run) -> None:
    for text in ("", "d_obs,d_goal\n"):
        code, lines, err = monitored(text, spec)
        assert (code, lines) == (2, [])
        assert "D803" in err


def test_a_bad_spec_is_a_line_of_json_too(monitored: Run) -> None:
    code, lines, _ = monitored("", "nowhere.stl", "--format", "json")
    assert code == 2
    assert [json.loads(line)["exit"] for line in lines] == [2]


def started(spec: str) -> "subprocess.Popen[str]":
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    command = [sys.executable, "-c", SETUP, "monitor", spec]
    return subprocess.Popen(command, **pipes, text=True, env={**os.environ, "PYTHONUNBUFFERED": ""})


def test_a_verdict_is_out_before_the_next_sample_is_read(spec: str) -> None:
    with started(spec) as process:
        assert process.stdin is not None and process.stdout is not None and process.stderr is not None
        process.stdin.write("d_obs,d_goal\n")
        for i in range(3):
            process.stdin.write("2,3\n")
            process.stdin.flush()
            assert process.stdout.readline().startswith(f"{i}: avoid undecided")
        process.send_signal(signal.SIGINT)
        assert process.wait() == 130
        assert "Traceback" not in process.stderr.read()


def test_a_reader_that_goes_is_no_error(spec: str) -> None:
    with started(spec) as process:
        assert process.stdin is not None and process.stdout is not None and process.stderr is not None
        process.stdin.write("d_obs,d_goal\n2,3\n")
        process.stdin.flush()
        process.stdout.readline()
        process.stdout.close()
        process.stdin.write("2,3\n" * 10)
        process.stdin.close()
        assert process.wait() == 0
        assert process.stderr.read() == ""
