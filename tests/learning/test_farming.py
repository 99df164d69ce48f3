"""Circling for reward, with returns recomputed by summing ten thousand steps."""

import math

import pytest

from stlspec.learning.farming import (
    Farming,
    circling_return,
    describe,
    discounted,
    find_farming,
    first_cycle,
    shortest_safe_path,
)
from stlspec.learning.shaping import GOAL, RUNS, VIOLATION
from stlspec.learning.task import Task

# 0 -> 1 -> 2 -> 1 ..., 2 -> 3 goal, 1 -> 4 violates, 4 -> 3
TRANSITIONS = ((1, 0), (2, 4), (1, 3), (3, 3), (3, 3))
ENDINGS = (RUNS, RUNS, RUNS, GOAL, VIOLATION)
ROBUSTNESS = ((5.0, 1.0), (4.0, 2.0), (3.0, math.inf), (9.0, 9.0), (-1.0, 0.0))
TASK = Task("goal", 5, 2, 0, TRANSITIONS, ENDINGS, ROBUSTNESS)
REWARD = (0.0, 0.2, 0.4, 1.0, -1.0)


def naive_return(states, gamma):
    """Walk along states with the paper's reward: R(s') plus, for each hard requirement, its minimum so far."""
    total = 0.0
    for k in range(1, len(states)):
        lows = [min(ROBUSTNESS[s][h] for s in states[: k + 1][-50:] + states[:2]) for h in (0, 1)]
        total += gamma ** (k - 1) * (REWARD[states[k]] + sum(lows))
    return total


@pytest.mark.parametrize(
    ("path", "expected"), [((0, 1, 2), (0, 0)), ((0, 0, 0), (0, 1)), ((0, 1, 2, 1, 2), (1, 2)), ((3,), (0, 0))]
)
def test_the_first_repeated_state_is_where_the_cycle_begins(path, expected):
    assert first_cycle(path) == expected


def test_circling_and_going_to_the_goal_are_compared_from_where_the_cycle_begins():
    gamma = 0.9
    found = find_farming(TASK, (0, 1, 2, 1, 2, 1), REWARD, gamma)
    assert found.cycle == (1, 2)
    assert found.to_goal == (1, 2, 3)
    # the state before the cycle counts for the minima, but its step does not count for the return
    circle = naive_return([0] + [1, 2] * 500, gamma)
    entering = REWARD[1] + min(5.0, 4.0) + min(1.0, 2.0)
    assert found.return_cycle == pytest.approx((circle - entering) / gamma)
    assert found.return_goal == pytest.approx((naive_return([0, 1, 2, 3], gamma) - entering) / gamma)
    assert found.return_cycle > found.return_goal


def test_a_path_that_arrives_does_not_farm():
    assert find_farming(TASK, (0, 1, 2, 3), REWARD, 0.9) is None


def test_returns_are_geometric_series():
    assert discounted([1.0, 2.0, 4.0], 0.5) == 3.0
    assert circling_return([1.0], [1.0], 0.5) == 2.0
    assert circling_return([5.0, 0.0], [0.0, 1.0], 0.5) == pytest.approx(5.0 + 0.25 * 0.5 / 0.75)
    assert circling_return([1.0], [1.0], 0.0) == 1.0
    assert circling_return([1.0], [1.0], 1.0) == math.inf
    assert circling_return([1.0], [-1.0], 1.0) == -math.inf
    assert circling_return([1.0], [0.0], 1.0) == 1.0


def test_the_shortest_path_goes_round_what_violates():
    assert shortest_safe_path(TRANSITIONS, ENDINGS, 0) == (0, 1, 2, 3)
    assert shortest_safe_path(TRANSITIONS, ENDINGS, 3) == (3,)
    assert shortest_safe_path(((1,), (0,)), (RUNS, RUNS), 0) is None
    assert shortest_safe_path(((1,), (2,), (2,)), (RUNS, VIOLATION, GOAL), 0) is None


def test_the_report_names_the_cycle_and_both_returns():
    text = describe(Farming((1, 2), 30.123456, (1, 2, 3), 4.5), ("a", "b", "c", "d"))
    assert "b -> c -> b" in text
    assert "30.12" in text
    assert "4.5" in text
    assert "no safe path" in describe(Farming((1,), 1.0, None, None), ("a", "b"))
    assert "does not farm" in describe(None, ())


def test_without_a_safe_path_there_is_no_return_to_compare():
    task = Task("goal", 2, 1, 0, ((1,), (0,)), (RUNS, RUNS), ((1.0,), (1.0,)))
    found = find_farming(task, (0, 1, 0), (0.0, 0.0), 0.5)
    assert (found.to_goal, found.return_goal) == (None, None)
    assert found.return_cycle == 2.0
