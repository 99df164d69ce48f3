"""Conditions over states, steps and time."""

from types import MappingProxyType

import numpy as np
import pytest

from stlspec import api
from stlspec.envs.catalogue import make_environment
from stlspec.envs.model import Environment
from stlspec.errors import UsageError
from stlspec.learning.goals import Condition
from stlspec.learning.tables import deterministic_transitions, over_steps, over_time, signal_sources, tabulate

WORLD = make_environment("stlspec/GridWorld-v0", None, ("S.#", "..G"))


def code_of(world):
    with pytest.raises(UsageError) as caught:
        deterministic_transitions(world)
    (found,) = caught.value.diagnostics
    return found.code, found.message + found.help


def predicate(text):
    bundle = api.compile(f"signal d_obs\nsignal row\nsignal col\nsoft a: {text}")
    return bundle, bundle.requirements[0].root


def test_a_condition_is_a_table_over_states():
    """By hand: the obstacle of S.# / ..G is at (0, 2)."""
    bundle, root = predicate("d_obs > 1")
    held, lost = Condition(root), Condition(root, True)
    values, holds = tabulate(bundle, [held, lost], WORLD)
    assert values[held] == [1, 0, -1, 2, 1, 0]
    assert values[lost] == [-1, 0, 1, -2, -1, 0]
    assert holds[held] == [value > 1 for value in (2, 1, 0, 3, 2, 1)]
    assert holds[lost] == [value <= 1 for value in (2, 1, 0, 3, 2, 1)]


def test_a_change_is_a_table_over_steps():
    bundle, root = predicate("delta(row) > 0 or delta(col) < 0")
    assert over_steps(bundle, [root], WORLD, [(0, 3), (3, 0), (1, 0), (4, 4)]) == [[True, False, True, False]]


def test_time_is_a_table_over_samples_and_states():
    bundle, root = predicate("now >= col + 1")
    (table,) = over_time(bundle, [root], WORLD, 3)
    assert table.tolist() == [[t >= c + 1 for c in (0, 1, 2, 0, 1, 2)] for t in range(4)]


def test_time_counts_in_the_unit_of_the_spec():
    bundle = api.compile("time 500 ms\nsignal row\nsoft a: now >= 1000 ms")
    (table,) = over_time(bundle, [bundle.requirements[0].root], WORLD, 3)
    assert table[:, 0].tolist() == [False, False, True, True]


def test_a_signal_that_the_environment_does_not_offer_is_refused_with_those_it_does():
    bundle = api.compile("signal height\nsoft g: eventually (height < 1)")
    with pytest.raises(UsageError) as caught:
        signal_sources(bundle, {"height"}, WORLD)
    (found,) = caught.value.diagnostics
    assert found.code == "D870"
    assert "height" in found.message
    assert "d_goal" in found.help


def test_a_signal_is_read_from_the_name_in_its_declaration():
    bundle = api.compile('signal height from "row"\nsoft g: eventually (height > 0)')
    assert signal_sources(bundle, {"height"}, WORLD) == {"height": "row"}


def test_chance_is_refused_with_the_way_out():
    code, text = code_of(make_environment("FrozenLake-v1"))
    assert code == "D869"
    assert "--env-arg is_slippery=false" in text


@pytest.mark.parametrize(
    "fields",
    [
        {"n_states": 0},
        {"n_states": 2, "binned": True},
        {"n_states": 2, "n_actions": 1},
        {"n_states": 2, "n_actions": 1, "table": np.array([[0], [1]]), "deterministic": True},
        {"n_states": 100_001, "table": np.zeros((100_001, 1), int), "deterministic": True, "start": 0},
    ],
)
def test_an_environment_without_a_deterministic_table_is_refused(fields):
    world = Environment("x", MappingProxyType({}), signal_names=("d_goal",), **fields)
    assert code_of(world)[0] == "D869"


@pytest.mark.parametrize("source", ["obs[1]", "d_obstacle"])
def test_a_declared_source_is_never_replaced_by_a_signal_of_the_same_name(source):
    """Scoring reads obs[1]; learning on the environment's own d_obs would report success for another spec."""
    spec = f'signal d_obs from "{source}"\nsoft avoid: always (d_obs >= 1)'
    with pytest.raises(UsageError) as caught:
        signal_sources(api.compile(spec), {"d_obs"}, WORLD)
    (found,) = caught.value.diagnostics
    assert found.code == "D870"
    assert f"'{source}'" in found.message and "'d_obs'" in found.message
