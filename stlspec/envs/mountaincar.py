"""gymnasium's MountainCar as an `Environment`.

In: its one argument. Out: an environment whose states are raw observations [position, velocity], offered as
the signals of these names. It has no numbered states: whoever needs a table bins the observations first.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from stlspec.envs.model import Columns, Environment
from stlspec.errors import UsageError, diagnostic

ID = "MountainCar-v0"
_SIGNALS = ("position", "velocity")


def environment(args: Mapping[str, Any], map: Sequence[str] | None) -> Environment:  # noqa: A002
    """Describe the mountain car.

    Paper: the mountain-car experiment.

    Args: args: `goal_velocity`, a number, if anything. map: must be None.
    Raises: UsageError D821: another argument, or a map.
    """
    for name, value in args.items():
        if name != "goal_velocity" or type(value) not in (int, float):
            what = f"{name} = {str(value)[:40]}"
            raise UsageError([diagnostic("D821", id=ID, what=what, help="it takes goal_velocity, a number")])
    if map is not None:
        raise UsageError([diagnostic("D821", id=ID, what="a map", help="leave out the map")])
    return Environment(
        id=ID,
        args=dict(args),
        n_actions=3,
        max_steps=gymnasium.spec(ID).max_episode_steps,
        action_names=("left", "none", "right"),
        signal_names=_SIGNALS,
        state_signals=_SIGNALS,
        compute=_compute,
        options=dict(args),
    )


def _compute(names: Sequence[str], states: npt.NDArray[Any]) -> Columns:
    return {name: np.ascontiguousarray(states[:, _SIGNALS.index(name)], dtype=np.float64) for name in names}
