"""The account of a run, line by line."""

from types import SimpleNamespace

import pytest

from stlspec.envs.catalogue import make_environment
from stlspec.learning.account import sources, taught, way_on_map
from stlspec.learning.lessons import Forbidden, Lesson, Lessons, Source

GOOD = Lesson("rim", "good", 3, 4, (((0, 0), 0.1, 0), ((0, 1), 0.2, 3)), (), ())
BAD = Lesson("hole", "bad", 1, 3, (((1, 1), -0.5, 2),), (Forbidden((1, 0), "right", (1, 1)),) * 5, ("avoid",))
EMPTY = Lesson("lost", "incomplete", 2, 2, (((0, 0), 0.0, 1),), (), ())


def account(*lessons, method="shaped", memory=False):
    return taught(SimpleNamespace(method=method, lessons=Lessons(lessons, 0.6, False, memory)))


def test_demonstrations_are_told_best_first_with_what_they_taught():
    assert account(BAD, EMPTY, GOOD) == [
        "What the demonstrations taught:",
        "  rank 3  good        rim: leads through 2 states, adding up to 1.00 at [0, 1]",
        "  rank 2  incomplete  lost: is worth no reward",
        f"  rank 1  bad         hole: breaks avoid; forbids {', '.join(['right from [1, 0]'] * 3)}, 2 more",
    ]
    assert account() == []


def test_a_demonstration_of_another_map_forbids_nothing_here():
    elsewhere = Lesson("hole", "bad", 1, 3, (), (), ())
    assert "breaks a hard requirement; forbids nothing here" in account(elsewhere)[1]


def test_the_method_and_memory_are_mentioned():
    assert "only what they forbid" in account(GOOD, method="plain")[0]
    assert account(BAD, memory=True)[1].endswith("after the same past")


def test_many_demonstrations_are_cut_short():
    lines = account(*[GOOD] * 30)
    assert len(lines) == 14
    assert lines[-1] == "  and 18 more"


@pytest.mark.parametrize(
    ("env", "rows", "states", "drawn"),
    [
        ("stlspec/GridWorld-v0", ("S.G", ".#."), (0, 1, 2), ["  S o G", "  . # ."]),
        ("stlspec/GridWorld-v0", ("Swd", ".#1"), (0, 1, 2, 5), ["  S W D", "  . # 1"]),
        ("FrozenLake-v1", ("SFH", "FFG"), (0, 3, 4, 5), ["  S F H", "  o o G"]),
    ],
)
def test_the_way_is_drawn_over_free_cells_and_zones(env, rows, states, drawn):
    assert way_on_map(make_environment(env, None, rows), states) == drawn


def test_without_a_map_nothing_is_drawn():
    assert way_on_map(make_environment("MountainCar-v0"), (0,)) == []


def test_the_sources_of_a_reward_are_a_sum():
    lines = sources(Source((0, 1), 1.0, ((GOOD, 0.2, 3), (BAD, -0.5, 2)), 0.6, ((BAD, BAD.forbids[0]),), False, True))
    assert lines == [
        "state [0, 1]: reward 1",
        "= (3 * 0.2 + 1 * -0.5) / 0.6, the largest such sum of any state",
        "  rank 3 'rim', good: 0.2 at sample 3, 4/4 of what the demonstration is worth",
        "  rank 1 'hole', bad: -0.5 where it breaks avoid",
        "forbidden after the same past: right to [1, 1], which breaks avoid in 'hole'",
    ]


def test_what_is_not_known_is_said():
    assert "no demonstration" in sources(Source(3, 0.0, (), 0.6, (), False))[1]
    assert "was given a reward map" in sources(Source(3, 0.2, (), 0.0, (), True))[1]
