"""The reward of a step, and the proof that shaping changes no optimal policy."""

import random
from fractions import Fraction

import pytest

from stlspec.learning.shaping import GOAL, RUNS, TERMINAL, VIOLATION, base_reward, moves, shaped_reward


@pytest.mark.parametrize(
    ("ending", "expected"), [(GOAL, "3/4"), (VIOLATION, "-5/4"), (RUNS, "-1/4"), (TERMINAL, "-5/4")]
)
def test_base_reward_is_the_ending_less_the_cost_of_a_step(ending, expected):
    assert base_reward(ending, Fraction(1, 4)) == Fraction(expected)


def test_shaping_adds_the_discounted_gain_of_potential():
    assert shaped_reward(Fraction(-1, 4), Fraction(1, 2), Fraction(2, 3), Fraction(3, 4)) == Fraction(-1, 4)
    assert shaped_reward(Fraction(1), Fraction(1, 2), Fraction(0), Fraction(3, 4)) == Fraction(1, 2)


def test_moves_pay_the_base_reward():
    assert moves(((0, 1), (1, 1)), (RUNS, VIOLATION), 0.25)[0] == [(0, -0.25, RUNS), (1, -1.25, VIOLATION)]
    assert moves(((0, 1), (1, 1)), (RUNS, GOAL), 0.25)[0] == [(0, -0.25, RUNS), (1, 0.75, GOAL)]
    paid = moves(((0, 1), (1, 1)), (RUNS, GOAL), 0.25, payoffs=(-0.5, 2.0))
    assert paid == [[(0, -0.75, RUNS), (1, 2.75, GOAL)], [(1, 2.75, GOAL), (1, 2.75, GOAL)]]


def solve(matrix, right):
    """Solve a small linear system by elimination, exactly."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for k in range(len(rows)):
        pivot = next(i for i in range(k, len(rows)) if rows[i][k])
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(len(rows)):
            if i != k:
                rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k], strict=True)]
    return [row[-1] for row in rows]


def best_actions(mdp, gamma):
    """Return the set of optimal actions of every state by policy iteration, exactly.

    mdp: [state][action] = list of (probability, reward, next state or None where the episode ends).
    """
    n, policy = len(mdp), [0] * len(mdp)
    while True:
        matrix = [[Fraction(i == j) for j in range(n)] for i in range(n)]
        right = [Fraction(0)] * n
        for state in range(n):
            for probability, reward, after in mdp[state][policy[state]]:
                right[state] += probability * reward
                if after is not None:
                    matrix[state][after] -= gamma * probability
        values = solve(matrix, right)
        q = [
            [sum(p * (r + (gamma * values[t] if t is not None else 0)) for p, r, t in branches) for branches in actions]
            for actions in mdp
        ]
        better = [max(range(len(row)), key=row.__getitem__) for row in q]
        if all(q[s][better[s]] == q[s][policy[s]] for s in range(n)):
            return [{a for a, value in enumerate(row) if value == max(row)} for row in q]
        policy = better


def random_mdp(seed):
    """Return an MDP of 2 to 6 states, its discount, and a potential; small whole numbers, so that ties occur."""
    draw = random.Random(seed)
    n, gamma = draw.randint(2, 6), Fraction(draw.randint(1, 9), 10)
    mdp = []
    for _ in range(n):
        actions = []
        for _ in range(draw.randint(2, 3)):
            weights = [draw.randint(1, 3) for _ in range(draw.randint(1, 3))]
            actions.append(
                [
                    (Fraction(w, sum(weights)), Fraction(draw.randint(-2, 2)), draw.choice([None, *range(n)]))
                    for w in weights
                ]
            )
        mdp.append(actions)
    return mdp, gamma, [Fraction(draw.randint(-8, 8), 4) for _ in range(n)]


def shaped(mdp, gamma, potentials, at_the_end):
    return [
        [
            [
                (p, shaped_reward(r, potentials[s], at_the_end if t is None else potentials[t], gamma), t)
                for p, r, t in b
            ]
            for b in actions
        ]
        for s, actions in enumerate(mdp)
    ]


@pytest.mark.parametrize("seed", range(200))
def test_shaping_keeps_the_set_of_optimal_actions_of_every_state(seed):
    mdp, gamma, potentials = random_mdp(seed)
    assert best_actions(shaped(mdp, gamma, potentials, 0), gamma) == best_actions(mdp, gamma)


def test_a_potential_at_the_end_of_an_episode_breaks_it():
    """Ending pays 1, going round pays 0 for ever; with Phi(end) = -3 and gamma = 1/2 going round looks better."""
    half = Fraction(1, 2)
    mdp = [[[(Fraction(1), Fraction(1), None)], [(Fraction(1), Fraction(0), 0)]]]
    assert best_actions(mdp, half) == [{0}]
    assert best_actions(shaped(mdp, half, [Fraction(0)], Fraction(-3)), half) == [{1}]
    broken = 0
    for seed in range(200):
        mdp, gamma, potentials = random_mdp(seed)
        broken += best_actions(shaped(mdp, gamma, potentials, Fraction(-3)), gamma) != best_actions(mdp, gamma)
    assert broken >= 30


def test_optimal_actions_are_found_by_hand():
    """State 0: ending pays 1; going to 1 pays 0, and 1 pays 3 at the end: 1 < 1/2 * 3. A tie at gamma = 1/3."""
    one = Fraction(1)
    mdp = [[[(one, one, None)], [(one, 0 * one, 1)]], [[(one, 3 * one, None)], [(one, 3 * one, None)]]]
    assert best_actions(mdp, Fraction(1, 2)) == [{1}, {0, 1}]
    assert best_actions(mdp, Fraction(1, 3)) == [{0, 1}, {0, 1}]
