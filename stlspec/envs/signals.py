"""The signals that a grid offers, as functions of the cell.

In: a `Grid`, which cells of a map mean what. Out: for each signal an array with its value at every cell, or
at the cells of a sequence of states. Distances are Manhattan distances, computed for all cells at once; over
a finite set of states every signal is a table, so that scoring a state is one look-up.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

_KEPT_FIELDS = 32


@dataclass(frozen=True, slots=True)
class Grid:
    """A map read: its shape and what its cells are; cells are numbers, row * n_columns + column.

    goals: (k, cells) for each numbered goal, k from 1. regions: (letter, cells) for each named region.
    """

    n_rows: int
    n_columns: int
    start: int
    obstacles: tuple[int, ...]
    goals: tuple[tuple[int, tuple[int, ...]], ...]
    regions: tuple[tuple[str, tuple[int, ...]], ...] = ()

    @property
    def n_cells(self) -> int:
        """The number of cells."""
        return self.n_rows * self.n_columns


def manhattan(marked: npt.NDArray[np.bool_]) -> npt.NDArray[np.float64]:
    """Measure the Manhattan distance from every cell to the nearest marked one.

    Paper: the signals of the grid-world experiments; the paper does not say how they are computed.

    The distance separates: along each column first, then along each row, and on a line the nearest mark
    behind is min over j <= i of f(j) - j, plus i, which is a running minimum.

    Args:    marked: (n_rows, n_columns).
    Returns: (n_rows, n_columns), in cells, >= 0; +inf everywhere when nothing is marked.
    """
    distances = np.where(marked, 0.0, np.inf)
    for axis in (0, 1):
        shape = (-1, 1) if axis == 0 else (1, -1)
        index = np.arange(distances.shape[axis], dtype=np.float64).reshape(shape)
        behind = np.minimum.accumulate(distances - index, axis=axis) + index
        ahead = np.flip(np.minimum.accumulate(np.flip(distances + index, axis), axis=axis), axis) - index
        distances = np.minimum(behind, ahead)
    return distances


def signal_names(grid: Grid) -> tuple[str, ...]:
    """List the signals of a grid: row, col, d_obs, d_goal, each d_goal_k, in_x and d_x of each region."""
    goals = tuple(f"d_goal_{k}" for k, _ in grid.goals)
    regions = tuple(name for letter, _ in grid.regions for name in (f"in_{letter}", f"d_{letter}"))
    return ("row", "col", "d_obs", "d_goal", *goals, *regions)


@lru_cache(maxsize=_KEPT_FIELDS)
def field(grid: Grid, name: str) -> npt.NDArray[Any]:
    """Compute the signal `name` at every cell of the grid.

    Not in the paper: the paper names its signals and leaves open how they are measured.

    Returns: (n_cells,), float64, bool for `in_x`; not writeable, since it is kept.
    """
    values = _field(grid, name)
    values.flags.writeable = False
    return values


def grid_signals(grid: Grid, names: Sequence[str], cells: npt.NDArray[np.int64]) -> dict[str, npt.NDArray[Any]]:
    """Compute signals along a sequence of cells.

    Args:    names: some of `signal_names(grid)`. cells: (n_samples,), numbers of cells of the grid.
    Returns: for each name an array (n_samples,), float64, bool for `in_x`.
    """
    return {name: field(grid, name)[cells] for name in names}


def _field(grid: Grid, name: str) -> npt.NDArray[Any]:
    if name == "row":
        return np.repeat(np.arange(grid.n_rows, dtype=np.float64), grid.n_columns)
    if name == "col":
        return np.tile(np.arange(grid.n_columns, dtype=np.float64), grid.n_rows)
    kind, _, which = name.partition("_")
    marked = np.zeros(grid.n_cells, dtype=np.bool_)
    marked[list(_cells(grid, which))] = True
    if kind == "in":
        return marked
    return manhattan(marked.reshape(grid.n_rows, grid.n_columns)).reshape(-1)


def _cells(grid: Grid, which: str) -> tuple[int, ...]:
    if which == "obs":
        return grid.obstacles
    if which == "goal":
        return tuple(cell for _, cells in grid.goals for cell in cells)
    if which.startswith("goal_"):
        return dict(grid.goals)[int(which.removeprefix("goal_"))]
    return dict(grid.regions)[which]
