"""Q-learning under chance: updates by hand, and the same bits after a checkpoint."""

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest

from stlspec.learning.chance import CHUNK, RATES, Problem, Sampler, Step, World, pay, run_chunk
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, LIMIT, RUNS, TERMINAL, VIOLATION

SETTINGS = Settings("plain", 4 * CHUNK, 3, 6, 0.5, 0.25, 0.5, 0.125, False)
RISKY = ((0.5, 0, -0.125, RUNS), (0.8, 1, 0.875, GOAL), (1.0, 2, -1.125, VIOLATION))
SAFE = ((1.0, 0, -0.125, RUNS),)
PROBLEM = Problem("g", 3, 2, (0.5, 0.0, 0.0), ((RISKY, SAFE), (SAFE, SAFE), (SAFE, SAFE)), 0, (RUNS, GOAL, VIOLATION))


def trained(chunks, settings=SETTINGS, problem=PROBLEM, state=None, done=0):
    sampler = Sampler(problem, settings)
    assert state is None or sampler.restore(state)
    for chunk in range(done, chunks):
        run_chunk(sampler, chunk)
    return sampler


def test_one_step_by_hand():
    """Staying pays -1/8 and looks ahead to 0: rate 1/4, then the limit ends the episode."""
    stay = Problem("g", 1, 1, (0.0,), ((SAFE,),), 0, (RUNS,))
    sampler = Sampler(stay, replace(SETTINGS, episodes=1, max_steps=2, epsilon=0.0))
    run_chunk(sampler, 0)
    first = 0.25 * -0.125
    assert sampler.q[0][0] == first + 0.25 * (-0.125 + 0.5 * first - first)
    assert (sampler.outcomes, sampler.steps, sampler.returns) == ([LIMIT], [2], [-0.25])


def test_rates_fall_from_the_given_one():
    assert RATES[0] == 1.0
    assert RATES[-1] == 0.01
    assert all(a >= b for a, b in itertools.pairwise(RATES))


def test_values_approach_what_the_actions_are_worth():
    """Risky: v = 1/2 (-1/8 + v/2) + 3/10 * 7/8 - 2/10 * 9/8, v = -1/30; staying for ever is worth -1/4."""
    sampler = trained(200, replace(SETTINGS, episodes=200 * CHUNK, epsilon=1.0))
    risky, safe = sampler.values()[0]
    assert risky == pytest.approx(-1 / 30, abs=0.02)
    assert safe == pytest.approx(-0.125 + 0.5 * risky, abs=0.02)
    assert sampler.violations == sampler.outcomes.count(VIOLATION) > 100


def test_the_potential_is_where_values_start_under_shaped_only():
    assert Sampler(PROBLEM, replace(SETTINGS, method="shaped")).q[0] == [0.5, 0.5]
    assert Sampler(PROBLEM, SETTINGS).q[0] == [0.0, 0.0]


def test_a_mask_is_kept_where_it_is_asked_for_but_never_takes_the_last_action():
    sampler = trained(4, replace(SETTINGS, mask=True, epsilon=1.0))
    assert sampler.choices[0] == [1]
    assert sampler.values()[0][0] == -np.inf
    assert sampler.masked == 1
    assert sampler.violations == 1


@pytest.mark.parametrize("stop", [1, 2, 3])
def test_a_resumed_run_goes_on_bit_for_bit(stop):
    state = json.loads(json.dumps({"chunks": stop, "seconds": 0.5, **trained(stop).to_state()}))
    again, whole = trained(4, state=state, done=stop), trained(4)
    assert again.to_state() == whole.to_state()
    assert again.values() == whole.values()


@pytest.mark.parametrize(
    "change",
    [{"q": [[0.0]]}, {"steps": [1]}, {"choices": [[5], [0], [0]]}, {"choices": [[], [0], [0]]}, {"chunks": -1},
     {"visits": [[-1, 0]] * 3}, {"mean": "x"}, {"seconds": None}, {"outcomes": None}],
)  # fmt: skip
def test_a_checkpoint_that_does_not_fit_is_left_alone(change):
    state = {"chunks": 1, "seconds": 0.5, **trained(1).to_state()}
    sampler = Sampler(PROBLEM, SETTINGS)
    assert not sampler.restore({**state, **change})
    assert sampler.to_state() == Sampler(PROBLEM, SETTINGS).to_state()


def test_a_living_environment_is_reset_with_a_seed_once_a_chunk():
    seeds = []

    def reset(seed):
        seeds.append(seed)
        return Step(0, 0.0, RUNS)

    world = World(reset, lambda action: Step(1, -1.0, TERMINAL if action else GOAL))
    problem = Problem("g", 2, 2, (0.0, 0.0), world=world)
    sampler = trained(2, replace(SETTINGS, episodes=2 * CHUNK, base="env"), problem)
    assert [seed is not None for seed in seeds] == ([True] + [False] * (CHUNK - 1)) * 2
    assert seeds[0] != seeds[CHUNK]
    assert set(sampler.outcomes) == {GOAL, TERMINAL}
    assert sampler.returns == [-1.0] * 50


def test_the_base_reward_is_the_specs_or_the_environments():
    assert pay(Step(0, -7.0, GOAL), SETTINGS) == 0.875
    assert pay(Step(0, -7.0, VIOLATION), SETTINGS) == -1.125
    own = replace(SETTINGS, base="env")
    assert [pay(Step(0, -7.0, e), own) for e in (RUNS, GOAL, VIOLATION)] == [-7.0, -7.0, -8.0]
