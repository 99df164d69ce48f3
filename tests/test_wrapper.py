"""A spec around an environment: what it pays, what it ends, what it reports."""

import pickle
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Discrete
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import Autoreset, TimeLimit, TransformObservation

import stlspec
import stlspec.envs.gridworld
from stlspec import api
from stlspec.demos import make_demonstration
from stlspec.envs.catalogue import make_environment
from stlspec.errors import UsageError
from stlspec.rewards import infer_reward
from stlspec.wrapper import STLReward

GRID = """
signal d_obs
signal d_goal
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually (d_goal < 1)
soft fast depends on avoid, reach: eventually[0, 3] (d_goal < 1)
"""
ROWS = ["S.G", ".#."]
LEFT, DOWN, RIGHT, UP = range(4)
CAR = 'signal position in [-1.2, 0.6]\nsignal push from "action[0]"\nsignal v from "obs[1]"\n'


def grid(**options):
    return STLReward(gymnasium.make("stlspec/GridWorld-v0", map=ROWS), GRID, **options)


def steps(env, actions):
    env.reset(seed=0)
    return [env.step(action) for action in actions]


def test_the_base_reward_of_the_spec_by_hand():
    """Two steps to the goal: -1/100, then -1/100 and the shares of both soft requirements, 1 in all."""
    first, second = steps(grid(base="spec"), [RIGHT, RIGHT])
    assert first[1:4] == (-0.01, False, False)
    assert second[1] == pytest.approx(0.99)
    assert second[2]
    assert second[4]["satisfied"] == {"avoid": True, "reach": True, "fast": True}
    assert second[4]["robustness"] == {"avoid": 0.0, "reach": 1.0, "fast": 1.0}
    assert second[4]["original_reward"] == 0.0


def test_what_comes_too_late_pays_its_share_only():
    """`reach` has weight e^2 and `fast` e^1 before they are summed to 1: 0.731 of the goal comes after 4 steps."""
    *_, last = steps(grid(base="spec"), [LEFT, LEFT, RIGHT, RIGHT])
    assert last[1] == pytest.approx(-0.01 + 1 / (1 + np.exp(-1)))
    assert last[2]


def test_a_violation_terminates_costs_or_is_only_reported():
    _, (_, reward, terminated, _, info) = steps(grid(), [RIGHT, DOWN])
    assert (reward, terminated, info["violation"]) == (-1.0, True, True)
    rows = steps(grid(on_violation="penalise"), [RIGHT, DOWN, DOWN, UP])
    assert [row[1] for row in rows] == [0.0, -1.0, -1.0, 0.0]
    assert not any(row[2] for row in rows)
    assert [row[4]["violation"] for row in rows] == [False, True, True, False]
    assert rows[-1][4]["satisfied"]["avoid"] is False
    rows = steps(grid(on_violation="ignore"), [RIGHT, DOWN])
    assert (rows[1][1], rows[1][2], rows[1][4]["violation"]) == (0.0, False, True)


def shaped(**options):
    world = make_environment("stlspec/GridWorld-v0", None, ROWS)
    reward = infer_reward(api.compile(GRID), [make_demonstration("d", states=[[0, 0], [0, 1], [0, 2]])], world)
    return STLReward(gymnasium.make("stlspec/GridWorld-v0", map=ROWS), GRID, reward, **options), reward.values


def test_shaping_adds_the_discounted_gain_of_potential_and_forfeits_it_at_the_end():
    env, (one, two, three) = shaped(gamma=0.5)
    first, second = steps(env, [RIGHT, RIGHT])
    assert first[1] == pytest.approx(0.5 * two - one)
    assert second[1] == pytest.approx(0.5 * three - two)  # base "env": the goal is no end
    env, _ = shaped(gamma=0.5, base="spec")
    _, second = steps(env, [RIGHT, RIGHT])
    assert second[1] == pytest.approx(-0.01 + 1.0 - two)


def test_a_truncated_episode_keeps_its_potential():
    env, (one, two, _) = shaped(gamma=0.5)
    env.env = TimeLimit(env.env, 1)
    (last,) = steps(env, [RIGHT])
    assert (last[2], last[3]) == (False, True)
    assert last[1] == pytest.approx(0.5 * two - one)


@pytest.mark.parametrize("seed", range(5))
def test_over_an_episode_shaping_changes_the_return_by_the_first_potential(seed):
    random = np.random.default_rng(seed)
    (env, (one, *_)), plain = shaped(gamma=0.9, base="spec"), grid(gamma=0.9, base="spec")
    env.reset(), plain.reset()
    difference, discount, over = 0.0, 1.0, False
    while not over:
        action = int(random.integers(4))
        a, b = env.step(action), plain.step(action)
        difference += discount * (a[1] - b[1])
        discount *= 0.9
        over = a[2]
        assert a[2] == b[2]
    assert difference == pytest.approx(-one)


@pytest.mark.filterwarnings("ignore:.*different from the unwrapped version", "ignore:.*infinity. This is probably")
@pytest.mark.parametrize(
    ("env", "spec", "options"),
    [
        ("MountainCar-v0", CAR + "hard calm: always (v <= 0.05)\nsoft up: eventually (position >= 0.5)", {}),
        ("FrozenLake-v1", GRID, {"base": "spec", "on_violation": "penalise"}),
        ("CartPole-v1", 'signal x from "obs[0]"\nhard near: always[0, 20] (abs(x) < 1)', {"on_violation": "ignore"}),
    ],
)
def test_it_passes_the_checks_of_gymnasium(env, spec, options):
    check_env(STLReward(gymnasium.make(env).unwrapped, spec, **options), skip_render_check=True)


def test_it_can_be_made_again_from_its_description(tmp_path):
    place = tmp_path / "grid.stl"
    place.write_text(GRID + "param T\n")
    env = STLReward(gymnasium.make("FrozenLake-v1", is_slippery=False), place, params={"T": 3})
    again = gymnasium.make(env.spec)
    assert isinstance(again, STLReward)
    assert again.bundle.meaning_sha256 == env.bundle.meaning_sha256
    assert pickle.loads(pickle.dumps(env.spec)).additional_wrappers[-1].kwargs["spec"] == str(place)


def test_it_is_pickled_in_the_middle_of_an_episode_and_goes_on_alike(tmp_path):
    env = STLReward(gymnasium.make("FrozenLake-v1", is_slippery=False), GRID + "param T = 3\n", base="spec")
    env.reset(seed=0)
    env.step(1)
    again = pickle.loads(pickle.dumps(env))
    for action in (1, 2, 2):
        assert repr(again.step(action)) == repr(env.step(action))


def test_its_description_is_text_also_with_a_bundle():
    bundle = stlspec.compile(GRID + "param T\n", params={"T": 3})
    env = STLReward(gymnasium.make("FrozenLake-v1", is_slippery=False), bundle)
    again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))
    assert again.bundle == env.bundle


def test_params_of_a_bundle_are_bound_already():
    bundle = stlspec.compile(GRID + "param T\n", params={"T": 3})
    with pytest.raises(UsageError) as error:
        STLReward(gymnasium.make("FrozenLake-v1"), bundle, params={"T": 4})
    (found,) = error.value.diagnostics
    assert found.code == "D880"
    assert "takes none" in found.message


def test_observations_that_a_wrapper_changed_are_no_states():
    """Else the start, shown as 15, would be taken for the goal."""
    lake = TransformObservation(gymnasium.make("FrozenLake-v1"), lambda state: 15 - state, Discrete(16))
    with pytest.raises(UsageError) as error:
        STLReward(lake, "signal d_goal\nsoft reach: eventually (d_goal < 1)\n")
    assert error.value.diagnostics[0].code == "D870"
    STLReward(lake, 'signal s from "obs"\nsoft reach: eventually (s < 1)\n').reset(seed=0)


@pytest.mark.parametrize("kind", [SyncVectorEnv, AsyncVectorEnv])
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_under_vector_environments_every_episode_begins_afresh(kind, mode):
    """One falls into the obstacle at every second step, the other goes to the goal and stays."""
    vector = kind([grid, grid], autoreset_mode=mode)
    try:
        vector.reset(seed=0)
        seen = []
        for k in range(9):
            phase = k % 3 if mode is AutoresetMode.NEXT_STEP else k % 2
            _, reward, terminated, _, _ = vector.step(np.array([(RIGHT, DOWN, UP)[phase], RIGHT]))
            seen.append((float(reward[0]), bool(terminated[0]), bool(terminated[1])))
        period = 3 if mode is AutoresetMode.NEXT_STEP else 2
        assert seen == [((-1.0 if k % period == 1 else 0.0), k % period == 1, False) for k in range(9)]
    finally:
        vector.close()


def test_infos_of_vector_environments_have_the_robustness():
    vector = SyncVectorEnv([grid, grid])
    vector.reset(seed=0)
    info = vector.step(np.array([RIGHT, LEFT]))[4]
    assert info["robustness"]["reach"].tolist() == [0.0, -1.0]
    assert info["original_reward"].tolist() == [0.0, 0.0]


def test_signals_of_the_action_take_the_first_one_at_sample_0():
    env = STLReward(gymnasium.make("MountainCar-v0"), CAR + "hard pushed: always (push >= 1)")
    assert env.reset(seed=0)[1]["violation"] is False
    assert env.step(0)[2:4] == (True, False)
    env.reset(seed=0)
    assert env.step(2)[2:4] == (False, False)


def test_an_episode_that_begins_with_a_violation_ends_at_its_first_step():
    env = STLReward(gymnasium.make("MountainCar-v0"), CAR + "hard never: always (position > 5)".replace("5", "0.5"))
    assert env.reset(seed=0)[1]["violation"]
    assert env.step(1)[2]


def test_a_step_after_the_end_asks_for_a_reset():
    env = grid()
    with pytest.raises(ResetNeeded):
        env.step(0)
    steps(env, [RIGHT, DOWN])
    with pytest.raises(ResetNeeded):
        env.step(0)


def test_a_reward_map_in_bins_shapes_raw_observations(tmp_path):
    from stlspec.envs.live import with_bins
    from stlspec.learning.storage import dumps

    spec = CAR + "soft up: eventually (position >= -0.5)"
    car = with_bins(make_environment("MountainCar-v0"), (10, 10))
    demo = make_demonstration("d", states=[[-0.6, 0.0], [-0.5, 0.01], [-0.3, 0.02]], actions=[2, 2])
    reward = infer_reward(api.compile(spec), [demo], car)
    place = tmp_path / "R.json"
    place.write_text(dumps(reward.to_json()))
    env = STLReward(gymnasium.make("MountainCar-v0"), spec, str(place))
    assert env._potential(np.array([-0.3, 0.02], dtype=np.float32)) == 1.0
    assert env._potential(np.array([0.5, -0.06], dtype=np.float32)) == 0.0


@pytest.mark.parametrize(
    ("options", "part"),
    [
        ({"gamma": 2}, "from 0 to 1"),
        ({"base": "both"}, "env, spec"),
        ({"on_violation": "stop"}, "terminate, penalise, ignore"),
    ],
)
def test_options_out_of_range_are_refused(options, part):
    with pytest.raises(UsageError, match=part):
        grid(**options)


def test_what_cannot_be_wrapped_is_refused():
    with pytest.raises(UsageError, match="D880"):
        STLReward(Autoreset(gymnasium.make("FrozenLake-v1")), GRID)
    with pytest.raises(UsageError, match="wrap each"):
        STLReward(SyncVectorEnv([grid]), GRID)
    with pytest.raises(UsageError, match="d_gaol"):
        STLReward(gymnasium.make("FrozenLake-v1"), "signal d_gaol\nsoft a: eventually (d_gaol < 1)")
    with pytest.raises(UsageError, match="D870"):
        STLReward(gymnasium.make("CartPole-v1"), GRID)
    with pytest.raises(UsageError, match="D876"):
        STLReward(gymnasium.make("CartPole-v1"), 'time s\nsignal x from "obs[0]"\nhard a: always (x < 9)')
    with pytest.raises(UsageError, match="no numbers"):
        world = make_environment("stlspec/GridWorld-v0", None, ROWS)
        reward = infer_reward(api.compile(GRID), [make_demonstration("d", states=[[0, 0], [0, 2]])], world)
        STLReward(gymnasium.make("MountainCar-v0"), CAR + "soft a: eventually (v > 1)", _homeless(reward))


def _homeless(reward):
    from dataclasses import replace

    return replace(reward, environment={"id": "unknown/World-v0", "args": {}, "map": None})


def test_a_spec_may_be_a_path_a_text_or_a_bundle(tmp_path):
    place = tmp_path / "grid.stlb"
    bundle = api.compile(GRID)
    bundle.save(place)
    for spec in (GRID, bundle, place, str(place)):
        env = STLReward(gymnasium.make("FrozenLake-v1"), spec)
        assert env.bundle.meaning_sha256 == bundle.meaning_sha256
    assert Path(place).exists()


CORRIDOR = 'signal s from "obs[0]"\n'
LATE = CORRIDOR + "hard g: eventually (s >= 9)\nsoft r depends on g: eventually (s >= 3)"


class Corridor(gymnasium.Env):
    """Cells 0 to 6 in one line; it terminates at the last one, or is truncated there."""

    observation_space = gymnasium.spaces.Box(0, 6, (1,))
    action_space = gymnasium.spaces.Discrete(2)

    def __init__(self, truncates=False):
        self.truncates = truncates

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        return np.array([0.0], dtype=np.float32), {}

    def step(self, action):
        self.cell = min(6, self.cell + int(action))
        over = self.cell == 6
        return np.array([self.cell], np.float32), 0.0, over and not self.truncates, over and self.truncates, {}


def walk(spec, **options):
    env = STLReward(Corridor(options.pop("truncates", False)), spec, **options)
    env.reset(seed=0)
    rows = [env.step(1)]
    while not any(rows[-1][2:4]):
        rows.append(env.step(1))
    return rows


@pytest.mark.parametrize(("on_violation", "cost"), [("terminate", -1.0), ("penalise", -1.0), ("ignore", 0.0)])
def test_a_hard_requirement_that_was_not_met_when_the_episode_terminates_is_violated_once(on_violation, cost):
    rows = walk(LATE, on_violation=on_violation)
    assert [row[1] for row in rows] == [0.0] * 5 + [cost]
    assert [row[4]["violation"] for row in rows] == [False] * 5 + [True]
    assert rows[-1][2:4] == (True, False)
    assert rows[-1][4]["satisfied"]["g"] is False


def test_a_truncated_episode_decides_nothing():
    last = walk(LATE, truncates=True)[-1]
    assert (last[1], last[2], last[3], last[4]["violation"]) == (0.0, False, True, False)


def test_what_was_violated_before_is_not_charged_again_at_the_end():
    spec = CORRIDOR + "hard soon: eventually[0, 2] (s >= 5)\nhard far: eventually (s >= 6)"
    rows = walk(spec, on_violation="penalise")
    assert [row[1] for row in rows] == [0.0, -1.0, 0.0, 0.0, 0.0, 0.0]


def test_the_spec_neither_pays_nor_ends_before_what_comes_first_is_met():
    spec = CORRIDOR + "hard g: eventually (s >= 5)\nsoft r depends on g: eventually (s >= 2)"
    rows = walk(spec + "\nsoft free: eventually (s >= 1)", base="spec")
    assert [row[2] for row in rows] == [False] * 4 + [True]
    # both have a share, and the one that depends on nothing is paid at once
    assert rows[0][1] > 0.2
    assert [row[1] for row in rows[1:4]] == [-0.01] * 3
    assert sum(row[1] for row in rows) == pytest.approx(1 - 5 * 0.01)


def test_the_spec_does_not_wait_for_what_is_violated_for_good():
    spec = CORRIDOR + "hard g: eventually[0, 1] (s >= 5)\nsoft r depends on g: eventually (s >= 3)"
    rows = walk(spec, base="spec", on_violation="ignore")
    assert [row[1] for row in rows] == [-0.01, -0.01, pytest.approx(0.99)]
    assert rows[-1][2]


def test_a_hard_requirement_that_holds_so_far_keeps_no_episode_open():
    _, second = steps(grid(base="spec"), [RIGHT, RIGHT])
    assert second[2]


def test_a_reward_map_of_another_spec_is_told():
    world = make_environment("stlspec/GridWorld-v0", None, ROWS)
    reward = infer_reward(api.compile(GRID), [make_demonstration("d", states=[[0, 0], [0, 1], [0, 2]])], world)
    env = gymnasium.make("stlspec/GridWorld-v0", map=ROWS)
    with pytest.warns(UserWarning, match="D865") as told:
        wrapped = STLReward(env, GRID.replace("[0, 3]", "[0, 4]"), reward)
    assert [str(w.filename) for w in told] == [__file__]
    assert wrapped._potential(2) == reward.values[2]


def test_a_reward_map_from_another_map_or_environment_is_told_and_shapes_little():
    world = make_environment("stlspec/GridWorld-v0", None, ROWS)
    reward = infer_reward(api.compile(GRID), [make_demonstration("d", states=[[0, 0], [0, 1], [0, 2]])], world)
    elsewhere = gymnasium.make("stlspec/GridWorld-v0", map=["S..", "#.G"])
    lake = gymnasium.make("FrozenLake-v1", desc=["SFG", "FHF"])
    for env in (elsewhere, lake):
        with pytest.warns(UserWarning, match="D883"):
            wrapped = STLReward(env, GRID, reward)
        assert wrapped._potential(2) == pytest.approx(0.05 * reward.values[2])
    another_start = gymnasium.make("stlspec/GridWorld-v0", map=["..G", "S#."])
    assert STLReward(another_start, GRID, reward)._potential(2) == reward.values[2]


@pytest.mark.parametrize("reward", [3, ["R.json"], True])
def test_what_is_no_reward_map_is_refused(reward):
    with pytest.raises(UsageError, match="`reward` is a reward map, its document"):
        grid(reward=reward)
