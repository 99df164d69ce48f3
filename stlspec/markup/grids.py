"""A map as SVG: obstacles, goals, a value for each cell, a path.

In: a `Board`. Out: an SVG of bounded size: of a large map each square stands for a block of cells and shows the
value furthest from 0. Signs are told apart by hatching as well as by colour, and small maps have their numbers.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from stlspec.markup.elements import Markup, element, join, number
from stlspec.markup.figures import figure, label

_MOST_SIDE = 80
_NUMBERED_UP_TO = 12
_LETTERED_FROM = 14
_LEVELS = 12
_LONGEST_PATH = 2000
_GOALS, _OBSTACLES = "G123456789", "#H"


@dataclass(frozen=True, slots=True)
class Board:
    """A map with what is drawn on it: rows of text, values of cells by number, cells of a path in order."""

    rows: tuple[str, ...]
    values: Mapping[int, float] = field(default_factory=dict)
    path: tuple[int, ...] = ()


def board_svg(board: Board, title: str, size: float = 420.0) -> Markup:
    """Draw a map.

    Paper: figures 3 and 5 to 8, the rewards on the map.

    Args:    title: what it shows. size: of the longer side, in pixels.
    Returns: an SVG element, bounded in size whatever the map.
    """
    n_rows, n_columns = len(board.rows), len(board.rows[0])
    block = math.ceil(max(n_rows, n_columns) / _MOST_SIDE)
    down, right = math.ceil(n_rows / block), math.ceil(n_columns / block)
    side = min(56.0, size / max(down, right))
    shown = _squares(board, block, right)
    numbers = max(n_rows, n_columns) <= _NUMBERED_UP_TO
    walls = _runs(_walls(board.rows, block), side, inset=side * 0.2 if side > 14 else 0)
    parts = [
        element("rect", x=0, y=0, width=right * side, height=down * side, class_="stl-floor"),
        _hatching(),
        *_heat(shown, side, right),
        element("path", d=walls, class_="stl-wall") if walls else None,
        element("path", d=_lines(down, right, side), class_="stl-rule") if side > 8 else None,
        *(_numbers(shown, side, right) if numbers else []),
        *(_regions(board.rows, side) if block == 1 and side > _LETTERED_FROM else []),
        *_ends(board.rows, block, side),
        *_line(board, block, side),
    ]
    said = [f"{n_rows} rows, {n_columns} columns"]
    if board.values:
        said.append(f"values from {number(min(board.values.values()))} to {number(max(board.values.values()))}")
    regions = sorted({letter for row in board.rows for letter in row if letter.islower()})
    if regions:
        said.append(f"region{'s' if len(regions) > 1 else ''} {', '.join(regions)}")
    if block > 1:
        said.append(f"each square stands for {block} x {block} cells")
    return figure(right * side, down * side, title, "; ".join(said), *(p for p in parts if p is not None))


def _squares(board: Board, block: int, right: int) -> dict[int, float]:
    """Return the value of each square that has one: of its cells the one furthest from 0."""
    n_columns = len(board.rows[0])
    found: dict[int, float] = {}
    for cell, value in board.values.items():
        row, column = divmod(cell, n_columns)
        square = row // block * right + column // block
        if abs(value) > abs(found.get(square, 0.0)):
            found[square] = value
    return found


def _walls(rows: Sequence[str], block: int) -> list[list[bool]]:
    """Tell for each square whether at least half of it is obstacle."""
    lines = [rows[first : first + block] for first in range(0, len(rows), block)]
    width = len(rows[0])
    return [[_share(lines_of, first, block) >= 0.5 for first in range(0, width, block)] for lines_of in lines]


def _share(lines: Sequence[str], first: int, block: int) -> float:
    cells = "".join(line[first : first + block] for line in lines)
    return sum(cells.count(c) for c in _OBSTACLES) / len(cells)


def _runs(marked: Sequence[Sequence[bool]], side: float, inset: float) -> str:
    size = side - 2 * inset
    return "".join(
        f"M{column * side + inset:.1f} {row * side + inset:.1f}h{size:.1f}v{size:.1f}h{-size:.1f}z"
        for row, cells in enumerate(marked)
        for column, here in enumerate(cells)
        if here
    )


def _hatching() -> Markup:
    lines = element("path", d="M0 6L6 0", class_="stl-hatch")
    pattern = element("pattern", lines, id="stl-hatching", width=6, height=6, patternUnits="userSpaceOnUse")
    return element("defs", pattern)


def _heat(shown: Mapping[int, float], side: float, right: int) -> list[Markup]:
    """Colour the squares, in as many layers as there are shades."""
    limit = max(map(abs, shown.values()), default=0.0) or 1.0
    layers: dict[int, list[str]] = {}
    for square, value in sorted(shown.items()):
        row, column = divmod(square, right)
        level = math.copysign(math.ceil(abs(value) / limit * _LEVELS), value)
        layers.setdefault(int(level), []).append(
            f"M{column * side:.1f} {row * side:.1f}h{side:.1f}v{side:.1f}h{-side:.1f}z"
        )
    parts = []
    for level, squares in sorted(layers.items()):
        path, opacity = "".join(squares), f"{0.06 + 0.5 * abs(level) / _LEVELS:.2f}"
        parts.append(element("path", d=path, class_="stl-plus" if level > 0 else "stl-minus", fill_opacity=opacity))
        if level < 0:
            parts.append(element("path", d=path, fill="url(#stl-hatching)", opacity=0.8))
    return parts


def _numbers(shown: Mapping[int, float], side: float, right: int) -> list[Markup]:
    return [
        label(square % right * side + side - 3, square // right * side + 12, f"{value:.2f}", "stl-cell stl-halo", "end")
        for square, value in sorted(shown.items())
    ]


def _regions(rows: Sequence[str], side: float) -> list[Markup]:
    """Write the letter of its region into each cell that has one, where no value stands."""
    return [
        label(column * side + 3, row * side + side - 4, letter, "stl-region stl-halo")
        for row, line in enumerate(rows)
        for column, letter in enumerate(line)
        if letter.islower()
    ]


def _lines(down: int, right: int, side: float) -> str:
    across = "".join(f"M0 {k * side:.1f}h{right * side:.1f}" for k in range(down + 1))
    return across + "".join(f"M{k * side:.1f} 0v{down * side:.1f}" for k in range(right + 1))


def _middle(cell: int, n_columns: int, block: int, side: float) -> tuple[float, float]:
    row, column = divmod(cell, n_columns)
    return (column / block + 0.5 / block) * side, (row / block + 0.5 / block) * side


def _line(board: Board, block: int, side: float) -> list[Markup]:
    if len(board.path) < 2:
        return []
    step = math.ceil(len(board.path) / _LONGEST_PATH)
    cells = board.path[::step] if step == 1 else (*board.path[::step], board.path[-1])
    points = [_middle(cell, len(board.rows[0]), block, side) for cell in cells]
    line = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    x, y = points[-1]
    end = element("circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r=min(7.0, max(side * 0.18, 3.0)), class_="stl-mark")
    return [element("path", d=line, class_="stl-halo-path"), element("path", d=line, class_="stl-path"), end]


def _ends(rows: Sequence[str], block: int, side: float) -> list[Markup]:
    """Mark the start as a ring and the goals as stars; numbered goals keep their number."""
    parts = []
    n_columns = len(rows[0])
    radius = min(9.0, max(side * 0.2, 4.0))
    for row, line in enumerate(rows):
        for column, letter in enumerate(line):
            if letter != "S" and letter not in _GOALS:
                continue
            x, y = _middle(row * n_columns + column, n_columns, block, side)
            if letter == "S":
                parts.append(element("circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r=radius * 0.8, class_="stl-start"))
            elif len(parts) < _LONGEST_PATH:
                parts.append(element("path", d=star(x, y, radius * 1.25), class_="stl-goal"))
                if letter != "G":
                    parts.append(label(x + radius, y - radius * 0.6, letter, "stl-halo"))
    return [join(parts)]


def star(x: float, y: float, radius: float) -> str:
    """Return the path of a five-pointed star. Not in the paper: looks."""
    turns = [(radius if k % 2 == 0 else radius * 0.45, math.pi * k / 5) for k in range(10)]
    return "M" + "L".join(f"{x + r * math.sin(a):.1f} {y - r * math.cos(a):.1f}" for r, a in turns) + "z"
