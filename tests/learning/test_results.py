"""The files of a finished run."""

import csv
import json
from dataclasses import replace

import pytest

from stlspec.envs.catalogue import make_environment
from stlspec.learning import learn, load_policy, plots
from stlspec.learning.results import zones
from stlspec.rewards import load_reward


@pytest.fixture
def run(small, tmp_path):
    bundle, world, demos = small
    return learn(bundle, world, demos, episodes=120, out=tmp_path / "out"), tmp_path / "out"


def test_every_file_named_is_there_and_no_other(run):
    outcome, out = run
    assert sorted(outcome.files.values()) == sorted(p.name for p in out.iterdir())
    assert json.loads((out / "result.json").read_text()) == outcome.to_json()


def test_policy_and_reward_can_be_loaded_again(run):
    outcome, out = run
    assert load_policy(out) == outcome.policy
    assert load_reward(out / "reward.json") == outcome.reward


def test_the_log_agrees_with_the_counts(run):
    outcome, out = run
    rows = list(csv.DictReader((out / "episodes.csv").read_text().splitlines()))
    assert len(rows) == outcome.training.episodes == 120
    assert sum(int(row["steps"]) for row in rows) == outcome.training.env_steps
    assert sum(row["outcome"] == "violation" for row in rows) == outcome.training.hard_violations


def test_without_matplotlib_there_is_text_instead_of_pictures(small, tmp_path, monkeypatch):
    monkeypatch.setattr(plots, "find_spec", lambda name: None)
    bundle, world, demos = small
    outcome = learn(bundle, world, demos, episodes=30, out=tmp_path / "out")
    assert outcome.files["reward_map"] == "reward.txt"
    assert "curve" not in outcome.files
    assert "S start" in (tmp_path / "out" / "reward.txt").read_text()


def test_a_picture_that_fails_is_a_warning_and_the_run_is_kept(small, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")

    def fail(*given):
        raise ValueError("no font\nanywhere")

    monkeypatch.setattr(plots, "draw_reward", fail)
    bundle, world, demos = small
    outcome = learn(bundle, world, demos, episodes=30, out=tmp_path / "out")
    (warning,) = outcome.warnings
    assert warning.code == "D877"
    assert "reward.png could not be drawn: ValueError: no font anywhere" in warning.message
    assert outcome.files["reward_map"] == "reward.txt"
    assert sorted(outcome.files.values()) == sorted(p.name for p in (tmp_path / "out").iterdir())
    assert load_policy(tmp_path / "out") == outcome.policy


def test_a_title_with_dollar_signs_costs_no_picture(small, tmp_path):
    pytest.importorskip("matplotlib")
    bundle, world, demos = small
    outcome = learn(replace(bundle, title="$x_1 costs $5 \\frac{"), world, demos, episodes=30, out=tmp_path / "out")
    assert outcome.warnings == ()
    assert {"reward.png", "curve.png"} <= {p.name for p in (tmp_path / "out").iterdir()}


def test_zones_are_the_letters_of_the_map(kit):
    assert zones(kit.grid_world(("Sa.", "#ab"))) == ("", "a", "", "", "a", "b")
    assert zones(kit.grid_world(("S.1",))) == ()
    assert zones(make_environment("MountainCar-v0")) == ()
