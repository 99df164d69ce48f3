"""Orders trained as wholes."""

import random

import pytest

from stlspec import api
from stlspec.learning import learn
from stlspec.learning.chains import chain_task, in_learner_states
from stlspec.learning.segments import Segment
from stlspec.learning.shaping import AVOIDED, GOAL, RUNS, VIOLATION
from stlspec.learning.task import SETTLED, make_world

HEAD = "signal d_obs\nsignal d_goal_1\nsignal in_a: bool\nsignal in_b: bool\nlet one = d_goal_1 < 1\n"
LINE = ("a..S....1.a",)


def test_the_nearest_state_of_a_goal_is_not_always_the_best(kit):
    """By hand: the a on the left is 3 away and then 8 from the goal; the one on the right 7, and then 2."""
    text = "soft s: eventually[0, {}] (in_a and eventually[0, 8] one) and eventually[0, {}] one"
    far = learn(api.compile(HEAD + text.format(11, 9)), kit.grid_world(LINE), episodes=800)
    assert far.success
    assert far.states[-1] == 8
    assert far.goal_order == ("in_a", "one")
    near = learn(api.compile(HEAD + text.format(6, 11)), kit.grid_world(LINE), episodes=800)
    assert near.success
    assert near.states[3] == 0


def test_the_policy_of_a_chain_has_a_stage_for_each_goal(kit):
    text = "soft s: eventually[7, 9] (in_a and eventually[0, 2] one)"
    found = learn(api.compile(HEAD + text), kit.grid_world(LINE), episodes=800)
    assert found.success
    policy, place, walked = found.policy, 3, [3]
    policy.reset()
    for _ in found.actions:
        place = kit.grid_world(LINE).transitions[place][policy.act(place)]
        walked.append(place)
    assert tuple(walked) == found.states


def test_a_chain_s_tables_lead_from_stage_to_stage(kit):
    """By hand on Sa1: states of stage 0 are 0 to 2, of stage 1 3 to 5."""
    bundle = api.compile(HEAD + "soft s: eventually (in_a and eventually one)")
    world = make_world(bundle, kit.grid_world(("Sa1",)), 50)
    task = chain_task(world, (0, 1), ())
    assert (task.n_states, task.start, task.places) == (6, 0, (0, 1, 2, 0, 1, 2))
    assert task.endings == (RUNS,) * 5 + (GOAL,)
    assert task.transitions[0] == (0, 0, 4, 0)
    assert task.transitions[4] == (3, 4, 5, 4)
    assert task.goal_name == "in_a then one"


def test_a_goal_at_the_start_begins_in_the_next_stage(kit):
    bundle = api.compile(HEAD + "soft s: eventually (d_goal_1 == 2 and eventually one)")
    world = make_world(bundle, kit.grid_world(("S.1",)), 50)
    assert chain_task(world, (0, 1), ()).start == 3


def test_watches_last_until_a_goal_ends_them(kit):
    bundle = api.compile(HEAD + "hard h: always (d_obs > 0)\nsoft s: not in_b until in_a\nsoft t: eventually in_b")
    world = make_world(bundle, kit.grid_world(("Sab#",)), 50)
    task = chain_task(world, (0, 1), (0,))
    assert task.endings == (RUNS, RUNS, AVOIDED, VIOLATION, RUNS, RUNS, GOAL, VIOLATION)
    assert chain_task(world, (0, SETTLED), ()).endings[4:] == (GOAL, GOAL, GOAL, VIOLATION)


def test_paths_of_a_chain_are_told_in_learner_states():
    segment = Segment((), (0, 4, 8), (1, 1), True, (), (), (), ((25, 9, (0, 4)), (50, 11, ())), 0, (), 0, 0.0)
    found = in_learner_states(segment, 3)
    assert found.path == (0, 1, 2)
    assert found.looks == ((25, 9, (0, 1)), (50, 11, ()))


@pytest.mark.parametrize("seed", range(3))
def test_regions_on_random_maps_are_visited_in_the_shortest_time(kit, seed):
    """The bound is the shortest way by breadth-first search over cells and regions visited so far."""
    draw = random.Random(seed)
    cells = [(r, c) for r in range(7) for c in range(7)]
    (start, *marked) = draw.sample(cells, 8)
    rows = [["."] * 7 for _ in range(7)]
    rows[start[0]][start[1]] = "S"
    for k, (r, c) in enumerate(marked):
        rows[r][c] = "aaabbb1"[k]
    world = kit.grid_world(tuple(map("".join, rows)))
    a, b = ({7 * r + c for r, c in marked[i : i + 3]} for i in (0, 3))
    goal = 7 * marked[6][0] + marked[6][1]
    front, steps = {(world.start, 0)}, 0
    while (goal, 2) not in front:
        moved = {(after, stage) for place, stage in front for after in world.transitions[place]}
        moved = {(p, 1 if s == 0 and p in a else s) for p, s in moved}
        front = {(p, 2 if s == 1 and p in b else s) for p, s in moved} | front
        steps += 1
    text = f"soft s: eventually (in_a and eventually (in_b and eventually one))\nsoft t: eventually[0, {steps}] one"
    found = learn(api.compile(HEAD + text), world, seed=seed)
    assert found.evaluation["s"].verdict == "satisfied"
    assert len(found.actions) == steps
