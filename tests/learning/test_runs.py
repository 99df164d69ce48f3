"""Runs of a policy under chance, in a table and in a living environment."""

import pytest

from stlspec import api
from stlspec.envs.catalogue import make_environment
from stlspec.envs.live import with_bins
from stlspec.learning.experience import one_goal, settle_table
from stlspec.learning.runs import TableRunner, WorldRunner, watching
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, RUNS, TERMINAL, VIOLATION

SETTINGS = Settings("plain", 25, 0, 100, 0.99, 0.1, 0.4, 0.01, False)
LAKE = """
signal d_obs
signal d_goal
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually (d_goal < 1)
"""
CAR = 'signal position in [-1.2, 0.6]\nsignal a from "action[0]"\n'


def table_runner(spec, rows=("SFH", "FFF", "HFG")):
    bundle, world = api.compile(spec), make_environment("FrozenLake-v1", None, rows)
    return TableRunner(bundle, world, settle_table(bundle, world, one_goal(bundle, world)))


def test_the_probability_on_a_table_is_what_runs_of_the_policy_do():
    runner = table_runner(LAKE)
    actions = [1, 0, 0, 2, 2, 1, 0, 2, 0]
    found = runner.satisfaction(actions, SETTINGS)
    assert found.method == "exact"
    held = [all(runner.run(actions, SETTINGS, k).held.values()) for k in range(1500)]
    assert sum(held) / 1500 == pytest.approx(found.value, abs=0.05)
    assert runner.run(actions, SETTINGS, 3).states == runner.run(actions, SETTINGS, 3).states


def test_what_is_no_table_over_states_is_counted_in_runs():
    runner = table_runner(LAKE + "soft calm: always (delta(d_goal) <= 1)")
    found = runner.satisfaction([1] * 9, SETTINGS)
    assert (found.method, found.n) == ("rollouts", 1000)
    assert found.alone["calm"] == 1.0


def car_runner(spec):
    bundle = api.compile(spec)
    world = with_bins(make_environment("MountainCar-v0"), (4, 4))
    return WorldRunner(bundle, world, one_goal(bundle, world))


def test_an_episode_ends_at_the_goal_and_at_a_violation_of_the_spec():
    runner = car_runner(CAR + "soft reach: eventually (position >= -0.6)")
    assert runner.world.reset(0).ending == GOAL  # cars start between -0.6 and -0.4
    runner = car_runner(CAR + "hard keep: always (position <= -0.61)\nsoft reach: eventually (position >= 0.5)")
    assert runner.world.reset(0).ending == VIOLATION
    runner = car_runner(CAR + "soft reach: eventually (position >= 0.5)")
    assert runner.world.reset(0).ending == RUNS
    runner._live.unwrapped.state = (0.49, 0.07)
    assert runner.world.step(2).ending == GOAL


def test_an_end_that_the_spec_does_not_know_is_the_environments_own():
    runner = car_runner(CAR + "soft reach: eventually (position >= 0.6)")
    runner.world.reset(0)
    runner._live.unwrapped.state = (0.47, 0.035)
    step = runner.world.step(2)
    assert (step.ending, step.reward) == (TERMINAL, -1.0)


def test_a_signal_of_the_action_takes_the_first_one_at_sample_0():
    runner = car_runner(CAR + "hard push: always (a >= 1)\nsoft reach: eventually (position >= 0.5)")
    assert runner.world.reset(0).ending == RUNS
    assert runner.world.step(2).ending == RUNS
    assert runner.world.step(0).ending == VIOLATION
    runner.world.reset(0)
    assert runner.world.step(0).ending == VIOLATION
    run = runner.run([2] * 16, SETTINGS, 0)
    assert run.held == {"push": True, "reach": False}
    assert len(run.observations) == len(run.states) == len(run.actions) + 1 == 101
    found = runner.satisfaction([2] * 16, SETTINGS)
    assert (found.hard, found.value, found.n) == (1.0, 0.0, 200)


def test_the_spec_that_is_watched_has_the_hard_requirements_and_the_goal():
    bundle = api.compile(LAKE)
    world = make_environment("FrozenLake-v1", None, ("SG",))
    assert [r.strength for r in watching(bundle, one_goal(bundle, world)).requirements] == ["hard", "soft"]
