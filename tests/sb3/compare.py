"""Train agents of Stable-Baselines3 on PointMaze with and without a spec, and compare what they do.

Run it as `python tests/sb3/compare.py [SEEDS] [STEPS]` in an environment with the extra `sb3` and
gymnasium-robotics. All agents are PPO with the same settings on the environment's own dense reward; "spec" means
`STLReward` with specs/point_maze.stl around every copy, a violation costing 1. Both kinds are evaluated on the
same episodes, with the same spec as the judge. It prints a line for each agent and the medians, and exits with 1
unless the agents with the spec violate it less often, and more often reach the goal without violating it.
"""

import statistics
import sys
import time
from pathlib import Path

import gymnasium
import gymnasium_robotics
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env

from stlspec.gym import STLReward

ENV = "PointMaze_UMazeDense-v3"
SPEC = Path(__file__).parents[2] / "specs" / "point_maze.stl"
COPIES, EPISODES = 8, 100


def plain():
    return gymnasium.make(ENV)


def with_spec():
    return STLReward(plain(), SPEC, on_violation="penalise")


def evaluate(model):
    """Return the shares of episodes that violate, that reach the goal, that do both right, and steps too fast."""
    env = STLReward(plain(), SPEC, on_violation="ignore")
    violating = reaching = right = steps = fast = 0
    for episode in range(EPISODES):
        observation, info = env.reset(seed=10_000 + episode)
        broken, over = info["violation"], False
        while not over:
            action, _ = model.predict(observation, deterministic=True)
            observation, _, terminated, truncated, info = env.step(action)
            steps, fast = steps + 1, fast + info["violation"]
            broken, over = broken or info["violation"], terminated or truncated
        violating += broken
        reaching += info["satisfied"]["reach"]
        right += info["satisfied"]["reach"] and not broken
    return violating / EPISODES, reaching / EPISODES, right / EPISODES, fast / steps


def main(seeds, steps):
    gymnasium.register_envs(gymnasium_robotics)
    torch.set_num_threads(1)
    found = {}
    for seed in range(seeds):
        for name, make in (("plain", plain), ("spec", with_spec)):
            began = time.perf_counter()
            env = make_vec_env(make, COPIES, seed=seed)
            model = PPO("MultiInputPolicy", env, seed=seed, n_steps=256, batch_size=256, gamma=0.99, device="cpu")
            model.learn(steps)
            row = evaluate(model)
            found.setdefault(name, []).append(row)
            shown = "violates {:.2f}, reaches {:.2f}, both right {:.2f}, steps too fast {:.3f}".format(*row)
            print(f"seed {seed} {name:5} {shown}   {time.perf_counter() - began:.0f} s", flush=True)
    medians = {name: [statistics.median(column) for column in zip(*rows, strict=True)] for name, rows in found.items()}
    for name, row in medians.items():
        print(
            "median {:5} violates {:.2f}, reaches {:.2f}, both right {:.2f}, steps too fast {:.3f}".format(name, *row)
        )
    return int(not (medians["spec"][0] < medians["plain"][0] and medians["spec"][2] > medians["plain"][2]))


if __name__ == "__main__":
    given = [int(argument) for argument in sys.argv[1:]]
    sys.exit(main(*(given + [3, 300_000][len(given) :])))
