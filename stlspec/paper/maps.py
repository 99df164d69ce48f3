"""Maps with obstacles in random places, and demonstrations on them: good, roundabout and bad.

In: sizes and random numbers. Out: rows of text as `stlspec/GridWorld-v0` and FrozenLake have them, and paths as
cells (row, column). Everything is drawn from a `random.Random` that the caller seeds, so that a map and its
demonstrations are the same wherever they are made.
"""

import itertools
import random
from collections import deque
from collections.abc import Collection, Sequence

Cell = tuple[int, int]
Rows = tuple[str, ...]
Path = tuple[Cell, ...]

GOALS, OBSTACLES = "G123456789", "#H"
_MOVES = ((0, -1), (1, 0), (0, 1), (-1, 0))


def cells(rows: Sequence[str], marks: Collection[str]) -> Path:
    """Return the cells with one of the marks, ordered by mark, then by place."""
    found = [(mark, (r, c)) for r, row in enumerate(rows) for c, mark in enumerate(row) if mark in marks]
    return tuple(cell for _, cell in sorted(found))


def free(rows: Sequence[str]) -> frozenset[Cell]:
    """Return the cells that are no obstacle."""
    return frozenset((r, c) for r, row in enumerate(rows) for c, mark in enumerate(row) if mark not in OBSTACLES)


def distances(open_cells: Collection[Cell], target: Cell) -> dict[Cell, int]:
    """Search breadth first from a cell backwards.

    Paper: section 4, T_goal "is computed by running breadth-first search".

    Returns: for each cell that leads to `target` the least number of steps.
    """
    found, queue = {target: 0}, deque([target])
    while queue:
        row, column = queue.popleft()
        for dr, dc in _MOVES:
            after = (row + dr, column + dc)
            if after in open_cells and after not in found:
                found[after] = found[row, column] + 1
                queue.append(after)
    return found


def shortest(open_cells: Collection[Cell], stops: Sequence[Cell], draw: random.Random) -> Path:
    """Draw one of the shortest ways along stops, each step at random among those that come nearer.

    Not in the paper: its demonstrations were clicked by a user, or found by Q-learning.

    Raises: ValueError: there is no way.
    """
    path = [stops[0]]
    for target in stops[1:]:
        left = distances(open_cells, target)
        if path[-1] not in left:
            raise ValueError(f"no way from {path[-1]} to {target}")
        while path[-1] != target:
            row, column = path[-1]
            near = [(row + dr, column + dc) for dr, dc in _MOVES]
            path.append(draw.choice([n for n in near if left.get(n) == left[row, column] - 1]))
    return tuple(path)


def least_steps(rows: Sequence[str]) -> int:
    """Return the number of steps of a shortest way from S to all goals, in the best order of goals.

    Paper: section 4, T_goal.

    Raises: ValueError: there is no way.
    """
    goals, (start,) = cells(rows, GOALS), cells(rows, "S")
    open_cells = free(rows)
    left = {goal: distances(open_cells, goal) for goal in goals}
    lengths = [
        sum(left[b][a] for a, b in itertools.pairwise((start, *order)))
        for order in itertools.permutations(goals)
        if all(a in left[b] for a, b in itertools.pairwise((start, *order)))
    ]
    if not lengths:
        raise ValueError("no way to all goals")
    return min(lengths)


def random_map(size: int, goals: int, obstacles: int, draw: random.Random) -> Rows:
    """Make a map on which all goals can be reached.

    Paper: section 4, start in the lower left corner, goals in the corners on the right, "the obstacles were
    assigned randomly".

    Args: size: cells on a side. goals: 1 (marked G) or 2 (marked 1 and 2). obstacles: how many.
    """
    ends = {(size - 1, 0): "S"} | ({(0, size - 1): "G"} if goals == 1 else {(0, size - 1): "1", (size - 1,) * 2: "2"})
    inner = [(r, c) for r in range(size) for c in range(size) if (r, c) not in ends]
    while True:
        marks = ends | dict.fromkeys(draw.sample(inner, obstacles), "#")
        rows = tuple("".join(marks.get((r, c), ".") for c in range(size)) for r in range(size))
        try:
            least_steps(rows)
        except ValueError:
            continue
        return rows


def good_path(rows: Rows, draw: random.Random) -> Path:
    """Draw a shortest way from the start to all goals, in an order that makes it shortest."""
    goals, (start,) = cells(rows, GOALS), cells(rows, "S")
    orders = [shortest(free(rows), (start, *order), draw) for order in itertools.permutations(goals)]
    least = least_steps(rows)
    return draw.choice([path for path in orders if len(path) == least + 1])


def roundabout_path(rows: Rows, draw: random.Random) -> Path:
    """Draw a safe way to all goals that is longer than need be: through one more cell.

    Paper: section 4, its sub-optimal demonstrations.

    Raises: ValueError: every way is a shortest one.
    """
    goals, (start,) = cells(rows, GOALS), cells(rows, "S")
    reachable, least = sorted(distances(free(rows), start)), least_steps(rows)
    for through in draw.sample(reachable, len(reachable)):
        path = shortest(free(rows), (start, through, *draw.sample(goals, len(goals))), draw)
        arrived = max(path.index(goal) for goal in goals) == len(path) - 1
        if arrived and least < len(path) - 1 <= 2 * least:
            return path
    raise ValueError("every way is a shortest one")


def unfinished_path(rows: Rows, draw: random.Random) -> Path:
    """Draw a safe way that gives up half-way.

    Paper: section 4, its incomplete demonstrations.
    """
    path = good_path(rows, draw)
    return path[: len(path) // 2 + 1]


def bad_path(rows: Rows, draw: random.Random) -> Path:
    """Draw a way to all goals that goes through an obstacle; into a hole and no further on a lake.

    Paper: section 4, its bad demonstrations.

    Raises: ValueError: no obstacle can be reached.
    """
    goals, (start,) = cells(rows, GOALS), cells(rows, "S")
    reachable = distances(free(rows), start)
    near = [(r, c) for r, c in cells(rows, OBSTACLES) if any((r + dr, c + dc) in reachable for dr, dc in _MOVES)]
    if not near:
        raise ValueError("no obstacle can be reached")
    hit = draw.choice(near)
    onwards = () if rows[hit[0]][hit[1]] == "H" else goals
    return shortest(free(rows) | {hit}, (start, hit, *onwards), draw)


def moved_holes(rows: Rows, draw: random.Random) -> Rows:
    """Move all holes of a lake elsewhere, start and goal staying where they are.

    Paper: section 4, the unseen maps of FrozenLake.
    """
    count = len(cells(rows, "H"))
    places = cells(rows, "FH")
    while True:
        marks = dict.fromkeys(places, "F") | dict.fromkeys(draw.sample(places, count), "H")
        moved = tuple("".join(marks.get((r, c), m) for c, m in enumerate(row)) for r, row in enumerate(rows))
        try:
            least_steps(moved)
        except ValueError:
            continue
        return moved
