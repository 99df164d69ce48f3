"""Hand-crafted rewards go through the very learner that ours goes through."""

from dataclasses import replace

import numpy as np
import pytest

from stlspec.errors import UsageError
from stlspec.paper.cases import case_of
from stlspec.paper.handmade import BY_DISTANCE, FARTHEST, SPARSE, make_handmade, payoffs
from stlspec.paper.runs import Run, make_run, make_runs


def run_of(name, method, seed=0, **options):
    return Run(name, method, case_of(name), seed, options={"episodes": 400} | options)


@pytest.mark.parametrize("name", ["grid-5", "two-goal-5"])
def test_the_sparse_reward_is_plain_learning_bit_for_bit(name):
    plain = make_run(replace(run_of(name, SPARSE, 3), options={"episodes": 400, "method": "plain"}))
    sparse = make_handmade(run_of(name, SPARSE, 3))
    assert replace(sparse, seconds=0.0) == replace(plain, seconds=0.0)
    assert sparse.success
    assert sparse.prefilled > 0


def test_the_dense_reward_falls_with_the_distance_to_the_goal():
    world = case_of("lake-4").environment()  # the goal is in the lower right corner, 6 steps from the start
    paid = np.array(payoffs(world, BY_DISTANCE)).reshape(4, 4)
    expected = [[-FARTHEST * (6 - row - column) / 6 for column in range(4)] for row in range(4)]
    assert paid == pytest.approx(np.array(expected))
    assert payoffs(world, SPARSE) == ()


def test_the_dense_reward_is_learned_on_and_changes_the_course():
    rows = {method: make_handmade(run_of("lake-4", method, 1, episodes=2000)) for method in (SPARSE, BY_DISTANCE)}
    assert all(row.success for row in rows.values())
    assert rows[SPARSE].curve != rows[BY_DISTANCE].curve
    assert rows[BY_DISTANCE] == replace(
        make_handmade(run_of("lake-4", BY_DISTANCE, 1, episodes=2000)), seconds=rows[BY_DISTANCE].seconds
    )


def test_runs_take_it_as_any_other_way_to_make_a_row():
    found = make_runs([run_of("lake-4", SPARSE), run_of("lake-4", BY_DISTANCE)], make=make_handmade)
    assert [row.episodes for by in found.values() for rows in by.values() for row in rows] == [400, 400]


def test_without_one_goal_there_is_no_distance():
    with pytest.raises(UsageError, match="no distance to one goal"):
        make_handmade(run_of("two-goal-5", BY_DISTANCE))
    with pytest.raises(UsageError, match="its transitions are not known"):
        make_handmade(run_of("car-50", SPARSE))
