"""The part on the reward shows R(s), or says why there is none."""

import stlspec
from stlspec.demos import make_demonstration
from stlspec.envs.catalogue import make_environment
from stlspec.pages.reward import reward_section, reward_view

SPEC = """signal d_obs
signal d_goal
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually (d_goal < 1)
"""
WORLD = {"id": "stlspec/GridWorld-v0", "args": {}, "map": ["S.G", "..#"]}


def view_of(demos, world=None, **more):
    bundle = stlspec.compile(SPEC)
    return reward_view(bundle, stlspec.score(bundle, demos, world, **more), demos, world)


def test_values_and_paths_are_on_the_map() -> None:
    view = view_of([make_demonstration("d", states=[[0, 0], [0, 1], [0, 2]], env=WORLD)])
    assert sorted(view.values) == [0, 1, 2]
    assert view.values[2] == 1.0
    assert view.values[0] < view.values[1] < 1.0
    assert view.paths[0].path == (0, 1, 2)
    assert "R(s) of 3 states" in reward_section(view)


def test_without_states_the_reason_is_told_in_words() -> None:
    view = view_of([make_demonstration("<d>", {"d_obs": [2, 1], "d_goal": [1, 0]})])
    assert view.reason.startswith("None could be inferred: ")
    assert "&lt;d&gt;" in reward_section(view)
    assert view_of([]).reason
    assert view_of([make_demonstration("d", {"d_obs": [2, 1], "d_goal": [1, 0]})], at=1).reason


def test_states_without_a_map_are_a_table_and_a_reward_of_zero_says_so() -> None:
    world = make_environment("FrozenLake-v1", {"is_slippery": False})
    view = view_of([make_demonstration("d", states=[0, 1], env=world.describe())])
    assert "0 in every state" in reward_section(view)


def test_a_ranking_of_other_samples_gets_no_reward_of_these() -> None:
    bundle = stlspec.compile(SPEC)
    made, other = (
        make_demonstration("d", states=states, env=WORLD) for states in ([[0, 0], [0, 1], [0, 2]], [[0, 0], [1, 2]])
    )
    assert reward_view(bundle, stlspec.score(bundle, [made]), [made], None).values
    assert "as recorded" in reward_view(bundle, stlspec.score(bundle, [other]), [made], None).reason


def test_the_reward_is_of_the_samples_that_the_ranking_was_made_of() -> None:
    bundle = stlspec.compile("time s\n" + SPEC)
    cells = [[0, 0], [0, 0], [0, 1], [0, 2]]
    demos = [make_demonstration("d", states=cells, time=[0.0, 0.7, 1.0, 2.0], env=WORLD)]
    sampling = {"resample": 10**9}
    view = reward_view(bundle, stlspec.score(bundle, demos, **sampling), demos, None, **sampling)
    assert view.reason == "" and sorted(view.values) == [0, 1, 2]
    assert view.paths[0].path == (0, 1, 2)  # at 0, 1 and 2 s
