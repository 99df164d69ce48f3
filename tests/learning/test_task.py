"""Goals and hard requirements as tables over states."""

from types import MappingProxyType

import numpy as np
import pytest

from stlspec import api
from stlspec.envs.catalogue import make_environment
from stlspec.envs.model import Environment
from stlspec.errors import UsageError
from stlspec.learning.shaping import GOAL, RUNS, TERMINAL, VIOLATION
from stlspec.learning.task import (
    Task,
    find_goals,
    followed,
    goal_name,
    lifted,
    make_task,
    momentary,
    place,
    step_conditions,
)

HEAD = "signal d_obs\nsignal d_goal\nsignal row\n"
WORLD = make_environment("stlspec/GridWorld-v0", None, ("S.#", "..G"))


def compiled(text):
    return api.compile(HEAD + text)


def goals(text):
    bundle = compiled(text)
    return [goal_name(bundle, goal) for goal in find_goals(bundle)]


def code_of(text, world=WORLD):
    with pytest.raises(UsageError) as caught:
        make_task(compiled(text), world)
    (found,) = caught.value.diagnostics
    return found.code, found.message + found.help


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("eventually (d_goal < 1)", ["d_goal < 1"]),
        ("eventually[0, 9] (d_goal < 1)", ["d_goal < 1"]),
        ("eventually (d_goal < 1) and eventually[2, 4] (d_goal < 1)", ["d_goal < 1"]),
        ("not always (d_goal >= 1)", ["not (d_goal >= 1)"]),
        ("not eventually (d_obs < 1)", []),
        ("always (d_obs >= 1)", []),
        ("eventually always (d_goal < 1)", []),
        ("eventually (delta(row) > 0)", []),
        ("eventually (now > 3)", []),
        ("always eventually (d_goal < 1)", ["d_goal < 1"]),
        ("d_obs > 2 implies eventually (d_goal < 1)", ["d_goal < 1"]),
        ("eventually (row < 1) implies d_obs > 2", []),
    ],
)
def test_goals_are_the_state_predicates_that_are_wanted_eventually(formula, expected):
    assert goals(f"soft a: {formula}") == expected


def test_a_goal_goes_by_the_name_of_its_let():
    assert goals("let home = d_goal < 1\nsoft a: eventually home") == ["home"]


def test_momentary_formulas_look_at_the_present_only():
    bundle = compiled("soft a: d_obs + 1 > 2 and not (row < delta(row))")
    found = dict(zip((node.op for node in bundle.nodes), momentary(bundle.nodes), strict=True))
    assert found["gt"]
    assert not found["delta"]
    assert not found["lt"]
    assert not found["and"]


@pytest.mark.parametrize(
    ("formula", "count"),
    [
        ("always (d_obs >= 1)", 1),
        ("always[0, inf] (d_obs >= 1)", 1),
        ("not eventually (d_obs < 1)", 1),
        ("always (d_obs >= 1) and always (row >= 0)", 2),
        ("not (eventually (d_obs < 1) or eventually (row < 0))", 2),
    ],
)
def test_conditions_that_must_always_hold_are_found(formula, count):
    bundle = compiled(f"hard a: {formula}")
    assert len(step_conditions(bundle, bundle.requirements[0])) == count


@pytest.mark.parametrize(
    "formula",
    [
        "always[0, 5] (d_obs >= 1)",
        "always[1, inf] (d_obs >= 1)",
        "always (once[0, 2] (d_obs >= 1))",
        "always (delta(row) < 1)",
        "eventually (d_goal < 1)",
        "d_obs >= 1",
        "(d_obs >= 1) until (d_goal < 1)",
        "always (d_obs >= 1) or always (row >= 0)",
    ],
)
def test_a_hard_requirement_with_memory_is_refused_by_name(formula):
    code, text = code_of(f"hard keep: {formula}\nsoft go depends on keep: eventually (d_goal < 1)")
    assert code == "D868"
    assert "keep" in text


def test_tables_say_where_episodes_end_and_how_robust_a_state_is():
    """By hand: S.# / ..G has its obstacle at (0, 2) and its goal at (1, 2)."""
    task = make_task(compiled("hard a: always (d_obs >= 1)\nsoft g depends on a: eventually (d_goal < 1)"), WORLD)
    assert task.endings == (RUNS, RUNS, VIOLATION, RUNS, RUNS, GOAL)
    assert task.robustness == ((1,), (0,), (-1,), (2,), (1,), (0,))
    assert task.start == 0
    assert task.transitions[0] == (0, 3, 1, 0)


def test_strict_and_non_strict_bounds_are_told_apart_where_robustness_is_0():
    soft = "\nsoft g depends on a: eventually (d_goal < 1)"
    task = make_task(compiled("hard a: always (d_obs > 1)" + soft), WORLD)
    assert task.endings[1] == VIOLATION
    assert task.robustness[1] == (0,)
    task = make_task(compiled("hard a: not eventually (d_obs <= 1)" + soft), WORLD)
    assert task.endings[1] == VIOLATION


def test_a_goal_that_violates_is_a_violation_and_other_ends_are_terminal():
    world = make_environment("FrozenLake-v1", {"is_slippery": False}, ("SF", "HG"))
    soft = "\nsoft g depends on a: eventually (d_goal < 1)"
    bundle = compiled("hard a: always (d_goal >= 1)" + soft)
    assert make_task(bundle, world).endings == (RUNS, RUNS, TERMINAL, VIOLATION)


def test_a_spec_without_hard_requirements_has_empty_rows():
    assert make_task(compiled("soft g: eventually (d_goal < 1)"), WORLD).robustness == ((),) * 6


def test_no_goal_is_refused_and_says_what_is_missing():
    code, text = code_of("hard a: always (d_obs >= 1)")
    assert code == "D866"
    assert "eventually" in text


def test_several_goals_are_refused_by_name():
    code, text = code_of("let far = row > 1\nsoft g: eventually (d_goal < 1) and eventually far")
    assert code == "D867"
    assert "not supported yet" in text
    assert "far" in text
    assert "d_goal < 1" in text


def test_a_signal_that_the_environment_does_not_offer_is_refused_with_those_it_does():
    bundle = api.compile("signal height\nsoft g: eventually (height < 1)")
    with pytest.raises(UsageError) as caught:
        make_task(bundle, WORLD)
    (found,) = caught.value.diagnostics
    assert found.code == "D870"
    assert "height" in found.message
    assert "d_goal" in found.help


def test_a_signal_is_read_from_the_name_in_its_declaration():
    bundle = api.compile('signal height from "row"\nsoft g: eventually (height > 0)')
    assert make_task(bundle, WORLD).endings == (RUNS, RUNS, RUNS, GOAL, GOAL, GOAL)


SOFT = "soft g: eventually (d_goal < 1)"


def test_chance_is_refused_with_the_way_out():
    code, text = code_of(SOFT, make_environment("FrozenLake-v1"))
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
    assert code_of(SOFT, world)[0] == "D869"


@pytest.mark.parametrize("source", ["obs[1]", "d_obstacle"])
def test_a_declared_source_is_never_replaced_by_a_signal_of_the_same_name(source):
    """Scoring reads obs[1]; learning on the environment's own d_obs would report success for another spec."""
    spec = f'signal d_obs from "{source}"\nsignal d_goal\nhard avoid: always (d_obs >= 1)\n'
    with pytest.raises(UsageError) as caught:
        make_task(api.compile(spec + "soft g depends on avoid: eventually (d_goal < 1)"), WORLD)
    (found,) = caught.value.diagnostics
    assert found.code == "D870"
    assert f"'{source}'" in found.message and "'d_obs'" in found.message


def test_a_spec_in_stamps_is_refused_with_the_way_out():
    with pytest.raises(UsageError) as caught:
        make_task(api.compile("time s\nsignal d_goal\nsoft g: eventually[0 s, 5 s] (d_goal < 1)"), WORLD)
    (found,) = caught.value.diagnostics
    assert found.code == "D876"
    assert "time 100 ms" in found.help


def test_a_spec_with_a_period_is_taken():
    bundle = api.compile("time 100 ms\nsignal d_goal\nsoft g: eventually[0 s, 5 s] (d_goal < 1)")
    assert make_task(bundle, WORLD).endings == (RUNS,) * 5 + (GOAL,)


PRODUCT = Task(
    "goal", 4, 2, 1, ((2, 3), (0, 2), (1, 1), (3, 3)), (RUNS, RUNS, RUNS, VIOLATION), ((),) * 4, (7, 5, 6, 5)
)
"""Learner states 1 and 3 are both state 5 of the environment, with different memories."""


def test_tables_of_the_environment_are_carried_to_learner_states():
    assert lifted(PRODUCT, "abcdefgh") == ("h", "f", "g", "f")
    assert [place(PRODUCT, state) for state in range(4)] == [7, 5, 6, 5]
    task = make_task(compiled(SOFT), WORLD)
    assert lifted(task, "abcdef") == tuple("abcdef")
    assert place(task, 3) == 3


@pytest.mark.parametrize(
    ("states", "expected"),
    [
        ((5, 7, 5), (1, 0, 3)),  # the way back from 7 to 5 violates
        ((5, 6, 5, 7), (1, 2, 1, 0)),
        ((5, 7, 5, 6), (1, 0, 3, None)),  # nothing follows a violation
        ((5, 5, 6), (1, None, None)),  # a jump
        ((7, 5), (None, None)),  # begins elsewhere
        ((), ()),
    ],
)
def test_a_recording_is_followed_through_learner_states(states, expected):
    assert followed(PRODUCT, states) == expected
