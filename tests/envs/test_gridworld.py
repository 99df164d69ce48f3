import gymnasium
import pytest
from gymnasium.utils.env_checker import check_env

from stlspec.envs.gridworld import DEFAULT_MAP, ID, environment, register
from stlspec.envs.maps import GRIDWORLD, parse_map
from stlspec.errors import DataError, UsageError


def test_gymnasium_accepts_the_environment():
    # gymnasium warns when it cannot step a wrapper's twin; the bare environment has to pass without a word.
    check_env(gymnasium.make(ID).unwrapped)


def test_registering_twice_does_nothing():
    before = gymnasium.registry[ID]
    register()
    register()
    assert gymnasium.registry[ID] is before


def test_gymnasium_finds_it_through_its_module():
    assert gymnasium.make(f"stlspec.envs.gridworld:{ID}").spec.id == ID


def test_the_live_environment_follows_the_table():
    described = environment({}, ["S.1", "#.a"])
    live = gymnasium.make(ID, **described.options)
    for state, row in enumerate(described.transitions):
        for action, expected in enumerate(row):
            live.reset()
            live.unwrapped._cell = state
            assert live.step(action) == (expected, 0.0, False, False, {})


def test_neither_goals_nor_obstacles_end_an_episode():
    live = gymnasium.make(ID, map=["S#G"])
    state, _ = live.reset(seed=1)
    steps = [live.step(2) for _ in range(4)]
    assert state == 0
    assert [step[0] for step in steps] == [1, 2, 2, 2]
    assert not any(ended or cut for _, _, ended, cut, _ in steps)


def test_it_draws_itself_as_text():
    live = gymnasium.make(ID, map=["S.", ".G"], render_mode="ansi")
    live.reset()
    live.step(2)
    assert live.render() == "S@\n.G\n"


def test_the_default_map_is_a_solvable_map():
    grid = parse_map(DEFAULT_MAP, GRIDWORLD)
    assert grid.start == 20 and grid.goals == ((1, (4,)),) and len(grid.obstacles) == 3
    described = environment({}, None)
    assert described.map == DEFAULT_MAP
    reached, front = {grid.start}, [grid.start]
    while front:
        front = sorted({s for at in front for s in described.transitions[at]} - reached - set(grid.obstacles))
        reached |= set(front)
    assert 4 in reached


def test_the_description_says_what_a_learner_needs():
    described = environment({}, ["S.", "#1"])
    assert (described.n_states, described.n_actions, described.start, described.max_steps) == (4, 4, 0, 16)
    assert described.deterministic and not described.binned and described.terminal == frozenset()
    assert described.action_names == ("left", "down", "right", "up")


def test_mistakes_of_the_user_are_diagnostics():
    with pytest.raises(UsageError, match=r"D821.*size"):
        environment({"size": 5}, None)
    with pytest.raises(DataError, match="D825"):
        gymnasium.make(ID, map=["..."])
