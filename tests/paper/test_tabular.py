"""The tables of MCE-IRL say what the environments do, by their own tables and by stepping."""

import gymnasium
import numpy as np
import pytest

from stlspec.envs.catalogue import make_environment, make_live
from stlspec.envs.live import with_bins
from stlspec.errors import UsageError
from stlspec.paper.cases import case_of, random_grid
from stlspec.paper.tabular import count_visits, goal_of, make_tabular, points_of, reached


def dense(tabular):
    table = np.zeros((tabular.n_states, tabular.n_actions, tabular.n_states))
    np.add.at(table, (tabular.states, tabular.actions, tabular.afters), tabular.probabilities)
    return table


def tables(case, count=3):
    return make_tabular(case.bundle(), case.environment(), case.experts(count))


@pytest.mark.parametrize("slippery", [False, True])
def test_a_lake_has_the_transitions_that_gymnasium_lists(slippery):
    case = case_of("lake-4")
    world = make_environment("FrozenLake-v1", {"is_slippery": slippery}, case.map)
    found = dense(make_tabular(case.bundle(), world, case.experts(2)))
    listed = gymnasium.make("FrozenLake-v1", desc=list(case.map), is_slippery=slippery).unwrapped.P
    for state, actions in listed.items():
        for action, branches in actions.items():
            expected = np.zeros(16)
            for probability, after, _, _ in branches:
                expected[after] += probability
            assert found[state, action] == pytest.approx(expected)


@pytest.mark.parametrize("seed", [3, 4])
def test_a_grid_moves_as_its_environment_but_for_the_goal_which_absorbs(seed):
    case = random_grid(5, 1, ("good", "bad"), seed)
    found, live = dense(tables(case)), make_live(case.environment()).unwrapped
    (goal,) = (5 * r + c for r, row in enumerate(case.map) for c, mark in enumerate(row) if mark == "G")
    live.reset()
    for state in range(25):
        for action in range(4):
            live._cell = state
            after = goal if state == goal else live.step(action)[0]
            assert found[state, action, after] == 1.0


def test_episodes_start_where_the_environment_does():
    assert tables(case_of("lake-8")).starts.tolist() == [1.0] + [0.0] * 63
    starts = tables(case_of("car-50"), 2).starts
    assert starts.sum() == pytest.approx(1.0)
    for number in np.flatnonzero(starts):
        position, velocity = divmod(int(number), 50)
        assert -0.6 - 0.036 <= -1.2 + 0.036 * position <= -0.4
        assert velocity == 25  # the bin above 0


def test_visits_are_those_of_the_demonstrations_that_stay_where_they_end():
    # by hand: 0 1 2 2 and 0 2 2 2 within three steps; the last path is cut after them
    assert count_visits([[0, 1, 2], [0, 2]], 4, 3).tolist() == [1.0, 0.5, 2.5, 0.0]
    assert count_visits([[0, 1, 0, 1, 0, 1]], 2, 3).tolist() == [2.0, 2.0]


def test_the_horizon_is_twice_the_longest_demonstration_within_the_limit():
    lake = tables(case_of("lake-4"))
    assert lake.horizon == 2 * 6
    assert lake.visits.sum() == pytest.approx(lake.horizon + 1)
    assert tables(case_of("car-50"), 1).horizon == 200


def car(bins):
    case = case_of("car-50")
    world = with_bins(make_environment("MountainCar-v0"), (bins, bins))
    return case, world, make_tabular(case.bundle(), world, case.experts(1))


def test_a_binned_car_goes_where_stepping_from_within_the_bin_leads():
    _, world, found = car(25)
    table, draw = dense(found), np.random.default_rng(5)
    live = gymnasium.make("MountainCar-v0").unwrapped
    live.reset(seed=0)
    counts = np.zeros((20, 625))
    below = [s for s in range(625) if -1.2 + (s // 25 + 1) * 0.072 < 0.5]  # wholly below the flag
    chosen = [(int(draw.choice(below)), int(draw.integers(3))) for _ in range(20)]
    for row, (state, action) in zip(counts, chosen, strict=True):
        low = np.array([-1.2 + 0.072 * (state // 25), -0.07 + 0.0056 * (state % 25)])
        for _ in range(600):
            live.state = low + draw.random(2) * (0.072, 0.0056)
            row[world.encode(live.step(action)[0])] += 1 / 600
        # 16 evenly spaced points against 600 random ones
        assert np.abs(row - table[state, action]).sum() / 2 < 0.25
        assert np.all(row[table[state, action] > 0.1] > 0)


def test_every_pair_of_state_and_action_leads_somewhere_and_the_flag_absorbs():
    case, world, found = car(20)
    table = dense(found)
    assert table.sum(axis=2) == pytest.approx(1.0)
    flags = [s for s in range(400) if -1.2 + (s // 20) * 0.09 >= 0.5]
    assert flags
    assert all(table[s, a, s] == 1.0 for s in flags for a in range(3))
    numbers, points = points_of(world)
    assert np.bincount(numbers, minlength=400).tolist() == [16] * 400
    assert reached(case.bundle(), world, goal_of(case.bundle()), points).sum() == (points[:, 0] >= 0.5).sum()


def test_several_goals_are_refused_in_words():
    case = case_of("two-goal-5")
    with pytest.raises(UsageError, match="one goal, and the spec has 2"):
        make_tabular(case.bundle(), case.environment(), case.demonstrations("good"))
