"""learn from the command line: files, the account, gates, and what is refused."""

import json
from pathlib import Path

import pytest

from stlspec.cli.main import run
from stlspec.cli.training import parse_state

SPECS = Path(__file__).parents[2] / "specs"
SPEC = str(SPECS / "grid_single_goal.stl")
DEMOS = str(SPECS / "demos" / "grid_5x5.jsonl")
WORLD = ["--env", "stlspec/GridWorld-v0", "--map", str(SPECS / "maps" / "grid_5x5.txt")]
SHORT = ["--episodes", "600"]


def test_learn_writes_a_policy_and_says_what_it_meets(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "run"
    assert run(["learn", SPEC, *WORLD, *SHORT, "--demos", DEMOS, "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert "meets every requirement" in text
    assert "✓ avoid" in text
    drawing = text.split("Its path to at_goal, 8 steps:\n")[1].split("\n\n")[0]
    assert drawing.count("o") == 7  # eight steps from S to G, whichever of the shortest ways
    result = json.loads((out / "result.json").read_text())
    assert (result["schema"], result["success"], result["method"]) == ("stlspec.learn/1", True, "shaped")
    assert result["policy"]["states"][-1] == [0, 4]
    episodes = (out / "episodes.csv").read_text().splitlines()
    assert len(episodes) == 601
    assert not (tmp_path / "run.partial").exists()


def test_a_path_that_stops_short_says_which_goal_is_not_reached(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["learn", SPEC, *WORLD, "--episodes", "300", "--method", "paper", "--demos", DEMOS]
    run([*words, "--out", str(tmp_path / "run")])
    text = capsys.readouterr().out
    assert "The policy does not meet every requirement.\n" in text
    assert "\nIts path, 100 steps: at_goal is not reached\n" in text
    assert [line for line in text.splitlines() if line != line.rstrip()] == []


LAKE = [
    str(SPECS / "frozenlake_4x4.stl"),
    "--env",
    "FrozenLake-v1",
    "--demos",
    str(SPECS / "demos/frozenlake_4x4.jsonl"),
]


def test_a_policy_that_never_meets_the_spec_does_not_read_like_a_success(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = tmp_path / "lake.stl"
    spec.write_text(
        "signal d_obs\nsignal d_goal\nhard avoid: always (d_obs >= 1)\nsoft early: eventually[0, 3] (d_goal < 1)\n"
        "soft reach: eventually (d_goal < 1)\n"
    )
    run(["learn", str(spec), *LAKE[1:], "--episodes", "3000", "--out", str(tmp_path / "run")])
    text = capsys.readouterr().out
    assert text.startswith("All requirements hold with probability 0. early never holds.\n")
    assert "  ✗ early  soft  holds with probability 0\n" in text


def test_where_moves_are_by_chance_hard_requirements_are_met_if_they_hold_more_often_than_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Beside two holes one stays dry for 100 steps with (2/3)^100, 2.5e-18; text, JSON and exit code say the same."""
    spec, rows, demo, out = (tmp_path / name for name in ("lake.stl", "lake.txt", "demo.json", "run"))
    spec.write_text("signal d_obs\nsignal d_goal\nhard dry: always (d_obs >= 1)\nsoft reach: eventually (d_goal < 1)\n")
    rows.write_text("SH\nHG\n")
    demo.write_text('{"states": [[0, 0], [0, 1]]}')
    words = ["learn", str(spec), "--env", "FrozenLake-v1", "--map", str(rows), "--demos", str(demo)]
    assert run([*words, "--episodes", "100", "--out", str(out)]) == 1
    text = capsys.readouterr().out
    assert text.startswith(
        "All requirements hold with probability 0. reach never holds. The hard ones hold no more often than not "
        "(probability 2.5e-18), so the policy does not meet them.\n"
    )
    assert "  ~ dry    hard  holds with probability 2.5e-18\n" in text
    result = json.loads((out / "result.json").read_text())
    assert not result["success"]
    assert not result["satisfaction_probability"]["meets_hard"]
    assert result["satisfaction_probability"]["hard"] == pytest.approx((2 / 3) ** 100)
    assert run(["learn", *LAKE, "--episodes", "1000", "--out", str(out)]) == 0
    assert not capsys.readouterr().out.startswith("The policy meets")
    result = json.loads((out / "result.json").read_text())
    assert 0.5 < result["satisfaction_probability"]["hard"] < 1
    assert result["satisfaction_probability"]["meets_hard"]
    assert not result["success"]


def test_a_path_by_chance_says_whether_it_reaches_the_goal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for episodes in ("5", "3000"):
        run(["learn", *LAKE, "--episodes", episodes, "--out", str(tmp_path / episodes)])
    texts = capsys.readouterr().out.split("Its path")[1:]
    for text, episodes in zip(texts, ("5", "3000"), strict=True):
        states = json.loads((tmp_path / episodes / "result.json").read_text())["policy"]["states"]
        heading = text.splitlines()[0]
        assert heading.startswith(" to at_goal, ") == (states[-1] == [3, 3])
        assert heading.endswith(": at_goal is not reached") == (states[-1] != [3, 3])


def test_the_document_on_stdout_is_the_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "run"
    words = ["learn", SPEC, *WORLD, *SHORT, "--demos", DEMOS, "--out", str(out), "--format", "json"]
    assert run(words) == 0
    assert json.loads(capsys.readouterr().out) == json.loads((out / "result.json").read_text())


def test_the_same_seed_gives_the_same_bits(tmp_path: Path) -> None:
    for name in ("a", "b"):
        words = ["learn", SPEC, *WORLD, *SHORT, "--seed", "5", "--demos", DEMOS, "--out", str(tmp_path / name)]
        assert run(words) == 0
    for file in ("policy.json", "episodes.csv", "reward.json"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_a_policy_that_breaks_a_hard_requirement_is_exit_1(tmp_path: Path) -> None:
    walled = tmp_path / "walled.txt"
    walled.write_text("..G\n###\nS..\n")
    world = ["--env", "stlspec/GridWorld-v0", "--map", str(walled)]
    spec = tmp_path / "never.stl"
    spec.write_text("signal d_obs\nsignal d_goal\nhard far: always (d_obs >= 9)\nsoft go: eventually (d_goal < 1)\n")
    empty = tmp_path / "R.json"
    map_rows = walled.read_text().split()
    env = {"id": "stlspec/GridWorld-v0", "args": {}, "map": map_rows}
    document = {"schema": "stlspec.reward/1", "meaning_sha256": "0" * 64, "env": env, "states": [0], "values": [1]}
    empty.write_text(json.dumps(document))
    code = run(
        ["learn", str(spec), *world, *SHORT, "--method", "plain", "--reward", str(empty), "--out", str(tmp_path / "o")]
    )
    assert code == 1


@pytest.mark.parametrize(
    ("spec", "code"),
    [
        ("signal d_obs\nhard a: always (d_obs >= 1)\n", "goal"),
        (
            "signal d_goal\nhard a: always (once (next (d_goal > 0)))\nsoft b: eventually (d_goal < 1)\n",
            "past operator",
        ),
    ],
)
def test_a_task_outside_the_limits_is_refused_with_the_limit(
    spec: str, code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "x.stl"
    file.write_text(spec)
    out = tmp_path / "run"
    assert run(["learn", str(file), *WORLD, "--demos", DEMOS, "--out", str(out)]) == 2
    assert code in capsys.readouterr().err
    assert not out.exists()


def test_a_folder_with_other_files_is_never_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    precious = tmp_path / "thesis.txt"
    precious.write_text("years of work")
    assert run(["learn", SPEC, *WORLD, *SHORT, "--demos", DEMOS, "--out", str(tmp_path)]) == 2
    assert "error[" in capsys.readouterr().err
    assert precious.read_text() == "years of work"


def test_a_finished_run_explains_a_state_by_itself(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "run")
    assert run(["learn", SPEC, *WORLD, *SHORT, "--demos", DEMOS, "--out", out]) == 0
    capsys.readouterr()
    assert run(["learn", "--explain", "[0, 4]", "--out", out]) == 0
    assert capsys.readouterr().out.startswith("state [0, 4]: reward 1\n= (")
    assert run(["learn", "--explain", "0,4", "--out", out, "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["schema"], document["state"], document["reward"]) == ("stlspec.source/1", [0, 4], 1.0)
    for text in ("9,9", "99", "here", "", "1,2,3", "-1"):
        assert run(["learn", f"--explain={text}", "--out", out]) == 2
    assert run(["learn", "--explain", "0,4", "--out", str(tmp_path / "none")]) == 2


@pytest.mark.parametrize("words", [[], [SPEC], [SPEC, *WORLD]])
def test_what_is_missing_is_named(words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["learn", *words, "--out", str(tmp_path / "o")]) == 2
    text = capsys.readouterr().err
    assert "D880" in text
    assert ("SPEC" if not words else "--env" if len(words) == 1 else "--demos") in text


@pytest.mark.parametrize(
    ("text", "state"), [("7", 7), ("2,3", (2, 3)), ("[2, 3]", (2, 3)), (" (2,3) ", (2, 3)), ("0", 0)]
)
def test_a_state_is_read_as_it_is_written(text: str, state: object) -> None:
    assert parse_state(text) == state


def test_the_environment_is_the_one_that_the_demonstrations_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["learn", SPEC, *SHORT, "--demos", DEMOS, "--out", str(tmp_path / "a")]) == 0
    assert run(["learn", SPEC, *WORLD, *SHORT, "--demos", DEMOS, "--out", str(tmp_path / "b")]) == 0
    assert (tmp_path / "a" / "episodes.csv").read_bytes() == (tmp_path / "b" / "episodes.csv").read_bytes()
    capsys.readouterr()
    first, second = (json.loads(line) for line in Path(DEMOS).read_text().splitlines()[:2])
    other = tmp_path / "other.jsonl"
    other.write_text(json.dumps(first) + "\n" + json.dumps({**second, "env": None}) + "\n")
    assert run(["learn", SPEC, *SHORT, "--demos", str(other), "--out", str(tmp_path / "c")]) == 2
    assert "do not all name the same one" in capsys.readouterr().err


@pytest.mark.parametrize("method", ["shaped", "plain"])
def test_learn_doubts_a_demonstration_with_a_step_that_is_none(
    method: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    demo = tmp_path / "jumps.json"
    demo.write_text('{"states": [[4, 0], [2, 0], [0, 0], [0, 2], [0, 4]]}')
    words = ["learn", SPEC, *WORLD, "--episodes", "600", "--method", method, "--demos", str(demo)]
    assert run([*words, "--out", str(tmp_path / "run")]) == 0
    told = capsys.readouterr().err
    assert told.count("D859") == 1
    assert "no action leads from [4, 0] to [2, 0] (the first of 4)" in told
