"""Maps: each value in its cell, signs told apart without colour, bounded size."""

import re
from xml.etree import ElementTree

from stlspec.markup.grids import Board, board_svg, star

ROWS = ("S.#", "..G")


def drawn(board: Board, **more) -> ElementTree.Element:
    return ElementTree.fromstring(board_svg(board, "map", **more))


def classes(root: ElementTree.Element, name: str) -> list[ElementTree.Element]:
    return [e for e in root.iter() if name in (e.get("class") or "").split()]


def test_values_are_written_into_their_cells() -> None:
    root = drawn(Board(ROWS, {1: 0.5, 5: 1.0, 2: -0.25}))
    width = float(root.get("width")) / 3
    found = {e.text: (float(e.get("x")) // width, float(e.get("y")) // width) for e in classes(root, "stl-cell")}
    assert found == {"0.50": (1, 0), "1.00": (2, 1), "-0.25": (2, 0)}


def test_negative_values_are_hatched_and_positive_ones_not() -> None:
    root = drawn(Board(ROWS, {1: 0.5, 2: -1.0}))
    hatched = [e.get("d") for e in root.iter("path") if "hatching" in (e.get("fill") or "")]
    assert hatched == [e.get("d") for e in classes(root, "stl-minus")]
    assert len(classes(root, "stl-plus")) == 1
    assert not [e for e in drawn(Board(ROWS, {1: 0.5})).iter("path") if "hatching" in (e.get("fill") or "")]


def test_start_goal_wall_and_path_are_drawn() -> None:
    root = drawn(Board(ROWS, path=(0, 3, 4, 5)))
    assert [len(classes(root, f"stl-{name}")) for name in ("start", "goal", "wall")] == [1, 1, 1]
    (path,) = classes(root, "stl-path")
    points = [tuple(map(float, p.split())) for p in path.get("d").removeprefix("M").split("L")]
    side = float(root.get("width")) / 3
    assert [(int(x // side), int(y // side)) for x, y in points] == [(0, 0), (0, 1), (1, 1), (2, 1)]


def test_numbered_goals_keep_their_number() -> None:
    assert "2" in [e.text for e in drawn(Board(("S1", ".2"))).iter("text")]


def test_regions_are_lettered_and_named_where_a_cell_has_room() -> None:
    root = drawn(Board(("Sw.", "dwG"), {1: 0.5}))
    side = float(root.get("width")) / 3
    letters = [
        (e.text, int(float(e.get("x")) // side), int(float(e.get("y")) // side)) for e in classes(root, "stl-region")
    ]
    assert letters == [("w", 1, 0), ("d", 0, 1), ("w", 1, 1)]
    assert "regions d, w" in "".join(root.itertext())
    assert not classes(drawn(Board(("w" * 60,) * 60)), "stl-region")
    assert "region" not in "".join(drawn(Board(ROWS)).itertext())


def test_a_huge_map_is_drawn_in_blocks_that_show_the_extreme() -> None:
    rows = ("." * 1000,) * 999 + ("S" + "#" * 999,)
    svg = board_svg(Board(rows, {500_000 + k: 0.1 for k in range(1000)} | {500_777: -1.0}, tuple(range(1000))), "map")
    assert len(svg) < 120_000
    root = ElementTree.fromstring(svg)
    assert "each square stands for 13 x 13 cells" in root.find("desc").text
    (low,) = classes(root, "stl-minus")
    (column,) = re.findall(r"M(\S+) ", low.get("d"))
    assert round(float(column) / (float(root.get("width")) / 77)) == 777 // 13


def test_a_star_has_ten_corners() -> None:
    assert star(0, 0, 10).count("L") == 9
