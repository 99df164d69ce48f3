"""Measure the learner, with the hard requirements watched and the mask, beside a plain loop on the same lake.

Run it as `python tests/learning/speed.py`. The plain loop is what one writes first: gymnasium's FrozenLake 8x8 (not
slippery), a numpy table, an epsilon-greedy action, the usual update; nothing is watched. Both learn for the same
number of steps, one after the other, five times. It prints steps a second and the median ratio, and exits with 1 if
that is below 12. A coarse clock is refused.
"""

import statistics
import sys
import time
from pathlib import Path

import gymnasium
import numpy as np

from stlspec import api
from stlspec.demos import load_demonstrations
from stlspec.envs.catalogue import make_environment
from stlspec.learning import learn

SPECS = Path(__file__).parents[2] / "specs"
ARGS = {"map_name": "8x8", "is_slippery": False}
LEAST = 12
EPISODES = 20_000


def plain(steps, gamma=0.99, alpha=0.1, epsilon=0.4, seed=0):
    """Learn for so many steps in the usual loop; return the seconds."""
    env = gymnasium.make("FrozenLake-v1", **ARGS)
    random = np.random.default_rng(seed)
    q = np.zeros((env.observation_space.n, env.action_space.n))
    state, _ = env.reset(seed=seed)
    began = time.perf_counter()
    for _ in range(steps):
        action = int(random.integers(4)) if random.random() < epsilon else int(np.argmax(q[state]))
        after, reward, terminated, truncated, _ = env.step(action)
        target = reward if terminated else reward + gamma * np.max(q[after])
        q[state, action] += alpha * (target - q[state, action])
        state = env.reset()[0] if terminated or truncated else after
    return time.perf_counter() - began


def watched(seed):
    """Learn with requirements and mask; return steps and seconds, set-up and greedy checks included."""
    bundle = api.compile(SPECS / "frozenlake_8x8.stl")
    world = make_environment("FrozenLake-v1", ARGS)
    demos = load_demonstrations([SPECS / "demos" / "frozenlake_8x8.jsonl"])
    began = time.perf_counter()
    outcome = learn(bundle, world, demos, episodes=EPISODES, seed=seed)
    seconds = time.perf_counter() - began
    assert outcome.success
    return outcome.training.env_steps, seconds


def main():
    if time.get_clock_info("perf_counter").resolution > 1e-6:
        print("the clock is too coarse to measure with")
        return 2
    rows = []
    for seed in range(5):
        steps, ours = watched(seed)
        count = min(steps, 100_000)
        theirs = plain(count, seed=seed)
        rows.append((steps / ours, count / theirs))
        print(f"run {seed + 1}: {rows[-1][0]:11,.0f} steps/s, plain loop {rows[-1][1]:9,.0f} steps/s")
    ratio = statistics.median(ours / theirs for ours, theirs in rows)
    print(f"median ratio {ratio:.1f}, wanted {LEAST}")
    return int(ratio < LEAST)


if __name__ == "__main__":
    sys.exit(main())
