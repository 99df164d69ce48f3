"""Specs, maps and demonstrations that the tests of learning share; sweep.py imports them too."""

import itertools
import json
import random
from collections import deque
from pathlib import Path
from types import SimpleNamespace

import pytest

from stlspec import api
from stlspec.demos import make_demonstration
from stlspec.envs.catalogue import make_environment

GRID_SPEC = """
spec grid "Single-goal grid-world"
signal d_obs
signal d_goal
param T_goal
let at_goal = d_goal < 1
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually at_goal
soft fast depends on avoid, reach: eventually[0, T_goal] at_goal
"""

GRIDWORLD = "stlspec/GridWorld-v0"
FROZENLAKE = "FrozenLake-v1"


def grid_bundle(t_goal):
    return api.compile(GRID_SPEC, params={"T_goal": t_goal})


def grid_rows(size, start, goals, obstacles):
    rows = [["."] * size for _ in range(size)]
    for (row, column), mark in [(start, "S"), *((g, "G") for g in goals), *((o, "#") for o in obstacles)]:
        rows[row][column] = mark
    return tuple("".join(row) for row in rows)


def grid_world(rows):
    return make_environment(GRIDWORLD, None, rows)


def frozen_lake(rows):
    return make_environment(FROZENLAKE, {"is_slippery": False}, rows)


def demonstrations(paths):
    return [make_demonstration(f"d{i}", states=[list(s) for s in path]) for i, path in enumerate(paths)]


def public_items(kind="grid-single"):
    place = Path(__file__).with_name("public.json")
    return [item for item in json.loads(place.read_text())["items"] if item["kind"] == kind]


def item_parts(item):
    """Return bundle, environment and demonstrations of a single-goal item."""
    rows = grid_rows(item["size"], item["start"], item["goals"], item["obstacles"])
    demos = demonstrations([d["states"] for d in item["demos"]])
    return grid_bundle(item["t_goal_bfs"]), grid_world(rows), demos


TOUR_SPEC = """
signal d_obs
{signals}
param T_goal
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: {reach}
soft fast depends on avoid, reach: {fast}
"""


def tour_bundle(goals, t_goal):
    """Compile the grid's spec with one numbered goal after another, all to be visited within T_goal."""
    names = [f"d_goal_{k}" for k in range(1, goals + 1)]
    text = TOUR_SPEC.format(
        signals="\n".join(f"signal {name}" for name in names),
        reach=" and ".join(f"eventually ({name} < 1)" for name in names),
        fast=" and ".join(f"eventually[0, T_goal] ({name} < 1)" for name in names),
    )
    return api.compile(text, params={"T_goal": t_goal})


def tour_rows(size, start, goals, obstacles):
    rows = [list(row) for row in grid_rows(size, start, [], obstacles)]
    for number, (row, column) in enumerate(goals, 1):
        rows[row][column] = str(number)
    return tuple("".join(row) for row in rows)


def tour_parts(item):
    """Return bundle, environment and demonstrations of an item with several goals."""
    rows = tour_rows(item["size"], item["start"], item["goals"], item["obstacles"])
    demos = demonstrations([d["states"] for d in item["demos"]])
    return tour_bundle(len(item["goals"]), item["t_goal_bfs"]), grid_world(rows), demos


def random_tour(size, goals, seed, share=0.15):
    """Make a map on which all goals can be visited, with two good demonstrations; all by the seed.

    T_goal is the shortest tour: over all orders, each leg breadth first.
    """
    draw = random.Random(f"{size}/{goals}/{seed}")
    cells = [(r, c) for r in range(size) for c in range(size)]
    while True:
        start, *wanted = draw.sample(cells, goals + 1)
        rest = [cell for cell in cells if cell not in (start, *wanted)]
        blocked = set(draw.sample(rest, max(1, round(share * size * size))))
        orders = {order: joined(size, (start, *order), blocked) for order in itertools.permutations(wanted)}
        if None not in orders.values():
            break
    best = min(orders.values(), key=len)
    other = draw.choice(sorted(orders.values()))
    rows = tour_rows(size, start, wanted, blocked)
    return tour_bundle(goals, len(best) - 1), grid_world(rows), demonstrations([best, other])


def joined(size, stops, blocked):
    """Go from stop to stop, each time the shortest way; None if there is none."""
    path = [stops[0]]
    for before, after in itertools.pairwise(stops):
        part = shortest_path(size, before, after, blocked)
        if part is None:
            return None
        path += part[1:]
    return path


def shortest_path(size, start, goal, blocked):
    """Search breadth first, on cells; None if there is no path."""
    before, queue = {start: None}, deque([start])
    while queue:
        cell = queue.popleft()
        if cell == goal:
            path = [cell]
            while before[path[-1]] is not None:
                path.append(before[path[-1]])
            return path[::-1]
        for dr, dc in ((0, -1), (1, 0), (0, 1), (-1, 0)):
            after = (cell[0] + dr, cell[1] + dc)
            inside = 0 <= after[0] < size and 0 <= after[1] < size
            if inside and after not in blocked and after not in before:
                before[after] = cell
                queue.append(after)
    return None


def random_task(size, seed, share=0.15):
    """Make a map that can be solved, with a good, a roundabout and a bad demonstration; all by the seed."""
    draw = random.Random(f"{size}/{seed}")
    start, goal = (size - 1, 0), (0, size - 1)
    cells = [(r, c) for r in range(size) for c in range(size) if (r, c) not in (start, goal)]
    while True:
        blocked = set(draw.sample(cells, max(1, round(share * size * size))))
        good = shortest_path(size, start, goal, blocked)
        if good is None:
            continue
        through = draw.choice(sorted(set(cells) - blocked))
        halves = shortest_path(size, start, through, blocked), shortest_path(size, through, goal, blocked)
        hit = draw.choice(sorted(blocked))
        bad = shortest_path(size, start, hit, set()), shortest_path(size, hit, goal, set())
        if None not in halves and goal not in halves[0] and goal not in bad[0]:
            break
    paths = [good, halves[0] + halves[1][1:], bad[0] + bad[1][1:]]
    rows = grid_rows(size, start, [goal], blocked)
    return grid_bundle(len(good) - 1), grid_world(rows), demonstrations(paths), len(blocked)


@pytest.fixture(scope="session")
def kit():
    """The helpers of this file, for test modules, which cannot import it."""
    return SimpleNamespace(
        grid_bundle=grid_bundle,
        grid_world=grid_world,
        frozen_lake=frozen_lake,
        demonstrations=demonstrations,
        public_items=public_items,
        item_parts=item_parts,
        random_task=random_task,
        tour_parts=tour_parts,
        random_tour=random_tour,
    )


@pytest.fixture(scope="session")
def small():
    """A 5x5 task: bundle, environment, demonstrations."""
    return item_parts(public_items()[0])
