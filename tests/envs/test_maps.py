from pathlib import Path

import numpy as np
import pytest

from stlspec.envs.maps import FROZENLAKE, GRIDWORLD, four_moves, parse_map, read_map
from stlspec.errors import DataError


def codes(error: pytest.ExceptionInfo[DataError]) -> list[str]:
    return [d.code for d in error.value.diagnostics]


def test_every_letter_lands_on_its_cell():
    grid = parse_map(["S.#", "2aG", "b1a"], GRIDWORLD)
    assert (grid.n_rows, grid.n_columns, grid.n_cells, grid.start) == (3, 3, 9, 0)
    assert grid.obstacles == (2,)
    assert grid.goals == ((1, (7,)), (2, (3,)), (3, (5,)))
    assert grid.regions == (("a", (4, 8)), ("b", (6,)))


def test_goals_without_a_number_are_counted_in_reading_order():
    assert parse_map(["SG", "GG"], GRIDWORLD).goals == ((1, (1,)), (2, (2,)), (3, (3,)))


def test_a_goal_number_may_mark_several_cells():
    assert parse_map(["S1", "1."], GRIDWORLD).goals == ((1, (1, 2)),)


def test_a_frozen_lake_has_its_own_letters():
    grid = parse_map(["SFH", "FFG"], FROZENLAKE)
    assert grid.obstacles == (2,) and grid.goals == ((1, (5,)),)


@pytest.mark.parametrize(
    ("rows", "code", "words"),
    [
        ([], "D826", "is empty"),
        ([""], "D826", "is empty"),
        (["S.", "..."], "D823", "row 2 of the map has 3 cells, but row 1 has 2"),
        (["S.", ".?"], "D824", "'?' at row 2, column 2"),
        (["S.", ".H"], "D824", "'H' at row 2, column 2"),
        (["..", ".G"], "D825", "no start"),
        (["SS", ".G"], "D825", "2 starts"),
        (["." * 1001] * 1000, "D826", "1,001,000 cells"),
    ],
)
def test_a_wrong_map_is_refused_with_its_place(rows, code, words):
    with pytest.raises(DataError) as error:
        parse_map(rows, GRIDWORLD, file="map.txt")
    assert codes(error) == [code]
    assert words in str(error.value)
    assert error.value.diagnostics[0].file == "map.txt"


def test_all_mistakes_of_a_rectangular_map_come_at_once():
    with pytest.raises(DataError) as error:
        parse_map(["?!", ".."], GRIDWORLD)
    assert codes(error) == ["D824", "D824", "D825"]


def test_grid_letters_are_unknown_on_a_frozen_lake():
    with pytest.raises(DataError) as error:
        parse_map(["S.", "FG"], FROZENLAKE)
    assert codes(error) == ["D824"]


def test_the_moves_are_left_down_right_up_and_the_border_holds():
    # 0 1
    # 2 3
    moves = four_moves(parse_map(["S.", ".."], GRIDWORLD))
    assert moves.tolist() == [[0, 2, 1, 0], [0, 3, 1, 1], [2, 2, 3, 0], [2, 3, 3, 1]]
    assert moves.dtype == np.int64


def test_a_map_file_is_read_without_its_line_ends(tmp_path: Path):
    file = tmp_path / "map.txt"
    file.write_bytes(b"\xef\xbb\xbfS..\r\n.#.\r\n..G\r\n\r\n")
    assert read_map(file) == ("S..", ".#.", "..G")


@pytest.mark.parametrize(
    ("data", "code"),
    [(b"", "D833"), (b"\n\n", "D833"), (b"S.\xff", "D832"), (b"." * 4_000_001, "D826"), (None, "D830")],
)
def test_an_unusable_map_file_is_one_diagnostic(tmp_path: Path, data: bytes | None, code: str):
    file = tmp_path / "map.txt"
    if data is not None:
        file.write_bytes(data)
    with pytest.raises(DataError) as error:
        read_map(file)
    assert codes(error) == [code]
    assert error.value.diagnostics[0].file == str(file)


def test_a_directory_is_no_map(tmp_path: Path):
    with pytest.raises(DataError, match="directory"):
        read_map(tmp_path)
