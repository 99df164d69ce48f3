"""score, reward and eval: tables, documents and gates."""

import csv
import io
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from stlspec.cli.main import run

SPECS = Path(__file__).parents[2] / "specs"
GRID = str(SPECS / "grid_single_goal.stl")
DEMOS = str(SPECS / "demos" / "grid_5x5.jsonl")
GOOD = "d_obs,d_goal\n2,3\n1,2\n1,1\n2,0\n"
BAD = "d_obs,d_goal\n2,3\n1,2\n3,1\n0,0\n"


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    good, bad = tmp_path / "good.csv", tmp_path / "bad.csv"
    good.write_text(GOOD)
    bad.write_text(BAD)
    return [str(good), str(bad)]


def test_the_table_gives_the_reason_for_each_failure(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["score", GRID, *files]) == 0
    out = capsys.readouterr().out
    assert f"{files[1]}: avoid fails at sample 3: d_obs = 0, needs >= 1" in out
    assert out.index(files[0]) < out.index(files[1])


def test_the_document_follows_the_contract(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["score", GRID, *files, "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "stlspec.score/1"
    assert [r["raw_weight"] for r in document["requirements"]] == [3, 2, 1]
    good, bad = document["demonstrations"]
    assert (good["label"], good["rank"], bad["label"], bad["rank"]) == ("good", 2, "bad", 1)
    assert bad["requirements"]["avoid"]["witness"] == {"sample": 3, "time": 3.0}
    assert good["requirements"]["avoid"] == {
        "robustness": 0.0,
        "bounded": 0.0,
        "verdict": "satisfied",
        "vacuous": False,
        "witness": {"sample": 1, "time": 1.0},
    }


def test_at_gives_the_values_of_one_sample(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["score", GRID, files[0], "--at", "-1", "--format", "json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["demonstrations"]
    assert row.keys() == {"name", "requirements"}
    assert row["requirements"]["avoid"]["robustness"] == 1.0


def test_csv_has_a_row_for_each_requirement(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["score", GRID, *files, "--format", "csv"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert len(rows) == 6
    assert rows[3]["requirement"] == "avoid"
    assert float(rows[3]["robustness"]) == -1.0


@pytest.mark.parametrize(
    ("which", "gate", "params", "expected"),
    [
        (0, "hard", [], 0),
        (0, "all", [], 0),
        (0, "all", ["-p", "T_goal=2"], 1),
        (0, "hard", ["-p", "T_goal=2"], 0),
        (1, "hard", [], 1),
    ],
)
def test_a_gate_turns_a_failure_into_exit_1(
    files: list[str],
    which: int,
    gate: str,
    params: list[str],
    expected: int,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(["score", GRID, files[which], "--require", gate, *params]) == expected
    assert ("1 of 1 demonstration failed" in capsys.readouterr().err) == bool(expected)


def test_strict_refuses_what_ends_before_the_horizon(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["score", GRID, files[0], "--end", "strict"]) == 2
    assert "D809" in capsys.readouterr().err
    assert run(["score", GRID, files[0], "--end", "strict", "-p", "T_goal=3"]) == 0


def test_nan_is_held_or_dropped_on_demand(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "log.csv"
    log.write_text("d_obs,d_goal\n2,3\nnan,2\n1,0\n")
    assert run(["score", GRID, str(log)]) == 2
    assert "signal 'd_obs' is NaN at sample 1" in capsys.readouterr().err
    assert run(["score", GRID, str(log), "--on-nan", "hold"]) == 0
    assert run(["score", GRID, str(log), "--on-nan", "drop"]) == 0


def test_reward_writes_the_map(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "R.json"
    assert run(["reward", GRID, DEMOS, "-o", str(out)]) == 0
    document = json.loads(out.read_text())
    assert document["schema"] == "stlspec.reward/1"
    values = dict(zip(map(tuple, document["states"]), document["values"], strict=True))
    assert max(map(abs, values.values())) == 1.0
    assert values[(0, 4)] > 0 > values[(3, 1)]
    assert "states with a reward" in capsys.readouterr().out


def test_eval_needs_no_spec_and_exits_with_1_if_violated(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["eval", "G (d_obs >= 1)", files[0]]) == 0
    assert run(["eval", "G (d_obs >= 1)", *files, "--format", "json"]) == 1
    document = json.loads(capsys.readouterr().out.split("\n", 2)[2])
    assert [r["verdict"] for r in document["results"]] == ["satisfied", "violated"]


def test_eval_points_into_the_formula(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["eval", "always[5, 2] (d_obs > 0)", files[0]]) == 1
    err = capsys.readouterr().err
    assert "<formula>:1:7" in err
    assert run(["eval", "always (d_obs > 0", files[0]]) == 1
    assert run(["eval", "always (d_ops > 0)", files[0]]) == 2


def test_explain_says_what_decides_and_what_would_turn_it(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["score", GRID, *files, "--explain"]) == 0
    out = capsys.readouterr().out
    assert "to hold     d_obs at sample 3 from 0 to at least 1" in out
    assert out.index("rank") < out.index("decided by")
    assert run(["score", GRID, files[1], "--explain", "--format", "json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["demonstrations"]
    assert row["requirements"]["avoid"]["explanation"]["violations"] == [[3, 3]]
    assert run(["score", GRID, files[1], "--explain", "--format", "csv"]) == 2
    assert "--format json" in capsys.readouterr().err


def test_plot_draws_each_demonstration(files: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    assert run(["score", GRID, *files, "--plot", str(tmp_path / "pictures"), "--format", "json"]) == 0
    assert "explanation" not in json.loads(capsys.readouterr().out)["demonstrations"][0]["requirements"]["avoid"]
    assert sorted(p.name for p in (tmp_path / "pictures").iterdir()) == ["1_good_csv.png", "2_bad_csv.png"]
    assert run(["score", GRID, files[0], "--plot", str(tmp_path / "one.svg")]) == 0
    assert (tmp_path / "one.svg").read_bytes().startswith(b"<?xml")
    assert run(["score", GRID, *files, "--plot", str(tmp_path / "two.png")]) == 2
    assert not (tmp_path / "two.png").exists()


def test_report_writes_one_page_and_spares_the_inputs(
    files: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "out.html"
    assert run(["score", GRID, *files, "--report", str(page)]) == 0
    assert f"report: {page}" in capsys.readouterr().err
    text = page.read_text(encoding="utf-8")
    assert text.count("<details") == 2
    assert "d_obs = 0, needs &gt;= 1" in text
    for wrong in ("out.txt", "out"):
        assert run(["score", GRID, *files, "--report", str(tmp_path / wrong)]) == 2
        assert "does not name an HTML file" in capsys.readouterr().err
        assert not (tmp_path / wrong).exists()
    odd = tmp_path / "data.html"
    odd.symlink_to(files[0])
    assert run(["score", GRID, *files, "--report", str(odd)]) == 2
    assert Path(files[0]).read_text() == GOOD
    assert run(["score", GRID, *files, "--report", str(tmp_path / "no" / "such.html")]) == 2
    assert "S092" in capsys.readouterr().err


MODULE = "corridor_in_this_folder"
OWN = """
import gymnasium
class Corridor(gymnasium.Env):
    observation_space = gymnasium.spaces.Discrete(3)
    action_space = gymnasium.spaces.Discrete(2)
gymnasium.register("mine/Folder-v0", entry_point=f"{__name__}:Corridor")
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    import gymnasium

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place])
    (tmp_path / f"{MODULE}.py").write_text(OWN)
    (tmp_path / "own.stl").write_text('signal s from "obs"\nhard far: eventually (s >= 2)\n')
    yield tmp_path
    sys.modules.pop(MODULE, None)
    gymnasium.registry.pop("mine/Folder-v0", None)


@pytest.mark.parametrize("option", ["--env", "--demo-env"])
def test_an_environment_of_ones_own_is_named_with_its_module(
    folder: Path, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "walk.json").write_text('{"states": [0, 1, 2], "env": {"id": "mine/Folder-v0"}}')
    assert run(["score", "own.stl", "walk.json", option, f"{MODULE}:mine/Folder-v0"]) == 0
    assert "good" in capsys.readouterr().out


def test_a_demonstration_cannot_have_a_module_imported(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # the spec needs a signal that only the environment could compute
    (folder / "far.stl").write_text("signal d_goal\nhard far: eventually (d_goal < 1)\n")
    (folder / "walk.json").write_text(f'{{"states": [0, 1, 2], "env": {{"id": "{MODULE}:mine/Folder-v0"}}}}')
    for command in (["score", "far.stl", "walk.json"], ["reward", "far.stl", "walk.json", "-o", "R.json"]):
        assert run(command) == 2
        assert "error[D829]" in capsys.readouterr().err
    learn = ["learn", "far.stl", "--demos", "walk.json", "--out", "out"]
    assert run(learn) == 2
    assert "error[D829]" in capsys.readouterr().err
    assert MODULE not in sys.modules


@pytest.mark.parametrize(
    "words", [["score"], ["score", "--format", "json"], ["score", "--jobs", "1"], ["score", "--out"], ["reward", "-o"]]
)
def test_a_log_that_leaves_out_steps_is_doubted_once_for_each_demonstration(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The third cell of the way is an obstacle that a log of every second sample jumps over: it scores as good."""
    env = '"env": {"id": "stlspec/GridWorld-v0", "map": ["S.#.G"]}'
    demos = tmp_path / "d.jsonl"
    demos.write_text(
        f'{{"name": "all", "states": [[0, 0], [0, 1], [0, 2], [0, 3], [0, 4]], {env}}}\n'
        f'{{"name": "half", "states": [[0, 0], [0, 1], [0, 3], [0, 4]], {env}}}\n'
    )
    command, *options = words
    target = {"--out": [str(tmp_path / "s.jsonl")], "-o": [str(tmp_path / "r.json")]}.get(words[-1], [])
    assert run([command, GRID, str(demos), *options, *target]) == 0
    told = capsys.readouterr().err
    assert told.count("D859") == 1
    assert "demonstration 'half': sample 1 to 2 is no step of 'stlspec/GridWorld-v0'" in told
