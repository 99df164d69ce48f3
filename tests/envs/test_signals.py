import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from stlspec.envs.maps import GRIDWORLD, parse_map
from stlspec.envs.signals import field, grid_signals, manhattan, signal_names

MASKS = hnp.arrays(np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=7))


def naive(marked, row, column):
    """The definition: the least sum of row and column differences to a marked cell."""
    cells = [(r, c) for r in range(marked.shape[0]) for c in range(marked.shape[1]) if marked[r, c]]
    return min((abs(r - row) + abs(c - column) for r, c in cells), default=math.inf)


@given(MASKS)
def test_distances_follow_the_definition(marked):
    expected = [[naive(marked, r, c) for c in range(marked.shape[1])] for r in range(marked.shape[0])]
    assert manhattan(marked).tolist() == expected


@given(MASKS, st.data())
def test_neighbours_differ_by_at_most_one(marked, data):
    distances = manhattan(marked)
    if marked.any():
        assert np.abs(np.diff(distances, axis=0)).max(initial=0) <= 1
        assert np.abs(np.diff(distances, axis=1)).max(initial=0) <= 1


def test_without_a_mark_every_distance_is_infinite():
    assert manhattan(np.zeros((2, 3), dtype=bool)).tolist() == [[math.inf] * 3] * 2


GRID = parse_map(["S.#", ".aG", "2.b"], GRIDWORLD)


def test_a_grid_offers_its_signals_by_name():
    assert signal_names(GRID) == tuple("row col d_obs d_goal d_goal_1 d_goal_2 in_a d_a in_b d_b".split())


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("row", [0, 0, 0, 1, 1, 1, 2, 2, 2]),
        ("col", [0, 1, 2, 0, 1, 2, 0, 1, 2]),
        ("d_obs", [2, 1, 0, 3, 2, 1, 4, 3, 2]),
        ("d_goal", [2, 2, 1, 1, 1, 0, 0, 1, 1]),
        ("d_goal_1", [3, 2, 1, 2, 1, 0, 3, 2, 1]),
        ("d_goal_2", [2, 3, 4, 1, 2, 3, 0, 1, 2]),
        ("in_a", [False] * 4 + [True] + [False] * 4),
        ("d_a", [2, 1, 2, 1, 0, 1, 2, 1, 2]),
    ],
)
def test_the_signals_of_a_small_grid_are_those_counted_by_hand(name, expected):
    values = field(GRID, name)
    assert values.tolist() == expected
    assert values.dtype == (np.bool_ if name == "in_a" else np.float64)


def test_kept_fields_cannot_be_changed_through_a_result():
    assert not field(GRID, "row").flags.writeable
    first = grid_signals(GRID, ["row"], np.array([0, 8]))["row"]
    first[:] = 7
    assert grid_signals(GRID, ["row"], np.array([0, 8]))["row"].tolist() == [0, 2]


def test_signals_follow_the_cells_in_their_order():
    found = grid_signals(GRID, ["d_obs", "in_a"], np.array([4, 2, 4]))
    assert found["d_obs"].tolist() == [2, 0, 2]
    assert found["in_a"].tolist() == [True, False, True]


def test_no_obstacle_is_infinitely_far_away():
    assert field(parse_map(["S."], GRIDWORLD), "d_obs").tolist() == [math.inf, math.inf]
