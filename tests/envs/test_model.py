import json
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.envs.catalogue import make_environment
from stlspec.envs.model import Environment
from stlspec.errors import DataError

MAP = ("S.#", "..G")
GRID = make_environment("stlspec/GridWorld-v0", {}, MAP)
CAR = make_environment("MountainCar-v0")


@given(st.integers(0, 5))
def test_a_state_survives_its_name(number):
    assert GRID.encode(GRID.decode(number)) == number
    assert GRID.decode(number) == [number // 3, number % 3]


@pytest.mark.parametrize("state", [5, 5.0, np.int64(5), [1, 2], (1, 2), [1.0, 2.0], np.array([1, 2])])
def test_a_state_may_be_a_number_or_a_row_and_column(state):
    assert GRID.encode(state) == 5


@pytest.mark.parametrize(
    "state",
    [6, -1, 0.5, "0", None, {}, [], [0], [0, 3], [2, 0], [0, -1], [-1, 0], [0, True], [0, 0, 0], [[0], 0],
     float("nan"), float("inf"), 10**400, [10**30, 0], np.array(3.5), np.zeros((2, 2))],
)  # fmt: skip
def test_what_is_no_state_is_refused(state):
    for call in (GRID.encode, lambda s: GRID.encode_all([0, s])):
        with pytest.raises(DataError) as error:
            call(state)
        assert [d.code for d in error.value.diagnostics] == ["D827"]
        assert "row 0 to 1 and col 0 to 2" in error.value.diagnostics[0].help


def test_a_boolean_is_no_state():
    with pytest.raises(DataError):
        GRID.encode(True)


def test_the_first_sample_that_is_no_state_is_named_with_its_file():
    with pytest.raises(DataError) as error:
        GRID.encode_all([[0, 0], [0, 1], [9, 9], [8, 8]], file="d.json")
    assert "[9, 9]" in str(error.value) and "sample 2" in str(error.value) and "d.json" in str(error.value)


@pytest.mark.parametrize("states", [[[0, 1], [1, 2]], [1, 5], [1, [1, 2]], np.array([[0, 1], [1, 2]]), range(1, 6, 4)])
def test_many_states_are_numbered_at_once(states):
    numbers = GRID.encode_all(states)
    assert numbers.tolist() == [1, 5] and numbers.dtype == np.int64


def test_no_states_are_no_numbers():
    assert GRID.encode_all([]).tolist() == []


def test_signals_are_computed_from_either_form_of_state():
    for states in ([[0, 0], [0, 1]], [0, 1]):
        found = GRID.signals(["d_obs", "d_goal"], states)
        assert {k: v.tolist() for k, v in found.items()} == {"d_obs": [2, 1], "d_goal": [3, 2]}


def test_raw_states_give_signals_and_have_no_numbers():
    found = CAR.signals(["velocity"], [[-0.5, 0.01], [-0.4, 0.02]])
    assert found["velocity"].tolist() == [0.01, 0.02]
    for call in (lambda: CAR.encode([0, 0]), lambda: CAR.encode_all([[0, 0]])):
        with pytest.raises(DataError) as error:
            call()
        assert error.value.diagnostics[0].code == "D828"


@pytest.mark.parametrize("state", [[1], [1, 2, 3], 3, None, "ab", [[1], 2]])
def test_a_raw_state_of_another_shape_is_refused(state):
    with pytest.raises(DataError, match="sample 1") as error:
        CAR.signals(["position"], [[0, 0], state])
    assert error.value.diagnostics[0].code == "D827"


def test_transitions_are_the_table_as_tuples():
    assert GRID.transitions == tuple(map(tuple, GRID.table.tolist()))
    assert Environment("x").transitions is None


def test_the_fingerprint_depends_on_obstacles_but_not_on_the_start():
    def fingerprint(*rows):
        return make_environment("stlspec/GridWorld-v0", {}, rows).fingerprint

    assert fingerprint("S.#", "..G") == fingerprint("..#", "S.G")
    # The moves are the same, but a cell that was free is an obstacle now.
    assert fingerprint("S.#", "..G") != fingerprint("S.#", ".#G")
    assert fingerprint("S.#", "..G") != fingerprint("S.#", ".G.")
    assert fingerprint("S.") != fingerprint("S", ".")
    assert CAR.fingerprint is None


def test_the_description_makes_the_same_environment_again():
    for environment in (GRID, CAR, make_environment("FrozenLake-v1", {"is_slippery": False})):
        told = json.loads(json.dumps(environment.describe()))
        again = make_environment(told["id"], told["args"], told["map"])
        assert again.describe() == environment.describe()
        assert again.fingerprint == environment.fingerprint


def test_an_environment_can_be_sent_to_another_process():
    again = pickle.loads(pickle.dumps(GRID))
    assert again.fingerprint == GRID.fingerprint
    assert again.signals(["row"], [5])["row"].tolist() == [1]
