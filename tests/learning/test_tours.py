"""Algorithm 3: tours through goals that pass, coincide, forbid each other, or do not count yet."""

import math

import pytest

from stlspec import api
from stlspec.learning import learn
from stlspec.learning.tours import Judgement, best_tour, judgement
from stlspec.semantics.evaluation import evaluate

HEAD = (
    "signal d_obs\nsignal d_goal_1\nsignal d_goal_2\nsignal d_goal_3\nsignal in_a: bool\n"
    "let one = d_goal_1 < 1\nlet two = d_goal_2 < 1\nlet three = d_goal_3 < 1\nlet a = in_a\n"
)


def tour(kit, rows, text, **fields):
    return learn(api.compile(HEAD + text), kit.grid_world(rows), **{"episodes": 600, **fields})


def test_a_goal_that_is_passed_on_the_way_needs_no_visit_of_its_own(kit):
    found = tour(kit, ("S1.2", "...."), "soft s: eventually one and eventually[0, 3] two")
    assert found.success
    assert len(found.actions) == 3


def test_goals_in_one_place_are_visited_at_once(kit):
    found = tour(kit, ("S.1", "..."), "soft s: eventually one and eventually (d_goal_1 <= 0 and d_obs > 1)")
    assert found.success
    assert len(found.actions) == 2
    assert len(found.goal_order) == 1


def test_a_goal_at_the_start_costs_nothing(kit):
    found = tour(kit, ("S..1", "...."), "soft s: eventually[0, 3] one and eventually (d_goal_1 == 3)")
    assert found.success
    assert len(found.actions) == 3
    assert found.goal_order == ("d_goal_1 == 3", "one")


def test_everything_at_the_start_takes_no_training(kit):
    found = tour(kit, ("S..1", "...."), "soft s: eventually (d_goal_1 > 2) and eventually (d_goal_1 == 3)")
    assert found.success
    assert (found.actions, found.training.env_steps, found.training.env_steps_to_success) == ((), 0, 0)


def test_the_order_that_the_deadline_leaves_wins(kit):
    """Goal 1 is 4 steps to the left, goal 2 is 5 to the right: only left first meets both deadlines."""
    rows = ("1...S....2",)
    found = tour(kit, rows, "soft s: eventually[0, 4] one and eventually[0, 13] two")
    assert found.success
    assert found.goal_order == ("one", "two")
    found = tour(kit, rows, "soft s: eventually[0, 14] one and eventually[0, 5] two")
    assert found.success
    assert found.goal_order == ("two", "one")


def test_nesting_is_a_matter_of_meaning(kit):
    """Goal 1 is on the way to goal 2; wanted after it, it is visited again."""
    found = tour(kit, ("S1.2", "...."), "soft s: eventually (two and eventually one)")
    assert found.success
    assert len(found.actions) == 5
    found = tour(kit, ("S.12", "...."), "soft s: eventually (one and eventually (two and eventually one))")
    assert found.success
    assert len(found.actions) == 4
    assert found.goal_order == ("one", "two", "one")


@pytest.mark.parametrize("strength", ["soft", "hard"])
def test_a_goal_is_avoided_until_the_one_before_it(kit, strength):
    """Goal 2 lies on the short way to goal 1, so the way there leads round it."""
    text = f"{strength} order: not two until one\nsoft s: eventually one and eventually two"
    found = tour(kit, ("S.2.1", "....."), text)
    assert found.success
    assert found.goal_order == ("one", "two")
    assert len(found.actions) == 8


def test_what_a_soft_requirement_keeps_up_is_kept_up_where_that_is_possible(kit):
    text = "soft dry: always (not a)\nsoft s depends on dry: eventually one"
    found = tour(kit, ("S.a.1", "....."), text)
    assert found.success
    assert len(found.actions) == 6
    assert found.training.hard_violations == 0
    found = tour(kit, ("S.a.1", "##a##"), f"{text}\nhard safe: always (d_obs >= 1)")
    assert not found.success
    assert found.meets_hard
    assert found.evaluation["s"].verdict == "satisfied"


def test_one_soft_requirement_that_stands_against_another_gives_way_to_the_better_sum(kit):
    """Round the region takes 6 steps, and the deadline leaves 4."""
    late = "soft dry{}: always (d_a >= 1)\nsoft s bound none{}: eventually[0, 4] one"
    found = tour(kit, ("S.a.1", "....."), "signal d_a\n" + late.format(" scale 100", ""), episodes=300)
    assert len(found.actions) == 4
    found = tour(kit, ("S.a.1", "....."), "signal d_a\n" + late.format("", " scale 100"), episodes=300)
    assert len(found.actions) == 6


def test_one_side_of_an_or_is_enough(kit):
    found = tour(kit, ("2..S.1", "......"), "soft s: eventually one or eventually two")
    assert found.success
    assert len(found.actions) == 2
    found = tour(kit, ("2..S#1", "....##"), "hard h: always (d_obs >= 1)\nsoft s: eventually (one or eventually two)")
    assert found.success
    assert found.goal_order == ("two",)


def test_a_goal_that_does_not_count_before_its_time_is_waited_for(kit):
    found = tour(kit, ("S.1", "..2"), "soft s: eventually[6, 7] one and eventually two")
    assert found.success
    assert 6 <= len(found.actions) <= 7


def test_an_answer_that_a_hard_requirement_waits_for_is_given_before_the_end(kit):
    """Passing a must be followed by goal 2 within 6 steps, though goal 1 is reached before."""
    text = "hard h: always (a implies eventually[0, 6] two)\nsoft s depends on h: eventually[0, 3] one"
    found = tour(kit, ("Sa.1..", "###2##", "######"), text, episodes=1500)
    assert found.success
    assert found.goal_order[0] == "one"
    assert len(found.actions) == 4


def test_three_goals_in_any_order_and_one_that_cannot_be_reached(kit):
    text = "hard h: always (d_obs >= 1)\nsoft s: eventually one and eventually two\nsoft t: eventually three"
    found = tour(kit, ("1.S.2#3",), text)
    assert not found.success
    assert found.meets_hard
    assert found.evaluation["s"].verdict == "satisfied"
    assert sorted(found.goal_order[:2]) == ["one", "two"]


def test_judging_bounds_the_soft_requirements_only():
    bundle = api.compile(
        "signal x\nhard h: always (x > 0)\nsoft a: x > 1\nsoft b bound linear scale 2: x > 2\nsoft c bound none: x > -1"
    )
    found = judgement(bundle, evaluate(bundle, {"x": [2.0]}))
    assert (found.meets_hard, found.meets_all) == (True, False)
    assert found.wanted == pytest.approx(math.tanh(1) + 0 + 3)


def test_the_best_tour_meets_hard_then_all_then_has_the_largest_sum_then_the_fewest_steps():
    class Tours:
        candidates = ()

    class Path:
        goals = ()

        def __init__(self, *path):
            self.path = path

    known = {
        (0,): Judgement(False, False, 9.0),
        (0, 1): Judgement(True, False, 1.0),
        (0, 1, 2): Judgement(True, True, 0.5),
        (0, 1, 3): Judgement(True, True, 0.6),
        (0, 1, 4, 5): Judgement(True, True, 0.6 + 1e-15),
    }
    for count, best in ((1, (0,)), (2, (0, 1)), (3, (0, 1, 2)), (5, (0, 1, 3))):
        Tours.candidates = [Path(*path) for path in list(known)[:count]]
        assert best_tour(Tours, known.__getitem__)[0].path == best


def test_the_result_does_not_depend_on_the_number_of_processes(kit):
    text = "soft s: eventually one and eventually two and eventually three"
    alone, shared = (tour(kit, ("1.S", "2.3"), text, episodes=100, jobs=jobs) for jobs in (1, 2))
    assert alone.policy == shared.policy
    assert (alone.log, alone.checks, alone.states) == (shared.log, shared.checks, shared.states)
