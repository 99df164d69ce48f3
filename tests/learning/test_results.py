"""The files of a finished run."""

import csv
import json

import pytest

from stlspec.learning import learn, load_policy, plots
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
