"""Either reward is asked what it wants, and used by the same learner; known rewards give known answers."""

import numpy as np
import pytest

from stlspec.paper.cases import case_of, random_grid
from stlspec.paper.runs import make_run
from stlspec.paper.tabular import make_tabular
from stlspec.paper.worth import (
    HOME,
    IRL,
    IRL_VALUES,
    NOTHING,
    OURS,
    PLAIN,
    action_values,
    alone,
    as_map,
    asked_for,
    on_unseen_maps,
    reward_maps,
    runs_of,
)
from stlspec.rewards import infer_reward

GOAL_ONLY = [0.0] * 15 + [1.0]


def lake():
    return case_of("lake-4")


def test_values_are_those_of_a_chain_by_hand():
    case = lake()
    tabular = make_tabular(case.bundle(), case.environment(), case.experts(1))
    values = action_values(tabular, GOAL_ONLY, gamma=0.5).max(axis=1)
    # entering the goal pays 1, and so does every later step there: 1 / (1 - 0.5) = 2, halved for each step before
    assert values[15] == pytest.approx(2.0)
    assert values[14] == pytest.approx(2.0)
    assert values[13] == pytest.approx(1.0)
    assert values[0] == pytest.approx(2.0 / 2**5)
    assert values[5] == 0.0  # a hole leads nowhere


def test_values_agree_with_solving_the_equations():
    case = random_grid(5, 1, ("good",), 3)
    tabular = make_tabular(case.bundle(), case.environment(), case.experts(1))
    reward = np.random.default_rng(2).normal(size=25)
    found = action_values(tabular, reward, gamma=0.9)
    best = found.argmax(axis=1)
    table = np.zeros((25, 4, 25))
    table[tabular.states, tabular.actions, tabular.afters] = tabular.probabilities
    policy = table[np.arange(25), best]
    solved = np.linalg.solve(np.eye(25) - 0.9 * policy, policy @ reward)
    assert found.max(axis=1) == pytest.approx(solved, abs=1e-6)
    assert found == pytest.approx(table @ (reward + 0.9 * solved), abs=1e-6)


def test_a_reward_at_the_goal_asks_for_the_goal_and_one_in_a_hole_for_the_hole():
    assert alone(lake(), GOAL_ONLY) == {"hard": True, "all": True, "reached": True, "steps": 6}
    hole = [0.0] * 5 + [1.0] + [0.0] * 10
    assert alone(lake(), hole) == {"hard": False, "all": False, "reached": False, "steps": 2}
    stays = alone(lake(), [1.0] + [0.0] * 15)
    assert (stays["hard"], stays["reached"]) == (True, False)


def test_unseen_maps_keep_size_start_and_goal():
    for name in ("lake-4", "grid-5"):
        case = case_of(name)
        maps = on_unseen_maps(case, 3)
        assert [m.map for m in maps] == [m.map for m in on_unseen_maps(case, 3)]
        assert len({case.map, *(m.map for m in maps)}) == 4
        for other in maps:
            assert other.environment().start == case.environment().start
            assert "".join(other.map).index("G") == "".join(case.map).index("G")


def test_only_differences_of_a_reward_count():
    case = lake()
    reward = np.arange(16.0)
    assert as_map(case, reward).values == as_map(case, 7 * reward - 3).values == tuple(np.arange(16) / 15)
    assert set(as_map(case, np.ones(16)).values) == {0.0}


def test_the_values_of_a_reward_rise_to_the_goal_and_no_information_is_the_same_everywhere():
    maps = reward_maps(lake(), GOAL_ONLY)
    assert set(maps) == {IRL, IRL_VALUES, NOTHING}
    values = maps[IRL_VALUES].values
    assert values[0] < values[4] < values[8] < values[9] < values[13] < values[14] == 1.0
    assert set(maps[NOTHING].values) == {1e-9}


def test_every_reward_gets_the_same_learner_seeds_and_bad_demonstrations():
    runs = list(runs_of(case_of("grid-5"), np.arange(25.0), seeds=2, unseen=1))
    assert len(runs) == 2 * 2 * 5
    assert {run.method for run in runs} == {OURS, PLAIN, IRL, IRL_VALUES, NOTHING}
    assert {run.group for run in runs} == {f"grid-5, {HOME}", "grid-5, unseen 1"}
    rows = {run.method: make_run(run) for run in runs if run.seed == 0 and HOME in run.group}
    assert {row.prefilled for row in rows.values()} == {rows[OURS].prefilled}
    assert rows[OURS].prefilled > 0
    assert all(row.success for row in rows.values())
    on_lake = [run for run in runs_of(lake(), GOAL_ONLY, seeds=1, unseen=0) if run.method == IRL]
    assert [run.none for run in on_lake] == [True]  # it has no bad ones


def test_what_is_asked_for_is_counted_over_the_unseen_maps():
    found = asked_for(lake(), GOAL_ONLY, 4)
    assert found[IRL] == {"home": alone(lake(), GOAL_ONLY), "maps": 4, "hard": 4, "all": 4, "reached": 4}
    case = lake()
    ours = infer_reward(case.bundle(), case.demonstrations(), case.environment()).table(case.environment())
    assert found[OURS]["home"] == alone(case, ours)
    assert found[OURS]["maps"] == 4
