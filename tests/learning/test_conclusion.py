"""What a run says when training is over."""

import pytest

from stlspec import api
from stlspec.demos import make_demonstration
from stlspec.envs.catalogue import make_environment
from stlspec.envs.model import Environment
from stlspec.learning import learn
from stlspec.learning.conclusion import first_lasting_success, short_of_steps
from stlspec.learning.outcome import Log
from stlspec.learning.settings import make_settings
from stlspec.learning.shaping import GOAL, LIMIT, VIOLATION


@pytest.mark.parametrize(
    ("checks", "expected"),
    [
        ([], None),
        ([(25, 100, False)], None),
        ([(25, 100, True), (50, 180, True)], (25, 100)),
        ([(25, 100, True), (50, 180, False), (75, 250, True)], (75, 250)),
        ([(25, 100, True), (50, 180, False)], None),
    ],
)
def test_success_counts_from_the_first_check_after_the_last_failure(checks, expected):
    assert first_lasting_success(checks) == expected


@pytest.mark.parametrize(
    ("steps", "endings", "segments", "said"),
    [
        ((4, 4), (LIMIT, LIMIT), (), "reached the goal: all of them ended at the step limit of 4"),
        ((4, 2), (LIMIT, VIOLATION), (), "reached the goal: 1 of 2 ended at the step limit of 4"),
        ((4, 2), (LIMIT, GOAL), (), ""),
        ((3, 2), (LIMIT, VIOLATION), (), ""),  # cut by the environment itself
        ((4, 2, 4), (LIMIT, GOAL, LIMIT), (1, 1, 2), "the goal of 1 segment out of 2: all of them ended"),
    ],
)
def test_where_only_the_step_limit_ended_episodes_it_is_named_with_the_way_out(steps, endings, segments, said):
    settings = make_settings(
        Environment("x"), method="shaped", episodes=1, seed=0, max_steps=4, gamma=0.99, alpha=0.1, epsilon=0.4,
        step_cost=0.01, mask=True,
    )  # fmt: skip
    found = short_of_steps(Log(steps, (0.0,) * len(steps), endings, segments), settings)
    assert len(found) == bool(said)
    assert all(said in line and "`--max-steps 40`" in line for line in found)


@pytest.fixture(scope="module")
def tour(kit):
    bundle = api.compile(
        "signal d_goal_1\nsignal d_goal_2\nlet a = d_goal_1 < 1\nlet b = d_goal_2 < 1\n"
        "soft both: eventually a and eventually b"
    )
    return learn(bundle, kit.grid_world(("1.S.", "...2")), episodes=200)


def test_counts_add_up_over_all_segments(tour):
    """Two orders take four segments: to each goal from the start, and from each to the other."""
    assert tour.training.episodes == 4 * 200 == len(tour.log.steps)
    assert tour.training.env_steps == sum(tour.log.steps)
    assert sorted(set(tour.log.segments)) == [1, 2, 3, 4]
    assert tour.log.to_csv().splitlines()[0] == "episode,steps,return,outcome,segment"
    assert [c[0] for c in tour.checks] == list(range(25, 801, 25))


def test_a_tour_succeeds_while_its_last_segment_is_trained_and_ever_after(tour):
    assert tour.success
    assert tour.goal_order == ("a", "b")
    assert 400 < tour.training.episodes_to_success <= 600
    assert all(success for *_, success in tour.checks if success) and tour.checks[-1][2]


def test_the_policy_has_a_stage_for_each_goal(tour):
    route = tour.policy.route
    assert [stage.goal for stage in route.stages] == ["a", "b"]
    assert [sorted(stage.reached) for stage in route.stages] == [[0], [7]]
    assert tour.policy.actions[2] == 0
    place = 2
    walked = [place]
    tour.policy.reset()
    for _ in tour.actions:
        place = route.transitions[place][tour.policy.act(place)]
        walked.append(place)
    assert tuple(walked) == tour.states


def test_the_stops_are_where_the_goals_are_reached(tour, kit):
    """By hand on 1.S. / ...2: two steps left, then three right and one down, in some order."""
    assert tour.stops == (2, 6)
    assert [tour.states[sample] for sample in tour.stops] == [0, 7]
    lost = learn(
        api.compile("signal d_obs\nsignal d_goal_1\nhard h: always (d_obs > 0)\nsoft s: eventually (d_goal_1 < 1)"),
        kit.grid_world(("S#1",)),
        episodes=25,
    )
    assert lost.stops == ()


def test_the_paper_s_reward_is_that_of_the_place_also_where_the_learner_counts_time():
    """A goal with a lower bound makes states of place and clock, of which there are more than rewards."""
    bundle = api.compile(
        "signal d_obs\nsignal d_goal\nhard avoid: always (d_obs >= 1)\nsoft reach: eventually[3, 20] (d_goal < 1)\n"
    )
    world = make_environment("stlspec/GridWorld-v0", map_rows=["S.#", "...", "#.G"])
    demonstration = make_demonstration("a", states=[[0, 0], [0, 1], [1, 1], [1, 2], [2, 2]])
    outcome = learn(bundle, world, [demonstration], method="paper", episodes=300)
    farming = outcome.farming
    assert farming is None or all(0 <= state < world.n_states for state in (*farming.cycle, *(farming.to_goal or ())))
    assert outcome.to_json()


def test_an_end_away_from_the_goal_is_no_way_to_save_steps():
    """Holes that no requirement forbids end the episode; falling into one soon must not pay more than looking on."""
    bundle = api.compile("signal d_goal\nhard reach: eventually (d_goal < 1)\n")
    world = make_environment("FrozenLake-v1", {"map_name": "8x8", "is_slippery": False})
    demonstration = make_demonstration("gives up", states=[[0, 0], [0, 1], [0, 2]])
    assert learn(bundle, world, [demonstration], seed=1).success
