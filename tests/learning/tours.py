"""Measure the learner on tasks with several goals: the public items, and random maps on which it was never tried.

Run it as `python tests/learning/tours.py [MAPS] [FIRST]`, with MAPS random maps for each number of goals and size
(default 20), numbered from FIRST. T_goal is the length of the shortest tour, so that success means an optimal path.
It exits with 1 unless shaped learning meets hard requirements and goals every time, and all requirements on at
least 9 of 10.
"""

import sys
import time

from conftest import public_items, random_tour, tour_parts

from stlspec.learning import learn

SHAPES = ((2, 5), (2, 7), (2, 10), (3, 5), (3, 7), (3, 10), (4, 7))


def tasks(maps, first):
    """Yield (group, bundle, environment, demonstrations, seed)."""
    for item in public_items("grid-two-goal"):
        for seed in range(10):
            yield item["name"], *tour_parts(item), seed
    for goals, size in SHAPES:
        for number in range(first, first + maps):
            yield f"{goals} goals {size}x{size}", *random_tour(size, goals, number), number % 10


def main(maps=20, first=0):
    found = {}
    for group, bundle, world, demos, seed in tasks(maps, first):
        began = time.perf_counter()
        outcome = learn(bundle, world, demos, seed=seed)
        reached = outcome.evaluation["reach"].verdict.value == "satisfied"
        late = len(outcome.actions) - int(bundle.params[0].value)
        row = (outcome.success, outcome.meets_hard and reached, late, time.perf_counter() - began)
        found.setdefault(group, []).append(row)
    broken = False
    for group, rows in found.items():
        wins, goals = sum(row[0] for row in rows), sum(row[1] for row in rows)
        late, seconds = max(row[2] for row in rows), sum(row[3] for row in rows) / len(rows)
        counts = f"success {wins:3}/{len(rows):<3} goals {goals:3}/{len(rows):<3}"
        print(f"{group:18} {counts} late by <= {late:2}   {seconds:.2f} s")
        broken |= goals < len(rows) or wins < 0.9 * len(rows)
    return int(broken)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
