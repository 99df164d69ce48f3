"""Living environments: bins from their spaces, signals from their steps."""

import numpy as np
import pytest

from stlspec import api
from stlspec.compiler.bundle import Signal
from stlspec.envs.bins import Bins
from stlspec.envs.catalogue import make_environment
from stlspec.envs.live import bare, reader_of, readers_of, sample_of, with_bins
from stlspec.errors import UsageError


def test_the_wrappers_that_only_check_and_count_are_left_out():
    live = bare(make_environment("MountainCar-v0"))
    assert live is live.unwrapped
    live.close()


def test_bins_lie_between_the_bounds_of_the_observation():
    car = with_bins(make_environment("MountainCar-v0"), (50,))
    assert car.bins.counts == (50, 50)
    assert car.bins.low == pytest.approx((-1.2, -0.07))
    assert (car.n_actions, car.max_steps, car.size, car.n_states) == (3, 200, 2500, 0)
    assert car.encode([-1.2, -0.07]) == 0
    assert car.encode(2499) == 2499


def test_entries_without_bounds_are_squashed_and_discrete_observations_numbered():
    cart = with_bins(make_environment("CartPole-v1"), (3, 4, 5, 6))
    assert cart.bins.squashed == (False, True, False, True)
    assert with_bins(make_environment("CliffWalking-v1"), None).bins == Bins((0.0,), (48.0,), (48,))


@pytest.mark.parametrize(
    ("env", "counts", "part"),
    [
        ("MountainCar-v0", None, "--bins 50,50"),
        ("MountainCar-v0", (5, 5, 5), "1 or 2 whole numbers"),
        ("MountainCar-v0", (0, 5), "whole numbers from 1"),
        ("MountainCar-v0", (10**4, 10**4), "at most"),
        ("CliffWalking-v1", (5,), "discrete"),
        ("MountainCarContinuous-v0", (5,), "Discrete"),
        ("Blackjack-v1", (5,), "flat Box"),
    ],
)
def test_what_has_no_bins_is_refused(env, counts, part):
    with pytest.raises(UsageError, match=part):
        with_bins(make_environment(env), counts)


STEP = ({"key": np.array([1.0, 2.5])}, np.array([7.0, 8.0]), {"speed": np.float32(0.5), "deep": {"x": 3}})


@pytest.mark.parametrize(
    ("source", "value"),
    [("obs.key[1]", 2.5), ("action[0]", 7.0), ("info.speed", 0.5), ("info.deep.x", 3)],
)
def test_signals_are_read_by_their_path(source, value):
    sample = sample_of({"s": reader_of(Signal("s", source=source), (), "E")}, *STEP, "E")
    assert sample == {"s": value}


def test_a_discrete_action_is_its_first_entry_and_names_are_entries():
    assert reader_of(Signal("s", source="action[0]"), (), "E")(None, 2, {}) == 2
    assert reader_of(Signal("velocity"), ("position", "velocity"), "E")([1.0, 2.0], None, {}) == 2.0


def test_what_cannot_be_read_is_a_diagnostic():
    with pytest.raises(UsageError, match="D870"):
        reader_of(Signal("s"), ("position",), "E")
    with pytest.raises(UsageError, match="D879"):
        sample_of({"s": reader_of(Signal("s", source="obs[4]"), (), "E")}, [1.0], None, {}, "E")
    with pytest.raises(UsageError, match="D879"):
        sample_of({"s": reader_of(Signal("s", source="info.speed"), (), "E")}, [1.0], None, {}, "E")


def test_a_bound_that_came_back_with_32_bits_is_the_bound():
    bundle = api.compile('signal p in [-1.2, 0.6] from "obs[0]"\nhard a: always (p >= -1.2)')
    read = readers_of(bundle, (), "E")["p"]
    assert read([float(np.float32(-1.2))], None, {}) == -1.2
    assert read([-1.3], None, {}) == -1.3
    assert read([0.25], None, {}) == 0.25


def test_a_wrong_number_of_bins_is_told_the_right_one():
    for counts, way in (((5, 5), "--bins 50,50,50,50"), ((1000,), "cut each entry into fewer bins")):
        with pytest.raises(UsageError) as error:
            with_bins(make_environment("CartPole-v1"), counts)
        (found,) = error.value.diagnostics
        assert (found.code, found.help) == ("D871", way)
