"""record: what is wrong is told before a page opens."""

from pathlib import Path

import pytest

from stlspec.cli.main import run

GRID = str(Path(__file__).parents[2] / "specs" / "grid_single_goal.stl")


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["--env", "stlspec/GridWorld-v0", "-o", "a.csv"], "D886"),
        (["--env", "Nowhere-v0", "-o", "a.jsonl"], "D820"),
        (["--env", "Pendulum-v1", "-o", "a.jsonl"], "D885"),
        (["--env", "stlspec/GridWorld-v0"], "D880"),
        (["-o", "a.jsonl"], "D880"),
        (["--env", "stlspec/GridWorld-v0", "-o", "a.jsonl", "--port", "70000"], "D880"),
        (["no_such.stl", "--env", "stlspec/GridWorld-v0", "-o", "a.jsonl"], "S092"),
        ([GRID, "--env", "MountainCar-v0", "-o", "a.jsonl", "-p", "T_goal=8"], "D804"),
    ],
)
def test_a_mistake_exits_with_2_and_writes_nothing(
    words: list[str], code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["record", *words]) == 2
    assert code in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
