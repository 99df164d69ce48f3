"""Greedy paths, acting, and policy files that were tampered with."""

import json
import math
from types import MappingProxyType

import numpy as np
import pytest

from stlspec.errors import DataError
from stlspec.learning import policy
from stlspec.learning.policy import Policy, greedy_action, greedy_path, load_policy
from stlspec.learning.shaping import GOAL, RUNS

GRID = Policy(
    MappingProxyType({"id": "x", "args": {}, "map": ["S.", ".G"]}),
    2,
    ((0, 0), (0, 1), (1, 0), (1, 1)),
    (1, 0, 1, 0),
    ((0.0, 1.5), (0.1, -math.inf), (0.0, 1e-300), (0.0, 0.0)),
)


def code(found):
    return found.value.diagnostics[0].code


def test_ties_go_to_the_lowest_action():
    assert greedy_action([0.5, 1.0, 1.0]) == 1


def test_the_greedy_path_stops_where_an_episode_ends():
    states, actions = greedy_path([[0, 1], [1, 0], [0, 0]], ((0, 1), (2, 0), (2, 2)), (RUNS, RUNS, GOAL), 0, 9)
    assert (states, actions) == ((0, 1, 2), (1, 0))


@pytest.mark.parametrize("limit", range(1, 12))
def test_a_path_that_circles_is_followed_to_the_step_limit(limit):
    """0 -> 1 -> 2 -> 1 -> 2 ..., compared with walking step by step."""
    transitions, q = ((1, 0), (0, 2), (1, 1)), [[1, 0], [0, 1], [0, 0]]
    states, actions = [0], []
    for _ in range(limit):
        actions.append(q[states[-1]].index(max(q[states[-1]])))
        states.append(transitions[states[-1]][actions[-1]])
    assert greedy_path(q, transitions, (RUNS,) * 3, 0, limit) == (tuple(states), tuple(actions))


def test_a_start_at_the_goal_needs_no_action():
    assert greedy_path([[0]], ((0,),), (GOAL,), 0, 5) == ((0,), ())


@pytest.mark.parametrize(
    "observation", [1, np.int64(1), np.array(1), [0, 1], (0, 1), np.array([0, 1]), (np.int32(0), np.int8(1))]
)
def test_a_policy_acts_on_numbers_and_on_rows_and_columns(observation):
    assert GRID.act(observation) == 0


@pytest.mark.parametrize("observation", [4, -1, [2, 0], [0], 0.5, "a", None, [0.5, 1], [[0, 1]], {}])
def test_an_observation_that_is_no_state_is_refused(observation):
    with pytest.raises(DataError) as caught:
        GRID.act(observation)
    assert code(caught) == "D874"


def test_a_policy_comes_back_from_its_file_as_it_was(tmp_path):
    place = tmp_path / "policy.json"
    place.write_text(json.dumps(GRID.to_json()))
    assert load_policy(place) == GRID
    assert load_policy(str(tmp_path)) == GRID


@pytest.mark.parametrize(
    "change",
    [
        {"schema": "stlspec.policy/2"},
        {"env": None},
        {"n_actions": 0},
        {"n_actions": True},
        {"states": []},
        {"states": [[0, 0], [0, 0], [1, 0], [1, 1]]},
        {"states": [[0, 0], [0], [1, 0], [1, 1]]},
        {"states": [-1, 0, 1, 2]},
        {"actions": [0, 1]},
        {"actions": [0, 1, 2, 0]},
        {"actions": [0, 1, 0.0, 0]},
        {"q": [[0, 0]] * 3 + [[0]]},
        {"q": [[0, 0]] * 3 + [[0, "nan"]]},
        {"q": [[0, 0]] * 3 + [[0, math.nan]]},
        {"q": [[0, 0]] * 3 + [[0, 10**400]]},
        {"q": "x"},
    ],
)
def test_a_damaged_policy_is_refused(tmp_path, change):
    place = tmp_path / "policy.json"
    place.write_text(json.dumps({**GRID.to_json(), **change}))
    with pytest.raises(DataError) as caught:
        load_policy(place)
    assert code(caught) == "D873"
    assert caught.value.diagnostics[0].file == str(place)


@pytest.mark.parametrize("content", [b"", b"{", b"\xff", b"[]", b"3", b"[" * 100_000])
def test_what_is_no_policy_at_all_is_refused(tmp_path, content):
    place = tmp_path / "policy.json"
    place.write_bytes(content)
    with pytest.raises(DataError) as caught:
        load_policy(place)
    assert code(caught) == "D873"


def test_a_missing_policy_is_refused(tmp_path):
    with pytest.raises(DataError) as caught:
        load_policy(tmp_path)
    assert code(caught) == "D873"


def test_an_endless_file_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(policy, "_LARGEST_FILE", 1000)
    (tmp_path / "policy.json").symlink_to("/dev/zero")
    with pytest.raises(DataError) as caught:
        load_policy(tmp_path)
    assert code(caught) == "D873"
    assert "larger" in str(caught.value)
