"""Algorithm 2 on tasks small enough to follow by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stlspec.learning.qstl import CHUNK, Learner, feedback, run_chunk, run_episodes, run_paper_episodes
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, LIMIT, RUNS, TERMINAL, VIOLATION
from stlspec.learning.task import Task

GREEDY = Settings("plain", 3, 0, 4, 0.5, 0.5, 0.0, 0.25, True)


def corridor(*endings, robustness=None):
    """States in a row; action 0 goes right, action 1 stays."""
    n = len(endings)
    transitions = tuple((min(s + 1, n - 1), s) for s in range(n))
    return Task("goal", n, 2, 0, transitions, endings, robustness or ((0.0,),) * n)


def trained(task, settings, reward=None, run=run_episodes):
    learner = Learner(task, settings, reward or [0.0] * task.n_states)
    run(learner, settings.episodes, np.random.default_rng(0))
    return learner


def test_values_follow_the_update_rule_by_hand():
    """Two episodes straight to the goal, alpha = gamma = 1/2, step cost 1/4.

    First: Q(0) = 0 + 1/2 (-1/4 + 0 - 0) = -1/8, Q(1) = 1/2 * 3/4 = 3/8. Then action 1 is the better one in
    state 0 (0 > -1/8) until its value falls too: Q(0, stay) = 1/2 (-1/4 + 1/2 * 0) = -1/8, a tie again.
    """
    task = corridor(RUNS, RUNS, GOAL)
    learner = trained(task, replace(GREEDY, episodes=1))
    assert learner.q[:2] == [[-0.125, 0.0], [0.375, 0.0]]
    assert (learner.steps, learner.returns, learner.outcomes) == ([2], [0.5], [GOAL])
    learner = trained(task, replace(GREEDY, episodes=2))
    # stays once, then on a tie takes the lowest action, 0: -1/8 + 1/2 (-1/4 + 1/2 * 3/8 + 1/8) = -3/32
    assert learner.q[0] == [-0.09375, -0.125]
    assert learner.q[1] == [0.5625, 0.0]
    assert learner.steps == [2, 3]


def test_the_step_limit_bootstraps_and_an_end_does_not():
    """Staying at the limit uses the value of the state reached: 1/2 (-1/4 + 1/2 * max Q(0))."""
    task = corridor(RUNS, RUNS)
    learner = Learner(task, replace(GREEDY, max_steps=1, episodes=1), [0.0, 0.0])
    learner.q[0], learner.q[1] = [0.0, -1.0], [8.0, 0.0]
    run_episodes(learner, 1, np.random.default_rng(0))
    assert learner.q[0][0] == 0.5 * (-0.25 + 0.5 * 8.0)
    assert learner.outcomes == [LIMIT]
    assert learner.returns == [-0.25]


def test_a_pair_that_violated_is_not_taken_again():
    task = corridor(RUNS, VIOLATION)
    learner = trained(task, replace(GREEDY, episodes=5))
    assert learner.violations == 1
    assert learner.q[0][0] == -math.inf
    assert learner.choices[0] == [1]
    assert learner.masked == 1
    assert learner.outcomes == [VIOLATION, LIMIT, LIMIT, LIMIT, LIMIT]


def test_without_a_mask_it_is_taken_again():
    task = corridor(RUNS, VIOLATION)
    settings = replace(GREEDY, episodes=50, epsilon=1.0, mask=False)
    assert trained(task, settings).violations > 10


def test_a_state_without_an_action_left_violates_itself():
    """State 1 can only fall into 2 or 3: once both are known, entering 1 is a violation, and masked too."""
    transitions = ((1, 0), (2, 3), (2, 2), (3, 3))
    task = Task("goal", 4, 2, 0, transitions, (RUNS, RUNS, VIOLATION, VIOLATION), ((0.0,),) * 4)
    learner = trained(task, replace(GREEDY, episodes=200, epsilon=0.5))
    assert learner.endings[1] == VIOLATION
    assert learner.q[1] == [-math.inf, -math.inf]
    assert learner.q[0][0] == -math.inf
    assert learner.violations == 3
    assert learner.moves[0][0][2] == VIOLATION


@pytest.mark.parametrize("reward", [(0.0,) * 4, (0.5, 0.25, 0.0, 0.0)])
def test_moves_into_a_dead_state_are_those_of_a_table_made_afresh(reward):
    transitions = ((1, 0, 3), (2, 3, 2), (2, 2, 2), (3, 1, 0))
    task = Task(
        "goal", 4, 3, 0, transitions, (RUNS, RUNS, VIOLATION, RUNS), ((0.0,),) * 4, payoffs=(0.0, 2.0, 0.0, 0.0)
    )
    learner = trained(task, replace(GREEDY, episodes=3, epsilon=0.5, method="shaped"), reward=reward)
    learner.forbid([(1, 0), (1, 1), (1, 2)])
    assert learner.endings[1] == VIOLATION
    assert learner.moves == learner._moves()


def test_a_start_without_a_safe_action_ends_training_without_steps():
    task = corridor(RUNS, GOAL)
    learner = Learner(task, replace(GREEDY, episodes=3), [0.0, 0.0])
    learner.forbid([(0, 0), (0, 1)])
    run_episodes(learner, 3, np.random.default_rng(0))
    assert learner.steps == [0, 0, 0]
    assert learner.outcomes == [VIOLATION] * 3


@pytest.mark.parametrize("run", [run_episodes, run_paper_episodes])
@pytest.mark.parametrize("ending", [GOAL, VIOLATION, TERMINAL])
def test_a_start_that_ends_episodes_takes_no_steps(run, ending):
    learner = trained(corridor(ending, RUNS), GREEDY, run=run)
    assert (learner.env_steps, learner.steps, learner.outcomes) == (0, [0, 0, 0], [ending] * 3)


def test_forbidding_twice_counts_once():
    learner = Learner(corridor(RUNS, GOAL), GREEDY, [0.0, 0.0])
    learner.forbid([(0, 0), (0, 0)])
    assert learner.masked == 1


def test_random_actions_are_spread_evenly_over_those_allowed():
    transitions = ((0, 0, 0, 1),) * 2
    task = Task("goal", 2, 4, 0, transitions, (RUNS, GOAL), ((0.0,),) * 2)
    settings = replace(GREEDY, episodes=4000, epsilon=1.0, max_steps=1000)
    learner = trained(task, settings)
    # the chance of the goal is 1/4 at each step: 4 steps an episode on average, deviation below 5 sigma
    assert abs(learner.env_steps / 4000 - 4) < 5 * math.sqrt(12 / 4000)
    masked = Learner(task, settings, [0.0, 0.0])
    masked.forbid([(0, 1)])
    run_episodes(masked, 4000, np.random.default_rng(1))
    assert abs(masked.env_steps / 4000 - 3) < 5 * math.sqrt(6 / 4000)


@pytest.mark.parametrize(
    ("lows", "expected"),
    [([], 0.0), ([1.5, -2.0], -0.5), ([math.inf, 2.0], 3.0), ([-math.inf], -1.0), ([1e300, -1e300], 0.0)],
)
def test_feedback_is_the_sum_with_infinities_as_their_tanh(lows, expected):
    assert feedback(lows) == expected


def test_the_paper_s_reward_is_r_plus_the_running_minimum():
    """By hand: rewards .5 + min(3, 2) = 2.5, then 1 + min(2, 5) = 3; alpha 1/2, gamma 1/2."""
    task = corridor(RUNS, RUNS, GOAL, robustness=((3.0,), (2.0,), (5.0,)))
    settings = replace(GREEDY, method="paper", episodes=1, mask=False)
    learner = trained(task, settings, reward=[0.0, 0.5, 1.0], run=run_paper_episodes)
    assert learner.q == [[1.25, 0.0], [1.5, 0.0], [0.0, 0.0]]
    assert learner.returns == [5.5]


def test_the_paper_s_method_ends_at_a_violation_and_forgets_it():
    task = corridor(RUNS, VIOLATION, robustness=((0.0,), (-1.0,)))
    settings = replace(GREEDY, method="paper", episodes=2, epsilon=1.0, mask=False, max_steps=50)
    learner = trained(task, settings, run=run_paper_episodes)
    assert learner.outcomes == [VIOLATION, VIOLATION]
    assert learner.masked == 0


def test_nothing_becomes_nan_where_robustness_is_infinite():
    task = corridor(RUNS, RUNS, GOAL, robustness=((math.inf,),) * 3)
    settings = replace(GREEDY, method="paper", episodes=20, epsilon=0.5, mask=False)
    learner = trained(task, settings, run=run_paper_episodes)
    assert all(math.isfinite(value) for row in learner.q for value in row)


@pytest.mark.parametrize("method", ["shaped", "plain", "paper"])
def test_a_chunk_depends_on_the_seed_and_its_number_only(method):
    task = corridor(*[RUNS] * 6, GOAL, robustness=((1.0,),) * 7)
    settings = replace(GREEDY, method=method, episodes=2 * CHUNK + 3, epsilon=0.5)

    def run(seed, skip):
        learner = Learner(task, replace(settings, seed=seed), [0.1 * s for s in range(7)])
        for chunk in range(3):
            if chunk == skip:
                np.random.default_rng(chunk).random()
            run_chunk(learner, chunk)
        return learner.q, learner.steps, learner.returns

    assert run(5, None) == run(5, 1)
    assert run(5, None) != run(6, None)
    assert len(run(5, None)[1]) == 2 * CHUNK + 3
