"""A policy that remembers: stages, and what happened before."""

import json
import math

import pytest

from stlspec.documents import DamageError
from stlspec.learning.route import Route, Stage, Walk, read_route

ROUTE = Route(
    places=(0, 1, 2, 1),
    start=0,
    transitions=((1, 0), (0, 2), (3, 2), (2, 3)),
    stages=(
        Stage("a", frozenset({2}), (0, 1, 0, 0), ((0.0, 0.0),) * 4),
        Stage("b", frozenset({0}), (1, 0, 0, 1), ((0.0, -math.inf),) * 4),
    ),
)
"""From place 0 over 1 to 2, which is a; from there place 1 is another learner state than on the way there."""


def test_the_action_depends_on_the_stage_and_on_what_happened():
    walk = Walk(ROUTE)
    assert [walk.step(place) for place in (0, 1, 2, 1)] == [0, 1, 0, 1]
    assert (walk.stage, walk.state) == (1, 3)
    walk.reset()
    assert [walk.step(place) for place in (0, 1)] == [0, 1]
    assert walk.stage == 0


def test_who_is_moved_goes_on_from_there():
    walk = Walk(ROUTE)
    assert walk.step(2) == 0  # begins elsewhere than the start, and at the first goal
    assert walk.stage == 1
    assert walk.step(0) == 1  # no learner state in place 0 follows on one in place 2
    assert (walk.stage, walk.state) == (1, 0)


def test_a_place_without_a_learner_state_changes_nothing():
    walk = Walk(ROUTE)
    walk.step(0)
    assert walk.step(9) is None
    assert walk.state == 0
    assert walk.step(1) == 1


def test_a_route_comes_back_from_json():
    assert read_route(json.loads(json.dumps(ROUTE.to_json())), 3, 2) == ROUTE


@pytest.mark.parametrize(
    "change",
    [
        {"places": [0, 1, 3, 1]},
        {"places": [0, 1, 2]},
        {"places": "x"},
        {"start": 4},
        {"start": True},
        {"transitions": [[1, 0], [0, 2], [3, 2], [2, 4]]},
        {"transitions": [[1, 0], [0, 2], [3, 2], [2]]},
        {"stages": []},
        {"stages": [{}]},
        {"stages": [{"goal": "a", "reached": [9], "actions": [0] * 4, "q": [[0, 0]] * 4}]},
        {"stages": [{"goal": "a", "reached": [], "actions": [0] * 3, "q": [[0, 0]] * 4}]},
        {"stages": [{"goal": "a", "reached": [], "actions": [0, 0, 0, 2], "q": [[0, 0]] * 4}]},
        {"stages": [{"goal": "a", "reached": [], "actions": [0] * 4, "q": [[0, "x"]] * 4}]},
        {"stages": [{"goal": "a", "reached": [], "actions": [0] * 4, "q": [[0, 10**400]] * 4}]},
    ],
)
def test_a_damaged_route_is_refused(change):
    with pytest.raises(DamageError):
        read_route({**ROUTE.to_json(), **change}, 3, 2)
    with pytest.raises(DamageError):
        read_route(None, 3, 2)
