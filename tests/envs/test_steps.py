"""Recorded steps against what an environment can do."""

import numpy as np
import pytest

from stlspec.envs.catalogue import make_environment
from stlspec.envs.steps import wrong_step

GRID = make_environment("stlspec/GridWorld-v0", None, ("S..G", "...."))
ICE = make_environment("FrozenLake-v1", None, ("SFFG", "FFFF"))


@pytest.mark.parametrize(
    ("states", "actions", "expected"),
    [
        ([0, 1, 2, 3], [2, 2, 2], None),
        ([0, 1, 2, 3], None, None),
        ([0, 0, 1], [0, 2], None),  # the border keeps one in place
        ([0, 1, 3], None, (1, "no action leads from [0, 1] to [0, 3]", False, 1)),
        ([0, 2, 3, 1], None, (0, "no action leads from [0, 0] to [0, 2]", False, 2)),
        ([2, 3, 4], None, (1, "no action leads from [0, 3] to [1, 0]", False, 1)),
        ([0, 1, 2], [2, 1], (1, "action 1 does not lead from [0, 1] to [0, 2], but action 2 does", True, 1)),
        ([0, 0], [2], (0, "action 2 does not lead from [0, 0] to [0, 0], but action 0 or 3 does", True, 1)),
        ([0, 1, 2], [9, 9], (0, "its action is 9, and actions are 0 to 3", True, 2)),
        ([0, 1], ["R"], (0, "its action is 'R', and actions are 0 to 3", True, 1)),
        ([0, 1], [2.5], (0, "its action is 2.5, and actions are 0 to 3", True, 1)),
        ([0, 1, 2, 3, 3], [None, np.int64(2), [2.0], float("nan")], None),
        ([0], [], None),
    ],
)
def test_the_first_step_that_cannot_be_is_found(states, actions, expected):
    found = wrong_step(GRID, states, actions)
    assert (found and (found.sample, found.what, found.by_action, found.count)) == expected


@pytest.mark.parametrize(
    ("states", "actions", "wrong"),
    [
        ([0, 1], [1], False),  # on ice, down may slip to either side
        ([0, 4], [1], False),
        ([0, 1], [0], True),  # left slips up or down
        ([0, 2], None, True),
    ],
)
def test_by_chance_what_can_happen_counts(states, actions, wrong):
    assert (wrong_step(ICE, states, actions) is not None) == wrong


def test_nothing_is_said_where_transitions_are_not_known():
    assert wrong_step(make_environment("MountainCar-v0"), [0, 99], [7]) is None
