"""gymnasium's FrozenLake as an `Environment`.

In: the arguments of `gymnasium.make("FrozenLake-v1", ...)`, with its defaults (so it is slippery unless told
otherwise), and rows of S, F, H and G. Out: its table, read from gymnasium's own, never rebuilt here: the
deterministic one, or the outcomes with their probabilities on slippery ice.
"""

import difflib
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.envs.toy_text.frozen_lake import MAPS

from stlspec.envs.foreign import make_quietly
from stlspec.envs.maps import FROZENLAKE, parse_map
from stlspec.envs.model import Environment, Outcomes
from stlspec.envs.signals import grid_signals, signal_names
from stlspec.errors import UsageError, diagnostic

ID = "FrozenLake-v1"
_ARGUMENTS = ("map_name", "is_slippery", "desc", "success_rate", "reward_schedule")
_EXPECTED = {
    "map_name": "'4x4' or '8x8'",
    "is_slippery": "true or false",
    "desc": "a list of rows of text",
    "success_rate": "a number from 0 to 1",
    "reward_schedule": "three numbers: goal, hole, frozen",
}


def environment(args: Mapping[str, Any], map: Sequence[str] | None) -> Environment:  # noqa: A002
    """Describe a frozen lake.

    Paper: the FrozenLake experiments.

    Args: args: those of gymnasium. map: rows of text; they win over `desc`, and that over `map_name`.
    Raises: UsageError D821: an argument is unknown or of the wrong kind; DataError D823 to D826: the map is
        wrong.
    """
    for name, value in args.items():
        _check(name, value)
    rows = tuple(map or args.get("desc") or MAPS[args.get("map_name", "4x4")])
    grid = parse_map(rows, FROZENLAKE)
    options = {k: v for k, v in args.items() if k not in ("map_name", "desc")} | {"desc": list(rows)}
    live = make_quietly(ID, options)
    outcomes = _outcomes(live.unwrapped.P)  # type: ignore[attr-defined]
    table = _table(outcomes)
    payoffs = _payoffs(live.unwrapped.P)  # type: ignore[attr-defined]
    limit = live.spec.max_episode_steps if live.spec is not None else None
    live.close()
    return Environment(
        id=ID,
        args=dict(args),
        map=rows,
        n_states=grid.n_cells,
        n_actions=4,
        start=grid.start,
        n_columns=grid.n_columns,
        table=table,
        outcomes=outcomes if table is None else None,
        payoffs=payoffs,
        deterministic=table is not None,
        terminal=frozenset(grid.obstacles) | {cell for _, cells in grid.goals for cell in cells},
        max_steps=limit,
        action_names=("left", "down", "right", "up"),
        signal_names=signal_names(grid),
        state_signals=("row", "col"),
        compute=partial(grid_signals, grid),
        options=options,
    )


def _check(name: str, value: Any) -> None:
    """Refuse an argument that gymnasium would choke on."""
    if name not in _ARGUMENTS:
        close = difflib.get_close_matches(name, _ARGUMENTS, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"it takes {', '.join(_ARGUMENTS)}"
        raise UsageError([diagnostic("D821", id=ID, what=f"the argument '{name}'", help=hint)])
    match name:
        case "map_name":
            good = isinstance(value, str) and value in MAPS
        case "is_slippery":
            good = isinstance(value, bool)
        case "desc":
            good = _all(value, str) and len(value) > 0
        case "success_rate":
            good = type(value) in (int, float) and 0 <= value <= 1
        case _:
            good = _all(value, int, float) and len(value) == 3
    if not good:
        what = f"{name} = {str(value)[:40]}"
        raise UsageError([diagnostic("D821", id=ID, what=what, help=f"{name} is {_EXPECTED[name]}")])


def _all(values: Any, *kinds: type) -> bool:
    return isinstance(values, list | tuple) and all(type(value) in kinds for value in values)


def _outcomes(table: Mapping[int, Mapping[int, Sequence[tuple[float, int, float, bool]]]]) -> Outcomes:
    return tuple(tuple(_merged(table[s][a]) for a in range(len(table[s]))) for s in range(len(table)))


def _payoffs(table: Mapping[int, Mapping[int, Sequence[tuple[float, int, float, bool]]]]) -> tuple[float, ...]:
    """Return what entering each cell pays; a cell that cannot be entered pays nothing."""
    found: dict[int, float] = {}
    for state, row in table.items():
        for branches in row.values():
            # a hole and the goal lead to themselves for nothing: that is no entering
            found |= {int(after): float(paid) for _, after, paid, _ in branches if after != state}
    return tuple(found.get(state, 0.0) for state in range(len(table)))


def _merged(branches: Sequence[tuple[float, int, float, bool]]) -> tuple[tuple[float, int], ...]:
    """Add up the probabilities of each next state, and leave out those that cannot happen."""
    total: dict[int, float] = {}
    for probability, state, _, _ in branches:
        if probability > 0:
            total[int(state)] = total.get(int(state), 0.0) + float(probability)
    return tuple((probability, state) for state, probability in sorted(total.items()))


def _table(outcomes: Outcomes) -> npt.NDArray[np.int64] | None:
    if any(len(branches) != 1 for actions in outcomes for branches in actions):
        return None
    return np.array([[branches[0][1] for branches in actions] for actions in outcomes], dtype=np.int64)
