"""Exit codes, one JSON document whatever happens, and never a traceback."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from stlspec.cli import data
from stlspec.cli.main import build, run
from stlspec.compiler import bundle_file, files
from stlspec.errors import CATALOGUE

SPECS = Path(__file__).parents[2] / "specs"
GRID = str(SPECS / "grid_single_goal.stl")
LAKE = str(SPECS / "frozenlake_4x4.stl")
LAKE_DEMOS = str(SPECS / "demos" / "frozenlake_4x4.jsonl")
CSV = "d_obs,d_goal\n2,1\n1,0\n"
MESH = "solid cube\n facet normal 0 0 1\n  outer loop\nendsolid\n"

TAMPERED = bundle_file.dump(files.read_spec(GRID)).replace(b'"value":10.0', b'"value":11.0')

BAD_INPUT = {
    "an empty spec": ("spec", b"", 1, "S016"),
    "a binary spec": ("spec", b"\x80\x81\x00\x01", 2, "S091"),
    "a NUL in a spec": ("spec", b"signal x\0\n", 2, "S091"),
    "a mesh": ("spec", MESH.encode(), 2, "S090"),
    "a spec with an error": ("spec", b"signal x\nhard a: always x\n", 1, "T201"),
    "a spec without requirements": ("spec", b"signal d_obs\n", 1, "G506"),
    "an unbound param": ("spec", b"param T\nsignal d_obs\nhard a: always[0, T] (d_obs > 0)\n", 2, "N106"),
    "a truncated bundle": ("bundle", b'{"schema": "stlspec.bundle/1", "lang', 2, "B701"),
    "a bundle of another version": ("bundle", b'{"schema": "stlspec.bundle/9"}', 2, "B702"),
    "a tampered bundle": ("bundle", TAMPERED, 2, "B703"),
    "an empty demonstration": ("demo", b"", 2, "D8"),
    "a binary demonstration": ("demo", b"\x80\x81\x00\x01", 2, "D8"),
    "a NaN": ("demo", b"d_obs,d_goal\n2,1\nnan,0\n", 2, "D801"),
    "a missing column": ("demo", b"d_goal\n1\n0\n", 2, "D804"),
    "unequal lengths": ("demo", b"d_obs,d_goal\n2,1\n1\n", 2, "D8"),
    "time going backwards": ("demo", b"time,d_obs,d_goal\n0,2,1\n2,1,1\n1,1,0\n", 2, "D802"),
}
SUFFIX = {"spec": "x.stl", "bundle": "x.stlb", "demo": "x.csv"}


def outcome(words: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    code = run(words)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.parametrize("case", BAD_INPUT)
def test_bad_input_gives_one_diagnostic_and_its_exit_code(
    case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kind, content, exit_code, code = BAD_INPUT[case]
    bad, demo = tmp_path / SUFFIX[kind], tmp_path / "demo.csv"
    bad.write_bytes(content)
    demo.write_text(CSV)
    words = ["score", str(bad), str(demo)] if kind != "demo" else ["score", GRID, str(bad)]
    got, out, err = outcome(words, capsys)
    assert got == exit_code
    assert out == ""
    assert err.count("error[") == 1
    assert f"error[{code}" in err
    assert "Traceback" not in err

    got, out, err = outcome([*words, "--format", "json"], capsys)
    document = json.loads(out)
    assert (got, document["schema"], document["exit"]) == (exit_code, "stlspec.error/1", exit_code)
    assert [d["code"].startswith(code) for d in document["diagnostics"]] == [True]
    assert err == ""


@pytest.mark.parametrize(
    ("words", "exit_code", "message"),
    [
        (["scor"], 2, "did you mean"),
        (["score"], 2, "missing argument"),
        (["score", GRID, "nowhere.csv"], 2, "nowhere.csv"),
        (["check", GRID, "--nonsense"], 2, "no such option"),
        (["check", "nowhere.stl"], 2, "no such file"),
        (["score", GRID, LAKE_DEMOS, "-p", "T_goal"], 2, "-p NAME=VALUE"),
        (["score", GRID, LAKE_DEMOS, "-p", "T_gaol=3"], 2, "did you mean `T_goal`"),
        (["score", GRID, LAKE_DEMOS, "-p", "T_goal=soon"], 2, "N108"),
        (["score", GRID, LAKE_DEMOS, "-p", "T_goal=-3"], 1, "I402"),
        (["score", GRID, LAKE_DEMOS, "--at", "999"], 2, "D880"),
        (["score", GRID, LAKE_DEMOS, "--map", "m.txt"], 2, "--env"),
        (["learn", LAKE, "--env", "Nowhere-v0", "--demos", LAKE_DEMOS, "--out", "o"], 2, "Nowhere-v0"),
        (["learn", LAKE, "--env", "FrozenLake-v1", "--out", "o"], 2, "--demos"),
        (["learn", LAKE, "--env", "MountainCar-v0", "--demos", LAKE_DEMOS, "--out", "o"], 2, "--bins 50,50"),
        (["learn", LAKE, "--env", "MountainCar-v0", "--bins", "5,x", "--demos", LAKE_DEMOS, "--out", "o"], 2, "5,x"),
        (["learn", LAKE, "--env", "FrozenLake-v1", "--bins", "5", "--demos", LAKE_DEMOS, "--out", "o"], 2, "--bins"),
        (["explain", "I999"], 2, "no code"),
        (["compile", GRID, "-o", "no/such/folder/x.stlb"], 2, "folder"),
    ],
)
def test_wrong_use_is_said_in_one_line_with_a_way_out(
    words: list[str],
    exit_code: int,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    code, out, err = outcome(words, capsys)
    assert code == exit_code
    assert message.lower() in (out + err).lower()
    assert "= help:" in out + err
    assert list(tmp_path.iterdir()) == []


def test_without_words_the_help_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    for words in ([], ["-h"], ["score", "-h"]):
        code, out, err = outcome(words, capsys)
        assert (code, err) == (0, "")
        assert out.startswith("Usage: stlspec")


def test_a_result_never_replaces_an_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec, demo = tmp_path / "x.stl", tmp_path / "x.jsonl"
    spec.write_text(Path(LAKE).read_text())
    demo.write_text(Path(LAKE_DEMOS).read_text())
    for words, precious in ((["compile", str(spec)], spec), (["reward", str(spec), str(demo)], demo)):
        before = precious.read_bytes()
        code, _, err = outcome([*words, "-o", str(precious)], capsys)
        assert (code, precious.read_bytes()) == (2, before)
        assert "is one of the inputs" in err


def test_a_terminal_without_the_signs_gets_substitutes() -> None:
    command = [sys.executable, "-m", "stlspec", "score", LAKE, LAKE_DEMOS]
    done = subprocess.run(command, capture_output=True, env={"PYTHONIOENCODING": "ascii"}, check=False)
    assert done.returncode == 0
    assert b"? 0" in done.stdout


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
def test_a_full_disk_is_no_fault_of_ours() -> None:
    command = f"{sys.executable} -m stlspec score {LAKE} {LAKE_DEMOS} --format json > /dev/full"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "S092" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_fault_of_ours_is_x901_without_a_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("impossible")

    monkeypatch.setattr(data, "environment_from", broken)
    code, _, err = outcome(["score", LAKE, LAKE_DEMOS], capsys)
    assert code == 3
    assert "error[X901]" in err
    assert "ZeroDivisionError" in err
    assert "Traceback" not in err


def test_ctrl_c_ends_with_130(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(data, "environment_from", interrupted)
    assert outcome(["score", LAKE, LAKE_DEMOS], capsys)[0] == 130
    code, out, err = outcome(["score", LAKE, LAKE_DEMOS, "--format", "json"], capsys)
    assert (code, err) == (130, "interrupted\n")
    assert json.loads(out) == {"schema": "stlspec.error/1", "exit": 130, "diagnostics": []}


def test_a_closed_pipe_is_no_error(tmp_path: Path) -> None:
    many = tmp_path / "many.jsonl"
    many.write_text(Path(LAKE_DEMOS).read_text() * 400)
    words = f"{sys.executable} -m stlspec score {LAKE} {many} --format json"
    command = f"{words} | head -1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "{\n", "")


def test_the_version_and_the_help_are_shown(capsys: pytest.CaptureFixture[str]) -> None:
    assert outcome(["--version"], capsys)[:2] == (0, "stlspec 0.1.0\n")
    code, out, _ = outcome(["--help"], capsys)
    assert code == 0
    for command in build().registered_commands:
        assert str(command.name) in out


def test_every_code_that_the_command_line_names_is_in_the_catalogue() -> None:
    assert {"D880", "X901", "N106", "B705"} <= CATALOGUE.keys()
