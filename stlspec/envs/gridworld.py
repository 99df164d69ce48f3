"""The grid-world of the paper, as a gymnasium environment and as an `Environment`.

In: a map as rows of text: S start, . free, # obstacle, G goal, 1 to 9 numbered goals, a lower-case letter a
named region. Out: `GridWorld`, whose observation is the number of the cell (row * columns + column), and its
table. The world never ends by itself, neither on goals nor on obstacles, and pays nothing: what counts as a
success, a violation or a reward is the spec's to say. Give `gymnasium.make` a `max_episode_steps` to
truncate.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import gymnasium

from stlspec.envs.maps import GRIDWORLD, four_moves, parse_map
from stlspec.envs.model import Environment
from stlspec.envs.signals import grid_signals, signal_names
from stlspec.errors import UsageError, diagnostic

ID = "stlspec/GridWorld-v0"
DEFAULT_MAP = ("....G", ".#...", "...#.", ".#...", "S....")
"""The map when none is given: 5x5, start bottom left, goal top right, three obstacles."""

_ACTIONS = ("left", "down", "right", "up")


class GridWorld(gymnasium.Env[Any, Any]):
    """A grid-world that never ends; observations are cell numbers, actions 0 left, 1 down, 2 right, 3 up.

    Obstacles can be entered, the border keeps one in place, the reward is always 0.
    """

    metadata: dict[str, Any] = {"render_modes": ["ansi"], "render_fps": 4}  # noqa: RUF012

    def __init__(
        self,
        map: Sequence[str] | None = None,  # noqa: A002
        render_mode: str | None = None,
    ) -> None:
        self.map = DEFAULT_MAP if map is None else tuple(map)
        self.grid = parse_map(self.map, GRIDWORLD)
        self.render_mode = render_mode
        self.observation_space = gymnasium.spaces.Discrete(self.grid.n_cells)
        self.action_space = gymnasium.spaces.Discrete(len(_ACTIONS))
        self._next = four_moves(self.grid)
        self._cell = self.grid.start

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Go back to the start; see `gymnasium.Env.reset`."""
        super().reset(seed=seed, options=options)
        self._cell = self.grid.start
        return self._cell, {}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        """Move one cell; see `gymnasium.Env.step`."""
        self._cell = int(self._next[self._cell, action])
        return self._cell, 0.0, False, False, {}

    def render(self) -> str | None:
        """Draw the map with the agent as @, when the render mode is "ansi"."""
        if self.render_mode != "ansi":
            return None
        row, column = divmod(self._cell, self.grid.n_columns)
        lines = list(self.map)
        lines[row] = lines[row][:column] + "@" + lines[row][column + 1 :]
        return "\n".join(lines) + "\n"


def register() -> None:
    """Make the environment known to gymnasium, once; a second call does nothing.

    Not in the paper: packaging.
    """
    if ID not in gymnasium.registry:
        gymnasium.register(id=ID, entry_point="stlspec.envs.gridworld:GridWorld")


def environment(args: Mapping[str, Any], map: Sequence[str] | None) -> Environment:  # noqa: A002
    """Describe a grid-world.

    Paper: the grid-world experiments.

    Args: args: none are taken. map: rows of text; None = `DEFAULT_MAP`.
    Raises: UsageError D821: there are arguments; DataError D823 to D826: the map is wrong.
    """
    if args:
        what = f"the argument '{next(iter(args))}'"
        raise UsageError([diagnostic("D821", id=ID, what=what, help="it takes a map only (--map FILE)")])
    rows = DEFAULT_MAP if map is None else tuple(map)
    grid = parse_map(rows, GRIDWORLD)
    return Environment(
        id=ID,
        map=rows,
        n_states=grid.n_cells,
        n_actions=len(_ACTIONS),
        start=grid.start,
        n_columns=grid.n_columns,
        table=four_moves(grid),
        deterministic=True,
        max_steps=4 * grid.n_cells,
        action_names=_ACTIONS,
        signal_names=signal_names(grid),
        state_signals=("row", "col"),
        compute=partial(grid_signals, grid),
        options={"map": list(rows)},
    )


# gymnasium 1.x reads no entry points: it learns of an environment when the module that defines it is
# imported, as in gymnasium.make("stlspec.gym:stlspec/GridWorld-v0") and gymnasium.register_envs.
register()
