"""check, explain, compile and graph: what they print, in text and as JSON."""

import json
from pathlib import Path

import pytest

from stlspec.cli.main import run
from stlspec.errors import CATALOGUE

SPECS = Path(__file__).parents[2] / "specs"
GRID = str(SPECS / "grid_single_goal.stl")
BROKEN = "signal d\nhard a: always (d > 1\nhard b: always[5, 2] (d > 1)\nsoft c depends on a: d > 1\n"


def test_check_reports_all_files_in_one_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    broken = tmp_path / "broken.stl"
    broken.write_text(BROKEN)
    assert run(["check", GRID, str(broken), str(tmp_path / "missing.stl")]) == 2
    out = capsys.readouterr().out
    assert [code in out for code in ("S004", "I401", "S092")] == [True] * 3
    assert out.endswith("3 errors in 3 files\n")


def test_check_as_json_has_places_in_code_points_from_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    broken = tmp_path / "broken.stl"
    broken.write_text('signal d "ä"\nhard b: always[5, 2] (d > 1)\n')
    assert run(["check", str(broken), "--format", "json"]) == 1
    document = json.loads(capsys.readouterr().out)
    (found,) = document["diagnostics"]
    assert document["schema"] == "stlspec.check/1"
    assert (found["code"], found["severity"], found["file"]) == ("I401", "error", str(broken))
    assert (found["line"], found["column"], found["end_line"], found["end_column"]) == (2, 15, 2, 21)
    assert found["help"] == "write [2, 5]"


def test_check_accepts_unbound_params_and_warnings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "x.stl"
    spec.write_text("time 100 ms\nparam T\nsignal d\nhard a: always[0, 250 ms] (d > T)\n")
    assert run(["check", str(spec)]) == 0
    assert "warning[I403]" in capsys.readouterr().out


def test_explain_shows_both_examples_and_lists_all_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["explain", "i401"]) == 0
    out = capsys.readouterr().out
    assert "always[5, 2]" in out
    assert "always[2, 5]" in out
    assert run(["explain"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(CATALOGUE)
    assert run(["explain", "u3"]) == 0
    assert [line[:4] for line in capsys.readouterr().out.splitlines()] == [c for c in CATALOGUE if c.startswith("U3")]


def test_explain_suggests_the_nearest_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["explain", "I41"]) == 2
    assert "did you mean" in capsys.readouterr().err


def test_compile_writes_the_same_bytes_twice_and_bundles_work_where_specs_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, two = tmp_path / "1.stlb", tmp_path / "2.stlb"
    assert run(["compile", GRID, "-o", str(one)]) == 0
    assert run(["compile", GRID, "-o", str(two), "--format", "json"]) == 0
    assert one.read_bytes() == two.read_bytes()
    capsys.readouterr()
    assert run(["graph", str(one)]) == 0
    from_bundle = capsys.readouterr().out
    assert run(["graph", GRID]) == 0
    assert capsys.readouterr().out == from_bundle
    assert run(["graph", str(one), "-p", "T_goal=3"]) == 2
    assert "B705" in capsys.readouterr().err
    assert run(["check", str(one), "-p", "T_goal=3"]) == 2
    assert "B705" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("style", "pieces"),
    [
        ("text", ["hard avoid   3 → 0.665", "soft fast   1 → 0.090"]),
        ("mermaid", ["flowchart TD", "n_avoid --> n_reach", "n_reach --> n_fast"]),
        ("dot", ["digraph", '"avoid" -> "reach";']),
        ("json", ['"raw_weight": 3', '"stlspec.graph/1"']),
    ],
)
def test_graph_draws_weights_and_only_the_edges_that_matter(
    style: str, pieces: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["graph", GRID, "--format", style]) == 0
    out = capsys.readouterr().out
    assert [piece in out for piece in pieces] == [True] * len(pieces)
    assert "n_avoid --> n_fast" not in out
