"""Measure the learner on demonstrated and on unseen maps, shaped against plain.

Run it as `python tests/learning/sweep.py [MAPS]`, with MAPS random maps of each kind (default 20), on all cores.
For every map it takes the median of `env_steps_to_success` over 20 seeds, for shaped and for plain learning, and
for a control: shaped by a reward that is the same everywhere, so that nothing in it comes from demonstrations.
It prints, for each kind of map, how often each succeeds and how many times fewer steps than plain the others
need (quartiles over the maps, and the worst map), and exits with 1 if a promise is broken.

A single map has quartiles over its seeds in the last columns.
"""

import os
import statistics
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from math import inf

import numpy as np
from conftest import (
    FROZENLAKE,
    demonstrations,
    frozen_lake,
    grid_bundle,
    item_parts,
    public_items,
    random_task,
    shortest_path,
)
from gymnasium.envs.toy_text.frozen_lake import MAPS, generate_random_map

from stlspec.learning import learn
from stlspec.rewards import RewardMap

SEEDS = range(20)
SHAPED, PLAIN, CONTROL = "shaped", "plain", "control"

PROMISES = {
    "demonstrated grid 5": 1.3, "demonstrated grid 7": 2.0, "demonstrated grid 10": 4.0,
    "demonstrated lake 8": 4.0, "public unseen lake 8": 1.5, "random unseen lake 8": 1.5,
}  # fmt: skip
"""How many times fewer steps than plain the median map of a kind needs."""

WORST = 0.8
"""And on no unseen lake more than 1.25 times as many."""


def steps_needed(rows):
    """Search breadth first on a lake, from corner to corner."""
    holes = {(r, c) for r, row in enumerate(rows) for c, mark in enumerate(row) if mark == "H"}
    last = len(rows) - 1
    return len(shortest_path(len(rows), (0, 0), (last, last), holes)) - 1


def demonstrated(maps):
    """Yield (kind, name, bundle, environment, demonstrations, their environment), all on the same map."""
    for item in public_items():
        yield f"public demonstrated grid {item['size']}", item["name"], *item_parts(item), None
    for size in (5, 7, 10):
        for number in range(maps):
            bundle, world, demos, _ = random_task(size, number)
            yield f"demonstrated grid {size}", f"random {number}", bundle, world, demos, None
    for item in public_items("frozenlake-transfer"):
        world = frozen_lake(tuple(MAPS[item["train_map"]]))
        demos = demonstrations([d["states"] for d in item["demos"]])
        size = item["train_map"][0]
        yield f"demonstrated lake {size}", item["name"], grid_bundle(item["t_goal_bfs"]), world, demos, None


def unseen(maps):
    """Yield the same for demonstrations of the stock map used on other maps, the goal to be reached in time."""
    for item in public_items("frozenlake-transfer"):
        home = frozen_lake(tuple(MAPS[item["train_map"]]))
        demos = demonstrations([d["states"] for d in item["demos"]])
        size = int(item["train_map"][0])
        drawn = [generate_random_map(size, (0.8, 0.7, 0.85, 0.75)[k % 4], seed=9_000 + k) for k in range(maps)]
        for kind, rows in [("public", m) for m in item["test_maps"]] + [("random", m) for m in drawn]:
            bundle = grid_bundle(steps_needed(tuple(rows)))
            yield f"{kind} unseen lake {size}", "/".join(rows), bundle, frozen_lake(tuple(rows)), demos, home


def run(job):
    method, seed, bundle, world, demos, home = job
    options = {"seed": seed, "demo_environment": home, "method": PLAIN if method == PLAIN else SHAPED}
    reward = None
    if method == CONTROL:
        states = [tuple(world.decode(s)) for s in range(world.n_states)]
        reward = RewardMap("", {"id": None}, tuple(states), (1e-9,) * len(states))
    outcome = learn(bundle, world, demos, reward, **options)
    training = outcome.training
    return outcome.success, training.env_steps_to_success or inf, training.hard_violations


def quartiles(values):
    return " ".join(f"{x:6.2f}" for x in np.percentile(values, [25, 50, 75]))


def report(kind, names, found):
    """Print the table of one kind of map; return whether its promises hold."""
    plain = {name: statistics.median(r[1] for r in found[name, PLAIN]) for name in names}
    good = True
    print(f"{kind}: {len(names)} maps, plain needs {statistics.median(plain.values()):.0f} steps (median)")
    for method in (SHAPED, CONTROL):
        rows = [r for name in names for r in found[name, method]]
        wins, violations = sum(r[0] for r in rows), max(r[2] for r in rows)
        if len(names) == 1:
            ratios = [plain[names[0]] / r[1] for r in rows]
        else:
            ratios = [plain[name] / statistics.median(r[1] for r in found[name, method]) for name in names]
        middle, worst = statistics.median(ratios), min(ratios)
        print(
            f"   {method:8} success {wins}/{len(rows)}   times fewer steps: quartiles {quartiles(ratios)}"
            f"   worst {worst:.2f}   violations in a run <= {violations}"
        )
        if method == SHAPED:
            good = wins == len(rows) and middle >= PROMISES.get(kind.removeprefix("public "), PROMISES.get(kind, 0))
            good &= "unseen" not in kind or worst >= WORST
    return good


def main(maps):
    jobs, keys, kinds = [], [], {}
    for kind, name, bundle, world, demos, home in (*demonstrated(maps), *unseen(maps)):
        kinds.setdefault(kind, []).append(name)
        for method in (SHAPED, PLAIN, CONTROL):
            for seed in SEEDS:
                jobs.append((method, seed, bundle, world, demos, home))
                keys.append((kind, name, method))
    found = {}
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for key, result in zip(keys, pool.map(run, jobs, chunksize=20), strict=True):
            found.setdefault(key, []).append(result)
    broken = False
    for kind, names in kinds.items():
        part = {(n, m): found[kind, n, m] for n in names for m in (SHAPED, PLAIN, CONTROL)}
        broken |= not report(kind, names, part)
    return int(broken)


if __name__ == "__main__":
    began = time.perf_counter()
    print(f"{FROZENLAKE}, grid-worlds; seeds {SEEDS.start} to {SEEDS.stop - 1}")
    code = main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
    print(f"{'a promise is broken' if code else 'all promises hold'}; {time.perf_counter() - began:.0f} s")
    sys.exit(code)
