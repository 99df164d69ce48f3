"""The potential that only loses: exact telescoping, the same learner as with shaped rewards, and what it corrects."""

import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from stlspec.learning.promises import TOLERANCE, Promises, promised
from stlspec.learning.qstl import Learner, run_episodes
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, RUNS, TERMINAL, UNTRIED, VIOLATION, base_reward, shaped_reward
from stlspec.learning.task import Task

SETTINGS = Settings("shaped", 40, 0, 30, 0.75, 0.25, 1.0, 0.125, False)


def random_world(seed):
    """Return next states, endings and a reward of up to 8 states; the first one runs on."""
    draw = random.Random(seed)
    n = draw.randint(2, 8)
    transitions = tuple(tuple(draw.randrange(n) for _ in range(3)) for _ in range(n))
    endings = (RUNS, *(draw.choice([RUNS, RUNS, RUNS, GOAL, VIOLATION, TERMINAL]) for _ in range(n - 1)))
    return transitions, endings, [Fraction(draw.randint(-4, 4), 4) for _ in range(n)]


def test_positive_rewards_promise_from_the_least_to_one_and_the_others_nothing():
    assert promised([1.0, 0.5, 0.0, -1.0], 0.5) == (1.0, 0.75, 0.0, 0.0)


@pytest.mark.parametrize("seed", range(200))
def test_the_shaping_of_an_episode_sums_up_to_minus_the_first_potential(seed):
    """With exact fractions, whatever the actions and corrections: hence every policy loses the same.

    F = gamma * Phi(s', t') - Phi(s, t) with Phi at the time of arrival, as Devlin and Kudenko (2012) prove it.
    """
    transitions, endings, reward = random_world(seed)
    gamma, cost, draw = Fraction(3, 4), Fraction(1, 8), random.Random(seed)
    promises = Promises(promised(reward, Fraction(1, 2)), 0)
    table = [[(t, base_reward(endings[t], cost), UNTRIED) for t in row] for row in transitions]
    choices = [[0, 1, 2]] * len(transitions)
    for _ in range(12):
        state, total, discount = 0, Fraction(0), Fraction(1)
        first = here = promises.claims[0]
        for _ in range(12):
            action = draw.randrange(3)
            after, _, ending = table[state][action]
            if ending == UNTRIED:
                ending = endings[after]
                table[state][action] = (*table[state][action][:2], ending)
                promises.note(state, action, after)
                if ending == RUNS:
                    promises.reach(after, promises.claims[state])
                promises.correct([state], table, choices, gamma)
            there = promises.claims[after] if ending == RUNS else 0
            total += discount * shaped_reward(Fraction(0), here, there, gamma)
            discount, state, here = discount * gamma, after, there
            if ending != RUNS:
                break
        assert total == discount * here - first
        assert ending == RUNS or total == -first


@pytest.mark.parametrize("seed", range(50))
def test_the_learner_is_the_one_with_shaped_rewards(seed):
    """Its values less the potential are those of Q-learning, from 0, on base + gamma * Phi(s') - Phi(s)."""
    transitions, endings, reward = random_world(seed)
    task = Task("goal", len(endings), 3, 0, transitions, endings, ((0.0,),) * len(endings))
    learner = Learner(task, SETTINGS, promised([float(r) for r in reward], 0.5))
    if learner.promises is None:
        assert max(reward) <= 0
        return
    run_episodes(learner, SETTINGS.episodes, np.random.default_rng(seed))
    twin = Promises(learner.promises.potentials, 0)
    table = [[(t, base_reward(endings[t], 0.125), UNTRIED) for t in row] for row in transitions]
    q = [[0.0] * 3 for _ in endings]
    uniforms = iter(np.random.default_rng(seed).random(10**5).tolist())
    for _ in range(SETTINGS.episodes):
        state, here = 0, twin.claims[0]
        for _ in range(SETTINGS.max_steps):
            action = int(next(uniforms) * 3)
            after, base, ending = table[state][action]
            if ending == UNTRIED:
                ending = endings[after]
                table[state][action] = (after, base, ending)
                twin.note(state, action, after)
                if ending == RUNS:
                    twin.reach(after, twin.claims[state])
                twin.correct([state], table, [[0, 1, 2]] * len(q), 0.75)
            there, ahead = (twin.claims[after], max(q[after])) if ending == RUNS else (0.0, 0.0)
            target = shaped_reward(base, here, there, 0.75) + 0.75 * ahead
            q[state][action] += 0.25 * (target - q[state][action])
            state, here = after, there
            if ending != RUNS:
                break
    for state, row in enumerate(learner.q):
        assert row == pytest.approx([value + twin.claims[state] for value in q[state]], abs=1e-9)


def test_promises_that_rely_on_each_other_fall_to_nothing():
    """Two states that lead only to each other: each lap costs 1/100 and 1 % of the promise."""
    promises = Promises((0.9, 0.8), 0)
    promises.reach(1, 0.0)
    table = [[(1, -0.01, RUNS)], [(0, -0.01, RUNS)]]
    promises.note(0, 0, 1)
    promises.note(1, 0, 0)
    losses = promises.correct([0], table, [[0], [0]], 0.99)
    assert max(promises.claims) <= TOLERANCE
    assert min(loss for _, loss in losses) > TOLERANCE
    assert promises.correct([0, 1], table, [[0], [0]], 0.99) == []


def test_a_state_with_an_untried_action_keeps_its_promise():
    promises = Promises((0.9, 0.1), 0)
    promises.reach(1, 0.0)
    table = [[(1, -0.01, RUNS), (0, -0.01, UNTRIED)], [(1, -0.01, RUNS)]]
    promises.note(0, 0, 1)
    assert promises.correct([0], table, [[0, 1], [0]], 0.99) == []
    # a forbidden action is no hope either
    assert promises.correct([0], table, [[0], [0]], 0.99) == [(0, pytest.approx(0.9 - (0.99 * 0.1 - 0.01)))]


def test_promises_along_a_demonstration_hold():
    """Phi rises by more than a step costs, and the goal pays 1: nothing to correct."""
    potentials = promised([0.25, 0.5, 0.75, 1.0], 0.5)
    promises = Promises(potentials, 0)
    table = [[(1, -0.01, RUNS)], [(2, -0.01, RUNS)], [(3, 0.99, GOAL)], [(3, 0.99, GOAL)]]
    for state in range(3):
        promises.note(state, 0, state + 1)
        promises.reach(state + 1, promises.claims[state])
    assert promises.correct(range(3), table, [[0]] * 4, 0.99) == []
    assert tuple(promises.claims[:3]) == potentials[:3]


def test_a_state_promises_what_the_one_before_it_did_unless_it_promises_more():
    promises = Promises((0.6, 0.9, 0.0), 0)
    assert promises.reach(1, 0.6) == 0.9
    assert promises.reach(2, 0.9) == 0.9
    assert promises.reach(2, 1.0) == 0
    assert promises.claims == [0.6, 0.9, 0.9]
    assert Promises((0.0, 0.9, 0.6), 0).claims[0] == 0.6


def test_nothing_to_promise_is_plain_learning():
    task = Task("goal", 2, 1, 0, ((1,), (1,)), (RUNS, GOAL), ((0.0,),) * 2)
    assert Learner(task, SETTINGS, [0.0, -1.0]).promises is None
    assert Learner(task, replace(SETTINGS, method="plain"), [0.5, 1.0]).promises is None
    assert Learner(task, SETTINGS, [0.5, 1.0]).promises is not None
