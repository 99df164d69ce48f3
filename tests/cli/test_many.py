"""The command score for many files."""

import json
import subprocess
import sys

import pytest

from stlspec.cli.many import expanded
from stlspec.errors import UsageError

SPEC = "signal x\nhard up: always (x > 0)\n"


def run(folder, *words):
    command = [sys.executable, "-m", "stlspec", "score", "s.stl", *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "s.stl").write_text(SPEC)
    for number in range(4):
        (tmp_path / f"d{number}.csv").write_text(f"x\n{number}\n{number + 1}\n")
    return tmp_path


def test_patterns_are_expanded_in_order_and_empty_ones_refused(folder, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "odd[1].csv").write_text("x\n1\n")
    assert expanded(["d*.csv"]) == ["d0.csv", "d1.csv", "d2.csv", "d3.csv"]
    assert expanded(["d3.csv", "odd[1].csv", "minari:a*"]) == ["d3.csv", "odd[1].csv", "minari:a*"]
    with pytest.raises(UsageError, match="no file matches"):
        expanded(["e*.csv"])


def test_jobs_change_nothing_but_who_works(folder):
    alone = run(folder, "d*.csv", "--format", "json")
    assert run(folder, "d*.csv", "--format", "json", "--jobs", "2").stdout == alone.stdout
    assert json.loads(alone.stdout)["demonstrations"][3]["rank"] == 4


def test_bad_files_are_left_out_and_told(folder):
    (folder / "bad.csv").write_text("x\nfast\n")
    found = run(folder, "bad.csv", "d1.csv", "--keep-going", "--out", "r.jsonl")
    assert found.returncode == 1
    assert "D806" in found.stderr
    assert "r.jsonl: 1 demonstration of 2 files; 1 file left out" in found.stdout
    assert json.loads((folder / "r.jsonl").read_text())["name"] == "d1.csv"
    assert run(folder, "bad.csv", "d1.csv", "--out", "r2.jsonl").returncode == 2


@pytest.mark.parametrize(
    "words",
    [
        ["--jobs", "2", "--explain"],
        ["--out", "r.jsonl", "--require", "hard"],
        ["--address", "here:1"],
        ["--out", "r.txt"],
        ["--out", "d0.csv"],
        ["--jobs", "0"],
        ["--jobs", "257"],
        ["--jobs", "99999999999999999999"],
        ["--resample", "fast"],
    ],
)
def test_options_that_do_not_go_together_are_one_diagnostic(folder, words):
    found = run(folder, "d0.csv", *words, "--format", "json")
    assert found.returncode == 2
    assert len(json.loads(found.stdout)["diagnostics"]) == 1


def test_samples_can_be_taken_again(folder):
    (folder / "s.stl").write_text("time s\nsignal x\nhard up: always (x > 0)\n")
    (folder / "log.csv").write_text("time,x\n0,1\n0.35,\n1,-1\n")
    refused = run(folder, "log.csv", "--resample", "100ms")
    assert (refused.returncode, "D801" in refused.stderr) == (2, True)
    found = run(folder, "log.csv", "--resample", "100ms", "--on-nan", "hold", "--format", "json")
    (row,) = json.loads(found.stdout)["demonstrations"]
    assert row["requirements"]["up"]["witness"] == {"sample": 10, "time": 1.0}
