"""Measure the learner on all public single-goal items, on fresh random maps and on FrozenLake.

Run it as `python tests/learning/sweep.py [MAPS]`, with MAPS random maps a size (default 20). It prints, for
each group, how often shaped and plain learning succeed, the median of the steps to success, and the largest
number of violations for each obstacle. It exits with 1 if a promise is broken: shaped learning always
succeeds, needs at most a third of plain learning's steps on 10x10, and violates at most 4 times an obstacle.
"""

import statistics
import sys
import time

from conftest import FROZENLAKE, demonstrations, frozen_lake, grid_bundle, item_parts, public_items, random_task
from gymnasium.envs.toy_text.frozen_lake import MAPS

from stlspec.learning import learn

SEEDS = range(10)


def lake_tasks():
    """FrozenLake: the public items on their own and on unseen maps, with demonstrations of the train map."""
    for item in public_items("frozenlake-transfer"):
        train = tuple(MAPS[item["train_map"]])
        demos = demonstrations([d["states"] for d in item["demos"]])
        for rows in (train, *map(tuple, item["test_maps"])):
            # an unseen map may need a longer way round than the train map: slack, as the spec allows
            t_goal = item["t_goal_bfs"] + (0 if rows == train else 4)
            yield len(rows), grid_bundle(t_goal), frozen_lake(rows), demos, frozen_lake(train), rows


def groups(maps):
    """Yield (name, size, bundle, environment, demonstrations, their environment, obstacles, seeds)."""
    for item in public_items():
        yield f"public {item['size']}", *item_parts(item), None, len(item["obstacles"]), SEEDS
    for size in (5, 7, 10):
        for number in range(maps):
            bundle, world, demos, obstacles = random_task(size, number)
            yield f"random {size}", bundle, world, demos, None, obstacles, range(2)
    for size, bundle, world, demos, home, rows in lake_tasks():
        yield f"{FROZENLAKE} {size}", bundle, world, demos, home, "".join(rows).count("H"), range(3)


def main(maps):
    found = {}
    for name, bundle, world, demos, home, obstacles, seeds in groups(maps):
        for seed in seeds:
            for method in ("shaped", "plain"):
                outcome = learn(bundle, world, demos, method=method, seed=seed, demo_environment=home)
                training = outcome.training
                found.setdefault((name, method), []).append(
                    (
                        outcome.success,
                        training.env_steps_to_success,
                        training.hard_violations / max(1, obstacles),
                        training.env_steps / training.seconds / 1e6,
                    )
                )
    broken = False
    medians = {}
    for (name, method), rows in found.items():
        steps = [row[1] for row in rows if row[1] is not None]
        medians[name, method] = statistics.median(steps) if steps else float("nan")
        wins, worst = sum(row[0] for row in rows), max(row[2] for row in rows)
        speed = statistics.median(row[3] for row in rows)
        print(
            f"{name:18} {method:7} success {wins:3}/{len(rows):<3} steps to success {medians[name, method]:8.0f}"
            f"   violations/obstacle <= {worst:.2f}   {speed:.1f} M steps/s"
        )
        broken |= method == "shaped" and (wins < len(rows) or worst > 4)
    for name in ("public 10", "random 10"):
        ratio = medians[name, "plain"] / medians[name, "shaped"]
        print(f"{name}: plain needs {ratio:.1f} times the steps of shaped")
        broken |= not ratio >= 3
    return int(broken)


if __name__ == "__main__":
    began = time.perf_counter()
    code = main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
    print(f"{time.perf_counter() - began:.0f} s")
    sys.exit(code)
