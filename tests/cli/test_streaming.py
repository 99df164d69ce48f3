"""The command score on stdin."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

SPEC = "signal x\nhard up: always (x > 0)\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "s.stl").write_text(SPEC)
    (tmp_path / "d.csv").write_text("x,y\n2,a\n1,b\n3,c\n")
    return tmp_path


def run(folder, *words, data=b""):
    command = [sys.executable, "-m", "stlspec", "score", "s.stl", *words]
    return subprocess.run(command, cwd=folder, input=data, capture_output=True)


def test_stdin_is_scored_as_the_file_is(folder):
    data = (folder / "d.csv").read_bytes()
    for words in (["--format", "json"], [], ["--format", "csv"], ["--require", "hard"]):
        whole, found = run(folder, "d.csv", *words), run(folder, "-", *words, data=data)
        assert found.returncode == whole.returncode == 0
        assert found.stdout.split() == whole.stdout.replace(b"d.csv", b"<stdin>").split()


def test_a_gate_fails_and_says_why(folder):
    found = run(folder, "-", "--require", "hard", data=b"x\n1\n-2\n")
    assert found.returncode == 1 and b"up fails at sample 1: x = -2, needs > 0" in found.stdout


@pytest.mark.parametrize(
    "words",
    [
        ["d.csv"],
        ["--explain"],
        ["--report", "r.html"],
        ["--plot", "p.png"],
        ["--jobs", "2"],
        ["--out", "r.jsonl"],
        ["--keep-going"],
        ["--at", "0"],
        ["--end", "interval"],
        ["--resample", "1s"],
        ["--env", "MountainCar-v0"],
    ],
)
def test_what_one_pass_cannot_serve_is_refused(folder, words):
    found = run(folder, "-", *words, data=b"x\n1\n")
    assert found.returncode == 2 and found.stderr.count(b"error[D880]") == 1
    assert sorted(p.name for p in folder.iterdir()) == ["d.csv", "s.stl"]


@pytest.mark.parametrize(
    ("data", "code"),
    [(b"", "D833"), (b"1\n2\n", "D835"), (b"x\n1\n2,3\n", "D834"), (b"y\n1\n", "D804"), (b"x\n1\nfast\n", "D806")],
)
def test_a_broken_stream_gives_one_diagnostic(folder, data, code):
    found = run(folder, "-", data=data)
    assert found.returncode == 2 and found.stderr.count(b"error[") == 1 and code.encode() in found.stderr
    told = json.loads(run(folder, "-", "--format", "json", data=data).stdout)
    assert [d["code"] for d in told["diagnostics"]] == [code]


def test_ctrl_c_ends_it(folder):
    command = [sys.executable, "-m", "stlspec", "score", "s.stl", "-"]
    with subprocess.Popen(command, cwd=folder, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdin.write(b"x\n" + b"1\n" * 3_000_000)  # it reads once the pipe is full, so it has begun
        process.stdin.flush()
        time.sleep(0.1)
        os.kill(process.pid, signal.SIGINT)
        assert process.wait(timeout=20) == 130
        assert process.stderr.read() == b"interrupted\n"
