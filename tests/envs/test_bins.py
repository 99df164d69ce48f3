"""Bins: numbers for observations."""

import math

import numpy as np
import pytest

from stlspec.envs.bins import Bins, read_bins

CAR = Bins((-1.0, -10.0), (1.0, 10.0), (4, 5))


@pytest.mark.parametrize(
    ("observation", "number"),
    [
        ((-1.0, -10.0), 0),
        ((-0.51, -6.1), 0),
        ((-0.5, -10.0), 5),
        ((-1.0, -6.0), 1),
        ((0.99, 9.9), 19),
        ((1.0, 10.0), 19),  # the upper bound belongs to the last bin
        ((-7.0, 99.0), 4),  # beyond the bounds: the bin at the border
    ],
)
def test_observations_get_the_number_of_their_bin(observation, number):
    assert CAR.number(observation) == number
    assert CAR.number(np.array(observation)) == number


@pytest.mark.parametrize("observation", [(0.0,), (0.0, 0.0, 0.0), (math.nan, 0.0), (0.0, math.inf), "ab", (None, 0)])
def test_what_is_no_observation_is_refused(observation):
    with pytest.raises((ValueError, TypeError)):
        CAR.number(observation)


def test_three_axes_and_one():
    assert Bins((0.0,) * 3, (2.0,) * 3, (2, 2, 2)).number([1.5, 0.5, 1.5]) == 5
    assert Bins((0.0,), (6.0,), (6,)).number(np.int64(4)) == 4


def test_an_axis_without_bounds_is_squashed():
    """x / (1 + |x|) of -9, -1, 0, 1 and 9 is -0.9, -0.5, 0, 0.5 and 0.9; four bins from -1 to 1."""
    bins = Bins((-1.0,), (1.0,), (4,), (True,))
    assert [bins.number([x]) for x in (-9, -1, 0, 1, 9, 1e30)] == [0, 1, 2, 3, 3, 3]


def test_bins_survive_a_file():
    for bins in (CAR, Bins((-1.0,), (1.0,), (4,), (True,))):
        assert read_bins(bins.to_json()) == bins


@pytest.mark.parametrize(
    "change",
    [{"counts": [0, 5]}, {"counts": [4]}, {"low": [1.0, 0.0]}, {"high": [math.inf, 1.0]}, {"counts": [10**6, 10**6]}],
)
def test_damaged_bins_are_refused(change):
    with pytest.raises(ValueError, match="bins"):
        read_bins({**CAR.to_json(), **change})
