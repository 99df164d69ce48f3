"""The reward of a step, and the proof that shaping changes no optimal policy."""

import random
from fractions import Fraction
from itertools import product

import pytest

from stlspec.learning.shaping import GOAL, RUNS, TERMINAL, VIOLATION, base_reward, moves, shaped_reward


@pytest.mark.parametrize(
    ("ending", "expected"), [(GOAL, "3/4"), (VIOLATION, "-5/4"), (RUNS, "-1/4"), (TERMINAL, "-1/4")]
)
def test_base_reward_is_the_ending_less_the_cost_of_a_step(ending, expected):
    assert base_reward(ending, Fraction(1, 4)) == Fraction(expected)


def test_shaping_adds_the_discounted_gain_of_potential():
    assert shaped_reward(Fraction(-1, 4), Fraction(1, 2), Fraction(2, 3), Fraction(3, 4)) == Fraction(-1, 4)
    assert shaped_reward(Fraction(1), Fraction(1, 2), Fraction(0), Fraction(3, 4)) == Fraction(1, 2)


def test_moves_have_no_potential_where_an_episode_ends():
    """State 1 is the goal; entering it forfeits its potential, staying in state 0 does not."""
    table = moves(((0, 1), (1, 1)), (RUNS, GOAL), (0.5, 100.0), 0.5, 0.25)
    assert table[0] == [(0, -0.25 + 0.25 - 0.5, RUNS), (1, 0.75 - 0.5, GOAL)]


def test_moves_without_potential_are_the_base_reward():
    assert moves(((0, 1), (1, 1)), (RUNS, VIOLATION), None, 0.5, 0.25)[0] == [
        (0, -0.25, RUNS),
        (1, -1.25, VIOLATION),
    ]


def value(table, policy, start, gamma):
    """Follow a policy to its end or round its cycle, and sum up exactly."""
    rewards, seen, state, ending = [], {}, start, RUNS
    while ending == RUNS and state not in seen:
        seen[state] = len(rewards)
        state, reward, ending = table[state][policy[state]]
        rewards.append(reward)
    total = sum(reward * gamma**k for k, reward in enumerate(rewards))
    if ending == RUNS:
        entry = seen[state]
        lap = rewards[entry:]
        cycle = sum(reward * gamma**k for k, reward in enumerate(lap)) / (1 - gamma ** len(lap))
        total += gamma ** len(rewards) * cycle
    return total


@pytest.mark.parametrize("seed", range(25))
def test_shaping_keeps_every_difference_between_policies(seed):
    """With exact fractions: shaped values are the plain ones less Phi(start), whatever the policy."""
    draw = random.Random(seed)
    endings = (RUNS, RUNS, RUNS, GOAL, VIOLATION, TERMINAL)
    transitions = [[draw.randrange(6) for _ in range(2)] for _ in range(6)]
    potentials = [Fraction(draw.randint(-8, 8), 8) for _ in range(6)]
    gamma, cost = Fraction(9, 10), Fraction(1, 100)
    plain = moves(transitions, endings, None, gamma, cost)
    shaped = moves(transitions, endings, potentials, gamma, cost)
    for policy, start in product(product(range(2), repeat=3), range(3)):
        difference = value(plain, policy, start, gamma) - value(shaped, policy, start, gamma)
        assert difference == potentials[start]
