"""Drives of the mountain car, by a rule that is nearly the best: always push the way the car moves.

In: seeds of where the car starts. Out: the observations of each drive until the flag, as demonstrations have
them. The paper drove with a Q-table "with preset hyperparameters"; the rule needs no training and no luck.
"""

from typing import Any

from stlspec.envs.catalogue import make_environment, make_live

ID = "MountainCar-v0"
LEFT, RIGHT = 0, 2

Observation = tuple[float, float]


def drive(seed: int) -> tuple[Observation, ...]:
    """Drive from a random start to the flag.

    Paper: section 4, the "optimal demonstrations" of the mountain car.

    Args:    seed: of the environment, which draws the start.
    Returns: (n_samples,) position and velocity; the last sample is at the flag, after 80 to 160 steps.
    """
    live = make_live(make_environment(ID))
    observation, _ = live.reset(seed=seed)
    found = [_plain(observation)]
    done = False
    while not done:
        observation, _, terminated, truncated, _ = live.step(RIGHT if found[-1][1] >= 0 else LEFT)
        found.append(_plain(observation))
        done = terminated or truncated
    live.close()
    return tuple(found)


def _plain(observation: Any) -> Observation:
    # to six digits: in 32 bits the wall at -1.2 would come out as a little less
    position, velocity = (round(x, 6) for x in observation.tolist())
    return position, velocity
