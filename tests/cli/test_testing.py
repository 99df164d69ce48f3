"""test: what it prints, in text and as JSON, and its exit codes."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from stlspec.cli.main import run

SPEC = "signal d\nhard safe: always (d >= 1)\nexpect safe holds on {d: [2, 1]}\n"
NUMBER = {"type": ["number", "string"]}
PLACE = {"type": ["integer", "null"]}
DIAGNOSTIC = {
    "type": "object",
    "required": ["code", "severity", "message", "file", "line", "column", "end_line", "end_column", "help", "labels"],
    "properties": {"line": PLACE, "column": PLACE},
}
CASE = {
    "type": "object",
    "required": ["demonstration", "met", "what"],
    "properties": {
        "demonstration": {"type": "string"},
        "met": {"type": "boolean"},
        "verdict": {"enum": ["satisfied", "violated"]},
        "robustness": NUMBER,
        "margin": NUMBER,
        "label": {"enum": ["good", "incomplete", "bad"]},
        "witness": {"type": ["object", "null"], "required": ["sample", "time"]},
    },
}
EXPECTATION = {
    "type": "object",
    "additionalProperties": False,
    "required": ["line", "column", "text", "result", "cases", "diagnostics"],
    "properties": {
        "line": {"type": "integer", "minimum": 1},
        "column": {"type": "integer", "minimum": 1},
        "text": {"type": "string"},
        "result": {"enum": ["met", "not met", "not run"]},
        "cases": {"type": "array", "items": CASE},
        "diagnostics": {"type": "array", "items": DIAGNOSTIC},
    },
}
SCHEMA: dict[str, Any] = {
    "type": "object",
    "additionalProperties": False,
    "required": ["schema", "exit", "files", "summary"],
    "properties": {
        "schema": {"const": "stlspec.test/1"},
        "exit": {"enum": [0, 1, 2]},
        "files": {
            "type": "array",
            "items": {
                "type": "object",
                "additionalProperties": False,
                "required": ["file", "expectations", "diagnostics"],
                "properties": {
                    "file": {"type": "string"},
                    "expectations": {"type": "array", "items": EXPECTATION},
                    "diagnostics": {"type": "array", "items": DIAGNOSTIC},
                },
            },
        },
        "summary": {
            "type": "object",
            "additionalProperties": False,
            "required": ["met", "not_met", "not_run"],
            "properties": {key: {"type": "integer"} for key in ("met", "not_met", "not_run")},
        },
    },
}


def outcome(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    code = run(["test", *words])
    out, err = capsys.readouterr()
    return code, out, err


@pytest.mark.parametrize(
    ("more", "exit_code", "last"),
    [
        ("", 0, "1 expectation: 1 met"),
        ("expect safe fails on {d: [2]}\n", 1, "2 expectations: 1 met, 1 not met"),
        ('expect safe fails on "none.csv"\n', 2, "2 expectations: 1 met, 1 not run"),
    ],
)
def test_the_exit_code_says_whether_all_are_met(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: str, exit_code: int, last: str
) -> None:
    (tmp_path / "t.stl").write_text(SPEC + more)
    code, out, err = outcome(capsys, str(tmp_path / "t.stl"))
    assert (code, err) == (exit_code, "")
    assert out.splitlines()[-1] == last
    assert out.startswith("✓ ") and "t.stl:3: expect safe holds on {d: [2, 1]}" in out


def test_what_is_not_met_is_shown_with_its_margin(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "t.stl").write_text(SPEC.replace("[2, 1]", "[2, 0]"))
    code, out, _ = outcome(capsys, str(tmp_path / "t.stl"))
    assert code == 1
    assert "✗ " in out and "safe fails with margin 1, and was expected to hold" in out
    assert "d = 0, needs >= 1, at sample 1" in out


def test_the_document_follows_its_schema_whatever_happens(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "good.stl").write_text(SPEC + "expect safe holds on {d: [inf, inf]}\n")
    (tmp_path / "d.csv").write_text("d\n3\n")
    more = 'expect safe fails on {d: [2]}\nexpect "d.csv" is bad\nexpect "d.csv" outranks "d.csv"\n'
    more += 'expect "no.csv" is bad\n'
    (tmp_path / "mixed.stl").write_text(SPEC + more)
    (tmp_path / "broken.stl").write_text("hard safe: d > 1\n")
    names = [str(tmp_path / name) for name in ("good.stl", "mixed.stl", "broken.stl", "none.stl")]
    for files, exit_code in ((names[:1], 0), (names[:2], 2), (names[2:3], 1), (names, 2)):
        code, out, err = outcome(capsys, *files, "--format", "json")
        document = json.loads(out)
        jsonschema.validate(document, SCHEMA)
        assert (code, document["exit"], err) == (exit_code, exit_code, "")
    assert document["summary"] == {"met": 3, "not_met": 3, "not_run": 1}
    assert [len(entry["diagnostics"]) for entry in document["files"]] == [0, 0, 1, 1]


def test_a_file_without_expectations_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "t.stl").write_text("signal d\nhard safe: d > 1\n")
    assert outcome(capsys, str(tmp_path / "t.stl")) == (0, "1 file without an `expect` statement\n", "")


def test_errors_of_one_spec_leave_the_others_to_be_tested(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.stl").write_text("hard safe: d > 1\n")
    (tmp_path / "b.stl").write_text(SPEC)
    code, out, err = outcome(capsys, str(tmp_path / "a.stl"), str(tmp_path / "b.stl"))
    assert code == 1 and "N101" in err and out.splitlines()[-1] == "1 expectation: 1 met"


def test_params_and_environments_are_those_of_score(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "t.stl").write_text(
        'signal d_obs\nparam far\nhard safe: always (d_obs >= far)\nexpect safe holds on "s.json"\n'
    )
    (tmp_path / "s.json").write_text('{"schema": "stlspec.demo/1", "states": [[0, 0]]}')
    (tmp_path / "m.txt").write_text("S.#\n..G\n")
    words = [str(tmp_path / "t.stl"), "--env", "stlspec/GridWorld-v0", "--map", str(tmp_path / "m.txt")]
    assert outcome(capsys, *words, "-p", "far=2")[0] == 0
    assert outcome(capsys, *words, "-p", "far=3")[0] == 1
    assert outcome(capsys, *words)[0] == 2
