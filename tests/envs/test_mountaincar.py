import gymnasium
import numpy as np
import pytest

from stlspec.envs.mountaincar import environment
from stlspec.errors import UsageError


def test_observations_are_position_and_velocity():
    described = environment({}, None)
    live = gymnasium.make("MountainCar-v0", **described.options)
    observation, _ = live.reset(seed=0)
    found = described.signals(["position", "velocity"], [observation])
    assert found["position"].tolist() == [float(observation[0])]
    assert found["velocity"].tolist() == [float(observation[1])]
    assert found["position"].dtype == np.float64


def test_it_says_that_its_states_have_no_numbers():
    described = environment({"goal_velocity": 0.01}, None)
    assert (described.n_states, described.n_actions, described.max_steps) == (0, 3, 200)
    assert not described.deterministic and described.transitions is None
    assert described.state_signals == ("position", "velocity")


@pytest.mark.parametrize(("args", "rows"), [({"gravity": 1}, None), ({"goal_velocity": "fast"}, None), ({}, ["S.G"])])
def test_it_takes_no_other_argument_and_no_map(args, rows):
    with pytest.raises(UsageError, match="D821"):
        environment(args, rows)
