"""Datasets of Minari as its own collector records them: gymnasium's environments, stepped, episode by episode."""

import warnings

import gymnasium
import numpy as np


def record(name, env_id, plans, **arguments):
    """Record one episode for each plan, a function from an observation and the step's number to an action."""
    import minari
    from minari.data_collector import EpisodeBuffer

    env = gymnasium.make(env_id, **arguments)
    buffers = []
    for seed, plan in enumerate(plans):
        observation, _ = env.reset(seed=seed)
        seen, taken, ends, rewards = [observation], [], [], []
        while not (ends and any(ends[-1])):
            taken.append(plan(observation, len(taken)))
            observation, reward, terminated, truncated, _ = env.step(taken[-1])
            seen.append(observation)
            rewards.append(float(reward))
            ends.append((terminated, truncated))
        stops = {"terminations": [t for t, _ in ends], "truncations": [t for _, t in ends]}
        seen, taken = np.array(seen), np.array(taken)
        buffers.append(EpisodeBuffer(id=seed, observations=seen, actions=taken, rewards=rewards, **stops))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it asks for an author and a permanent link
        minari.create_dataset_from_buffers(name, buffers, env=env, data_format="hdf5")


def frozen_lake(name):
    """Two ways to the goal of the 4x4 lake, and one into a hole."""
    ways = ([2, 2, 1, 1, 1, 2], [1, 1, 2, 2, 1, 2], [2, 1])
    record(name, "FrozenLake-v1", [lambda _, k, way=way: way[k] for way in ways], is_slippery=False)


def mountain_car(name):
    """Four swings up the hill; two of them touch the wall, where an observation is -1.2 in 32 bits."""
    record(name, "MountainCar-v0", [lambda seen, _: 2 if seen[1] >= 0 else 0] * 4)
