"""Learning by sampling: slippery lakes and binned observations, from the spec to the files."""

import json

import pytest

from stlspec import api
from stlspec.demos import make_demonstration
from stlspec.envs.catalogue import make_environment
from stlspec.errors import DataError, UsageError
from stlspec.learning import learn, load_policy
from stlspec.learning.experience import one_goal, refuse, settle_table
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, RUNS, VIOLATION

SETTINGS = Settings("plain", 25, 0, 100, 0.99, 0.1, 0.4, 0.01, False)
ROWS = ("SFFF", "FHFH", "FFFH", "HFFG")
OPTIMUM = 0.7442
"""The largest probability of reaching the goal of this lake within 100 steps, by value iteration over time."""


class KilledError(Exception):
    """Stands for a signal."""


def test_slippery_ice_is_learned_nearly_as_well_as_it_can_be(kit):
    world = make_environment("FrozenLake-v1", None, ROWS)
    path = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (3, 2), (3, 3)]
    found = [
        learn(
            kit.grid_bundle(100), world, kit.demonstrations([path]), seed=seed, demo_environment=kit.frozen_lake(ROWS)
        )
        for seed in range(3)
    ]
    assert sorted(o.satisfaction.value for o in found)[1] >= 0.95 * OPTIMUM
    for outcome in found:
        assert outcome.satisfaction.value <= OPTIMUM + 1e-4
        assert not outcome.success
        assert outcome.meets_hard
        assert not outcome.settings.mask
        assert outcome.satisfaction.method == "exact"


def test_a_killed_run_resumes_and_the_files_say_what_is_known(tmp_path, kit):
    world = make_environment("FrozenLake-v1", None, ROWS)

    def progress(episodes, _all, _steps):
        if episodes == 100:
            raise KilledError

    def run(out, progress=None):
        return learn(kit.grid_bundle(100), world, method="plain", episodes=200, out=out, progress=progress)

    import stlspec.learning.experience as experience

    pause, experience.CHECKPOINT_SECONDS = experience.CHECKPOINT_SECONDS, 0.0
    try:
        with pytest.raises(KilledError):
            run(tmp_path / "a", progress)
        assert (tmp_path / "a.partial").is_dir()
        run(tmp_path / "a")
    finally:
        experience.CHECKPOINT_SECONDS = pause
    run(tmp_path / "b")
    assert (tmp_path / "a" / "policy.json").read_bytes() == (tmp_path / "b" / "policy.json").read_bytes()
    result = json.loads((tmp_path / "a" / "result.json").read_text())
    chance = result["satisfaction_probability"]
    assert (chance["method"], chance["n"], chance["low"]) == ("exact", None, chance["value"])
    assert result["requirements"]["avoid"]["verdict"] is None
    assert 0 <= result["requirements"]["reach"]["probability"] <= 1
    assert result["training"]["env_steps_to_success"] is None


def test_a_living_environment_resumes_bit_for_bit_too(tmp_path, monkeypatch):
    monkeypatch.setattr("stlspec.learning.experience.CHECKPOINT_SECONDS", 0.0)
    car = make_environment("MountainCar-v0")

    def stop(episodes, _all, _steps):
        if episodes == 50:
            raise KilledError

    def run(out, progress=None):
        options = {"method": "plain", "bins": (8, 8), "episodes": 100, "max_steps": 60, "out": out}
        return learn(api.compile(CAR), car, progress=progress, **options)

    with pytest.raises(KilledError):
        run(tmp_path / "a", stop)
    again, whole = run(tmp_path / "a"), run(tmp_path / "b")
    assert again.policy.q == whole.policy.q
    assert again.log == whole.log
    assert again.satisfaction == whole.satisfaction


CAR = "signal position in [-1.2, 0.6]\nsoft up: eventually (position >= -0.3)"


def test_a_car_in_bins_learns_to_leave_the_valley(tmp_path):
    """A low hill: from about -0.5 to -0.3 takes one swing."""
    outcome = learn(
        api.compile(CAR), make_environment("MountainCar-v0"), method="plain", base="env", bins=(12, 12),
        episodes=100, max_steps=300, out=tmp_path / "car",
    )  # fmt: skip
    assert outcome.satisfaction.value > 0.9
    assert outcome.satisfaction.n == 200
    assert len(outcome.path[0]) == 2
    policy = load_policy(tmp_path / "car")
    assert policy.act([-0.5, 0.01]) == outcome.policy.act((-0.5, 0.01))
    result = json.loads((tmp_path / "car" / "result.json").read_text())
    assert len(result["policy"]["states"]) == len(result["policy"]["actions"]) + 1


def test_demonstrations_in_bins_shape_the_values():
    from stlspec.demos import make_demonstration

    demos = [make_demonstration("d", states=[[-0.5, 0.0], [-0.4, 0.01], [-0.3, 0.02], [-0.2, 0.02]])]
    car = make_environment("MountainCar-v0")
    outcome = learn(api.compile(CAR), car, demos, bins=(12, 12), episodes=25, max_steps=50)
    assert len(outcome.reward.states) >= 2
    assert max(outcome.reward.values) == 1.0
    with pytest.raises(DataError) as caught:
        learn(api.compile(CAR), car, reward=outcome.reward, bins=(16, 9), episodes=25, max_steps=50)
    assert caught.value.diagnostics[0].code == "D858"
    assert "--bins 12,12" in caught.value.diagnostics[0].help


@pytest.mark.parametrize(
    ("spec", "part"),
    [
        ("signal d_obs\nhard a: always (d_obs >= 1)", "D866"),
        ("signal row\nsignal col\nsoft a: eventually (row > 1)\nsoft b: eventually (col > 1)", "2 goals"),
    ],
)
def test_what_has_not_one_goal_is_refused(spec, part):
    with pytest.raises(UsageError, match=part):
        one_goal(api.compile(spec), make_environment("FrozenLake-v1"))


@pytest.mark.parametrize(
    ("spec", "method", "code"),
    [
        ("time s\nsignal d_goal\nsoft a: eventually (d_goal < 1)", "plain", "D876"),
        ("signal d_goal\nsoft a: eventually (d_goal < 1)", "paper", "D869"),
        ("signal d_goal\nhard h: always (d_goal > 3 implies next (d_goal > 1))", "plain", "D868"),
    ],
)
def test_what_cannot_be_sampled_is_refused(spec, method, code):
    from dataclasses import replace

    with pytest.raises(UsageError, match=code):
        refuse(api.compile(spec), make_environment("FrozenLake-v1"), replace(SETTINGS, method=method))


def test_states_of_a_table_are_settled_by_the_spec(kit):
    bundle, world = kit.grid_bundle(9), make_environment("FrozenLake-v1", None, ("SFH", "FFG", "FFF"))
    assert (
        settle_table(bundle, world, one_goal(bundle, world)) == (RUNS, RUNS, VIOLATION, RUNS, RUNS, GOAL) + (RUNS,) * 3
    )


def test_bins_are_for_observations_without_numbers(kit):
    with pytest.raises(UsageError, match="--bins"):
        learn(kit.grid_bundle(9), make_environment("FrozenLake-v1"), bins=(5,))


def test_a_certain_table_with_its_own_reward_has_verdicts(kit):
    """The lake pays 1 at the goal and nothing else: with gamma < 1 the shortest way is the best."""
    rows = ("SFF", "FHF", "FFG")
    outcome = learn(kit.grid_bundle(4), kit.frozen_lake(rows), method="plain", base="env", episodes=400)
    assert outcome.success
    assert outcome.satisfaction is None
    assert len(outcome.actions) == 4
    assert set(outcome.log.returns) <= {0.0, 1.0, -1.0}
    assert outcome.to_json()["requirements"]["fast"]["verdict"] == "satisfied"
    with pytest.raises(UsageError, match="no reward of its own"):
        learn(kit.grid_bundle(4), kit.grid_world(("S.G",)), method="plain", base="env")


CLIFF = """
signal s from "obs[0]"
hard cliff: always (s <= 36 or s >= 47)
soft reach depends on cliff: eventually (s > 46)
"""


def test_an_environment_without_a_step_limit_gets_one_that_leaves_time_for_the_way():
    """CliffWalking has 48 states, no limit of its own, and a way of 13 steps."""
    cells = [36, *range(24, 36), 47]
    shown = make_demonstration("edge", states=[[cell] for cell in cells], actions=[0, *[1] * 11, 2])
    outcome = learn(api.compile(CLIFF), make_environment("CliffWalking-v1"), [shown], episodes=600)
    assert outcome.settings.max_steps == 192
    assert outcome.success
    assert not any("step limit" in note and "no episode" in note for note in outcome.notes)
    short = learn(api.compile(CLIFF), make_environment("CliffWalking-v1"), [shown], episodes=50, max_steps=4)
    assert "no episode of training reached the goal: all of them ended at the step limit of 4" in short.notes[0]
