import math

import gymnasium
import pytest

from stlspec.envs.frozenlake import environment
from stlspec.errors import DataError, UsageError

SMALL = ["SFFF", "FHFH", "FFFH", "HFFG"]


def test_the_table_is_gymnasiums_own():
    described = environment({"is_slippery": False}, None)
    own = gymnasium.make("FrozenLake-v1", is_slippery=False).unwrapped.P
    assert described.map == tuple(SMALL)
    assert described.transitions == tuple(tuple(own[s][a][0][1] for a in range(4)) for s in range(16))
    assert described.deterministic and described.outcomes is None


def test_holes_and_the_goal_end_an_episode():
    assert environment({"is_slippery": False}, None).terminal == {5, 7, 11, 12, 15}


def test_ice_is_slippery_unless_told_otherwise():
    described = environment({}, None)
    assert not described.deterministic and described.table is None and described.fingerprint is None
    # Going right from the start: down, right and up with a third each; up is the border.
    assert [state for _, state in described.outcomes[0][2]] == [0, 1, 4]
    assert all(math.isclose(p, 1 / 3) for p, _ in described.outcomes[0][2])
    # Going left: the border on the left and above, so that two thirds stay.
    assert {s: p for p, s in described.outcomes[0][0]} == {0: pytest.approx(2 / 3), 4: pytest.approx(1 / 3)}
    assert all(math.isclose(sum(p for p, _ in row), 1) for rows in described.outcomes for row in rows)


def test_slippery_ice_that_never_slips_is_deterministic():
    sure = environment({"is_slippery": True, "success_rate": 1.0}, None)
    assert sure.fingerprint == environment({"is_slippery": False}, None).fingerprint is not None


def test_signals_are_distances_to_holes_and_goals():
    described = environment({"is_slippery": False}, ["SFG", "FFH", "GFF"])
    assert described.signal_names == ("row", "col", "d_obs", "d_goal", "d_goal_1", "d_goal_2")
    found = described.signals(described.signal_names, [[0, 0], [1, 1]])
    assert {k: v.tolist() for k, v in found.items()} == {
        "row": [0, 1],
        "col": [0, 1],
        "d_obs": [3, 1],
        "d_goal": [2, 2],
        "d_goal_1": [2, 2],
        "d_goal_2": [2, 2],
    }


def test_the_step_limit_is_the_environments():
    assert environment({}, None).max_steps == gymnasium.spec("FrozenLake-v1").max_episode_steps


def test_a_map_wins_over_the_name_of_one():
    assert environment({"map_name": "8x8"}, None).n_states == 64
    assert environment({"map_name": "8x8", "desc": SMALL}, None).n_states == 16
    assert environment({"map_name": "8x8", "desc": SMALL}, ["SG"]).n_states == 2


def test_the_options_make_the_same_live_environment():
    described = environment({"is_slippery": False, "map_name": "4x4"}, ["SFG"])
    live = gymnasium.make("FrozenLake-v1", **described.options)
    assert [live.reset()[0], live.step(2)[0], live.step(2)[:3]] == [0, 1, (2, 1, True)]


@pytest.mark.parametrize(
    "args",
    [
        {"slippery": False},
        {"is_slippery": "no"},
        {"is_slippery": 0},
        {"map_name": "5x5"},
        {"map_name": None},
        {"map_name": ["4x4"]},
        {"desc": "SFFG"},
        {"desc": []},
        {"success_rate": 2},
        {"success_rate": True},
        {"reward_schedule": [1, 0]},
    ],
)
def test_arguments_are_checked_before_gymnasium_sees_them(args):
    with pytest.raises(UsageError) as error:
        environment(args, None)
    assert [d.code for d in error.value.diagnostics] == ["D821"]


def test_a_misspelt_argument_is_recognised():
    with pytest.raises(UsageError, match="did you mean 'is_slippery'"):
        environment({"slippery": False}, None)


def test_a_map_too_large_for_gymnasiums_table_is_refused():
    with pytest.raises(DataError, match=r"D826.*10,001 cells"):
        environment({}, ["S" + "F" * 10_000])


def test_entering_the_goal_pays_what_the_environment_says():
    lake = environment({"reward_schedule": [2, -1, 0]}, ["SF", "HG"])
    assert lake.payoffs == (0.0, 0.0, -1.0, 2.0)
    assert environment({"is_slippery": False}, ["SF", "HG"]).payoffs == (0.0, 0.0, 0.0, 1.0)
