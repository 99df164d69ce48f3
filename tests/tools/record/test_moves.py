"""A click is one step, or refused with the reason."""

import pytest

from stlspec.envs.catalogue import make_environment
from stlspec.tools.record.moves import RefusedError, action_to

GRID = make_environment("stlspec/GridWorld-v0", None, ("..G", ".#.", "S.."))
ICE = make_environment("FrozenLake-v1", {"is_slippery": True}, ("SFF", "FHF", "FFG"))


@pytest.mark.parametrize("world", [GRID, ICE], ids=["grid", "ice"])
@pytest.mark.parametrize(("cell", "action"), [((1, 0), 0), ((2, 1), 1), ((1, 2), 2), ((0, 1), 3)])
def test_a_click_next_to_you_is_a_step_in_that_direction(world, cell: tuple[int, int], action: int) -> None:
    assert action_to(world, 4, *cell) == action


@pytest.mark.parametrize("world", [GRID, ICE], ids=["grid", "ice"])
@pytest.mark.parametrize(
    ("cell", "reason"),
    [
        ((0, 0), "Row 0, column 0 is not next to row 1, column 1"),
        ((1, 1), "standing there already"),
        ((9, 0), "no cell at row 9"),
        ((0, -1), "no cell at row 0, column -1"),
        ((-1, 1), "no cell"),
    ],
)
def test_any_other_click_is_refused_with_the_reason(world, cell: tuple[int, int], reason: str) -> None:
    with pytest.raises(RefusedError, match=reason):
        action_to(world, 4, *cell)


def test_the_other_end_of_a_row_is_not_next_to_its_beginning() -> None:
    with pytest.raises(RefusedError, match="not next to"):
        action_to(GRID, 3, 0, 2)
