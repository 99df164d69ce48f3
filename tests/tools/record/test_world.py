"""The live environment: real steps, the same way back, and faults that are told in words."""

import numpy as np
import pytest

from stlspec.envs.catalogue import make_environment
from stlspec.errors import UsageError
from stlspec.tools.record.world import World

LAMP = "stlspec-tests/Lamp-v0"


def world_of(env: str, args: dict | None = None, rows: tuple | None = None, seed: int = 0) -> World:
    return World(make_environment(env, args, rows), seed)


def test_a_map_gives_rows_and_columns_and_the_real_dice() -> None:
    world = world_of("FrozenLake-v1", {"is_slippery": True}, seed=3)
    assert (world.kind, world.n_actions, world.reset(0).state) == ("map", 4, [0, 0])
    ways = [[world.step(action).state for action in (1, 2, 1, 2)] for _ in range(2) if world.reset(0)]
    assert ways[0] == ways[1], "the same episode has the same dice"
    ends = {tuple(world.step(1).state) for k in range(30) if world.reset(k)}
    assert len(ends) > 1, "other episodes have others"
    assert world.frame() is None
    world.close()


def test_going_back_repeats_the_steps() -> None:
    world = world_of("FrozenLake-v1", {"is_slippery": True})
    states = [world.reset(5).state] + [world.step(a).state for a in (1, 1, 2)]
    assert world.rewind(5, (1, 1)).state == states[2]
    assert world.step(2).state == states[3]
    world.close()


def test_observations_and_frames_of_other_environments() -> None:
    world = world_of(LAMP)
    assert (world.kind, world.first_action, world.n_actions) == ("frames", -1, 3)
    assert world.reset(0).state == [0.0, 0.5]
    moment = world.step(1)
    assert (moment.state, moment.info, moment.ended) == ([1.0, 0.5], {"watts": 60.0}, "")
    assert np.unique(world.frame()[..., 0]).tolist() == [40]
    world.step(1)
    assert world.step(1).ended == "the environment ended the episode here"
    world.close()


@pytest.mark.parametrize(
    ("fault", "reason"),
    [("step", "ZeroDivisionError: the fuse blew"), ("render", "no bulb"), ("nan", "finite numbers")],
)
def test_a_fault_of_the_environment_is_told_in_words(fault: str, reason: str) -> None:
    world = world_of(LAMP, {"fault": fault})
    world.reset(0)
    with pytest.raises(UsageError, match="D885") as caught:
        world.frame() if fault == "render" else world.step(1)
    found = caught.value.diagnostics[0]
    assert reason in found.message + found.help
    world.close()


def test_actions_that_are_no_keys_are_refused() -> None:
    with pytest.raises(UsageError, match="its actions are Box"):
        world_of("Pendulum-v1")


def test_a_missing_pygame_is_told_with_the_way_out(monkeypatch: pytest.MonkeyPatch) -> None:
    world = world_of(LAMP, {"fault": "pygame"})
    world.reset(0)
    monkeypatch.setattr("stlspec.tools.record.world.find_spec", lambda name: None)
    with pytest.raises(UsageError) as caught:
        world.frame()
    assert "stlspec[record]" in caught.value.diagnostics[0].help
    world.close()


def test_the_step_limit_is_told_apart_from_an_end() -> None:
    world = world_of("FrozenLake-v1", {"is_slippery": False})
    world.reset(0)
    moments = [world.step(0) for _ in range(100)]
    assert moments[-1].ended == "the environment's step limit is reached"
    assert not moments[-2].ended
    world.close()
