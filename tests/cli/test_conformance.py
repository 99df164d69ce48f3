"""conform: what it prints, in text and as JSON, and its exit codes."""

import json
from pathlib import Path
from typing import Any

import pytest
import typer

from stlspec.cli.conformance import conform
from stlspec.cli.output import Format
from stlspec.errors import DataError

VECTORS = Path(__file__).parents[1] / "conformance" / "vectors.json"


def conformed(file: Path, output: Format = Format.TEXT) -> int:
    with pytest.raises(typer.Exit) as stop:
        conform(file, output)
    return stop.value.exit_code


def spoiled(path: Path, **changes: Any) -> Path:
    document = json.loads(VECTORS.read_text())
    document["vectors"][0].update(changes)
    path.write_text(json.dumps(document))
    return path


def test_the_vectors_of_the_project_hold(capsys: pytest.CaptureFixture[str]) -> None:
    assert conformed(VECTORS) == 0
    count = len(json.loads(VECTORS.read_text())["vectors"])
    assert capsys.readouterr().out == f"{count} of {count} vectors hold\n"


def test_a_failure_is_shown_with_what_was_expected_and_what_came(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert conformed(spoiled(tmp_path / "v.json", expected=5)) == 1
    out = capsys.readouterr().out
    assert out.startswith("p01: expected 5 (satisfied), got 2 (satisfied)\n    x >= 1, at sample 0\n")
    assert out.endswith(" vectors hold\n")


def test_an_error_that_nobody_expected_is_shown_with_its_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert conformed(spoiled(tmp_path / "v.json", at=99)) == 1
    assert "p01: expected 2 (satisfied), got error D880: " in capsys.readouterr().out


def test_the_document_holds_the_failures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert conformed(spoiled(tmp_path / "v.json", expected="-inf"), Format.JSON) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "stlspec.conform/1"
    assert document["vectors"] == document["held"] + 1
    assert document["failures"] == [
        {
            "id": "p01",
            "formula": "x >= 1",
            "at": 0,
            "expected": {"robustness": "-inf", "verdict": "satisfied"},
            "got": {"robustness": 2.0, "verdict": "satisfied", "errors": []},
        }
    ]


def test_a_file_of_another_kind_is_refused() -> None:
    with pytest.raises(DataError) as caught:
        conform(Path(__file__), Format.TEXT)
    assert caught.value.exit_code == 2
