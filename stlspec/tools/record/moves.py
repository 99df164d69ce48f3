"""Which action a click asks for, or why none does.

In: an environment with a map, where one stands, and the cell that was clicked. Out: an action; or the reason why no
single step leads there, in words for the person who clicked.
"""

from stlspec.envs.model import Environment

_STEPS = {(0, -1): "left", (1, 0): "down", (0, 1): "right", (-1, 0): "up"}


class RefusedError(Exception):
    """What was asked for is no legal move; its text says why."""


def action_to(environment: Environment, here: int, row: int, column: int) -> int:
    """Find the action that aims at a cell.

    Not in the paper: its point-and-click game.

    Args:    here: the number of the cell one stands on. row, column: of the cell that was clicked, from 0.
    Returns: the lowest action that leads there; where steps are uncertain, the one of that direction.
    Raises:  RefusedError: there is none.
    """
    assert environment.map is not None
    assert environment.n_columns is not None
    if not (0 <= row < len(environment.map) and 0 <= column < environment.n_columns):
        raise RefusedError(f"There is no cell at row {row}, column {column}.")
    there = row * environment.n_columns + column
    if there == here:
        raise RefusedError("You are standing there already.")
    if environment.table is not None:
        leading = [action for action, cell in enumerate(environment.table[here].tolist()) if cell == there]
    else:
        from_row, from_column = divmod(here, environment.n_columns)
        name = _STEPS.get((row - from_row, column - from_column), "")
        leading = [environment.action_names.index(name)] if name in environment.action_names else []
    if not leading:
        at_row, at_column = divmod(here, environment.n_columns)
        raise RefusedError(
            f"Row {row}, column {column} is not next to row {at_row}, column {at_column}: "
            "one step goes one cell left, down, right or up."
        )
    return leading[0]
