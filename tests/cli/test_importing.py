"""import: text on stdout, differences on stderr, what cannot be carried with places and exit code 1."""

import json
from pathlib import Path

import pytest

from stlspec.cli.main import run


def imported(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    code = run(["import", *words])
    out, err = capsys.readouterr()
    return code, out, err


def test_a_spec_comes_out_on_stdout_and_checks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "spec.stl").write_text("signal x\nphi := alw_[0, 2] (x[t] == 1)\n")
    code, out, err = imported(capsys, str(tmp_path / "spec.stl"))
    assert code == 0 and "always[0, 2 s] (x == 1)" in out and "S042" in err
    (tmp_path / "out.stl").write_text(out)
    assert run(["check", str(tmp_path / "out.stl")]) == 0


def test_time_and_tool_can_be_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "spec.txt").write_text("always[0:2](x > 1)")
    assert "always[0, 2] (x > 1)" in imported(capsys, str(tmp_path / "spec.txt"), "--time", "step")[1]
    assert "time 50 ms" in imported(capsys, str(tmp_path / "spec.txt"), "--time", "50 ms")[1]
    assert imported(capsys, str(tmp_path / "spec.txt"), "--time", "soon")[0] == 2
    assert imported(capsys, str(tmp_path / "spec.txt"), "--from", "breach")[0] == 1


def test_what_cannot_be_carried_leaves_stdout_empty(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "spec.stl").write_text("phi := x[t+1] > 0\nmu := norm(x[t]) > 0\n")
    code, out, err = imported(capsys, str(tmp_path / "spec.stl"))
    assert (code, out) == (1, "") and err.count("error[S040]") == 2 and "spec.stl:2:7" in err


def test_the_document_holds_text_and_differences(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "spec.stl").write_text("phi := alw (x[t] > low)\n")
    code, out, err = imported(capsys, str(tmp_path / "spec.stl"), "--format", "json")
    document = json.loads(out)
    assert (code, err, document["schema"], document["from"]) == (0, "", "stlspec.import/1", "breach")
    assert "param low" in document["text"] and [d["code"] for d in document["diagnostics"]] == ["S042"]
    (tmp_path / "bad.stl").write_text("phi := x[t+1] > 0\n")
    code, out, _ = imported(capsys, str(tmp_path / "bad.stl"), "--format", "json")
    assert (code, json.loads(out)["schema"]) == (1, "stlspec.error/1")
