"""Goals and hard requirements as tables over states."""

import pytest

from stlspec import api
from stlspec.envs.catalogue import make_environment
from stlspec.errors import UsageError
from stlspec.learning.shaping import AVOIDED, GOAL, RUNS, TERMINAL, VIOLATION
from stlspec.learning.task import SETTLED, Task, followed, lifted, make_world, open_watches, place, segment

HEAD = "signal d_obs\nsignal d_goal\nsignal row\n"
WORLD = make_environment("stlspec/GridWorld-v0", None, ("S.#", "..G"))


def compiled(text):
    return api.compile(HEAD + text)


def make_task(bundle, world):
    """Return the tables of the way from the start to the first goal."""
    found = make_world(bundle, world, 100)
    return segment(found, found.product.start, 0)


def code_of(text, world=WORLD):
    with pytest.raises(UsageError) as caught:
        make_task(compiled(text), world)
    (found,) = caught.value.diagnostics
    return found.code, found.message + found.help


SOFT = "soft g: eventually (d_goal < 1)"


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


def test_too_many_orders_are_refused_with_their_number():
    seven = " and ".join(f"eventually (row + d_goal == {k})" for k in range(1, 8))
    world = make_environment("stlspec/GridWorld-v0", None, ("S........", "........G"))
    code, text = code_of(f"soft g: {seven}", world)
    assert code == "D867"
    assert "7 goals" in text
    assert "5,040 orders" in text
    assert "not b until a" in text


def test_the_paper_method_takes_no_memory():
    bundle = compiled(f"hard a: always[0, 5] (d_obs >= 1)\n{SOFT}")
    with pytest.raises(UsageError) as caught:
        make_world(bundle, WORLD, 100, memory=False)
    (found,) = caught.value.diagnostics
    assert found.code == "D868"
    assert "--method paper" in found.message


def test_a_goal_does_not_count_before_its_window_begins():
    """By hand: from (0, 0) the goal (1, 2) is 3 steps away, and counts from sample 5 on."""
    world = make_world(compiled("soft g: eventually[5, 9] (d_goal < 1)"), WORLD, 100)
    goals = [s for s in range(world.product.n_states) if world.is_goal(s, 0)]
    assert [(world.place(s), world.product.clock[s]) for s in goals] == [(5, 5)]


def test_what_a_soft_requirement_keeps_up_is_avoided_until_it_is_over():
    """By hand: `not b until a` with b = (0, 1) and a = (1, 0) on S.# / ..G."""
    text = "soft g: (row > 0 or d_goal != 2) until (row > 0 and d_goal == 2)\nsoft h: eventually (d_goal < 1)"
    world = make_world(compiled(text), WORLD, 100)
    assert [visit.name for visit in world.visits] == ["row > 0 and d_goal == 2", "d_goal < 1"]
    assert segment(world, 0, 1, (0,)).endings == (RUNS, AVOIDED, RUNS, RUNS, RUNS, GOAL)
    assert segment(world, 0, 1, ()).endings == (RUNS,) * 5 + (GOAL,)
    assert open_watches(world, (0,)) == (0,)
    assert open_watches(world, (0, 3)) == ()
    assert open_watches(world, (0, 1)) == ()


def test_a_run_may_end_where_nothing_is_waited_for():
    text = f"hard a: always (row > 0 implies eventually[0, 2] (d_goal < 1))\n{SOFT}"
    world = make_world(compiled(text), WORLD, 100)
    task = segment(world, world.product.start, SETTLED)
    ended = [world.place(s) for s, ending in enumerate(task.endings) if ending == GOAL]
    assert 0 in ended and 5 in ended and 3 not in ended


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
