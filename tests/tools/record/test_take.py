"""What is shown live is what an evaluation of the same samples gives."""

import random

import pytest

import stlspec
from stlspec.envs.catalogue import make_environment
from stlspec.errors import DataError, UsageError
from stlspec.tools.record.take import Follower, Take
from stlspec.tools.record.world import Moment, World

SPEC = """signal d_obs
signal d_goal
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually (d_goal < 1)
soft calm depends on avoid: always[1, 4] (d_goal >= 1 implies eventually[0, 3] (d_obs > 1))
"""
GRID = make_environment("stlspec/GridWorld-v0", None, ("..G", ".#.", "S.."))


def grown(take: Take, world: World, action: int) -> Take:
    return take.then(action, world.step(action))


def test_steps_back_and_forth_agree_with_the_evaluation_each_time() -> None:
    bundle, world = stlspec.compile(SPEC), World(GRID)
    follower, dice = Follower(bundle, GRID), random.Random(1)
    take = Take(0, (world.reset(0),))
    for _ in range(150):
        if take.actions and dice.random() < 0.4:
            back = dice.randint(1, min(len(take.actions), 5))
            for _ in range(back):
                take = take.before()
            world.rewind(0, take.actions)
        else:
            take = grown(take, world, dice.randrange(4))
        told = follower.standings(take)
        columns = GRID.signals(["d_obs", "d_goal"], [m.state for m in take.moments])
        result = bundle.evaluate(columns, end="interval")
        assert {n: s.current for n, s in told.requirements.items()} == {n: r.robustness for n, r in result.items()}
        for name, standing in told.requirements.items():
            assert standing.verdict == result[name].verdict
            assert standing.low <= standing.current <= standing.high
        assert told.signals == {name: column[-1] for name, column in columns.items()}


def test_going_back_further_than_copies_are_kept_is_right_too() -> None:
    bundle, world = stlspec.compile(SPEC), World(GRID)
    follower = Follower(bundle, GRID)
    takes = [Take(0, (world.reset(0),))]
    for k in range(150):
        takes.append(grown(takes[-1], world, (2, 0)[k % 2]))
        follower.standings(takes[-1])
    for k in (140, 20, 150, 0):
        fresh = Follower(bundle, GRID).standings(takes[k])
        assert follower.standings(takes[k]) == fresh


def test_the_spec_may_read_observations_actions_and_info() -> None:
    bundle = stlspec.compile(
        'signal level from "obs[0]"\nsignal turn from "action"\nsignal watts from "info.watts"\n'
        "hard h: always (level + watts + turn < 500)\n"
    )
    lamp = make_environment("stlspec-tests/Lamp-v0")
    world, follower = World(lamp), Follower(bundle, lamp)
    take = Take(0, (world.reset(0),))
    follower.check(take)
    assert "first action" in follower.standings(take).trouble
    take = grown(grown(take, world, 1), world, 0)
    told = follower.standings(take)
    assert told.signals == {"level": 1.0, "turn": 0.0, "watts": 60.0}
    # By hand: samples (0, 1, 0), (1, 1, 60), (1, 0, 60) of level, turn, watts.
    assert told.requirements["h"].current == 500 - 62
    assert take.demonstration("d", lamp, bundle).recording.columns["info.watts"].tolist() == [0, 60, 60]


def test_a_spec_that_does_not_fit_is_refused_before_the_page_opens() -> None:
    unknown = stlspec.compile("signal wind\nhard h: always (wind < 1)\n")
    take = Take(0, (Moment([2, 0]),))
    with pytest.raises(DataError, match="D804"):
        Follower(unknown, GRID).check(take)
    timed = stlspec.compile("time s\nsignal d_obs\nhard h: always[0, 2 s] (d_obs > 0)\n")
    with pytest.raises(UsageError, match="D885"):
        Follower(timed, GRID)


def test_a_sample_outside_its_range_is_told_not_raised() -> None:
    bundle = stlspec.compile("signal d_goal in [0, 3]\nsoft s: eventually (d_goal < 1)\n")
    told = Follower(bundle, GRID).standings(Take(0, (Moment([2, 0]),)))
    assert told.requirements == {}
    assert "d_goal" in told.trouble
