"""Maps as text: one character a cell, one line a row.

In: the rows that a user wrote, and what the letters mean in the environment at hand. Out: a `Grid`, or one
diagnostic that names row and column, counted from 1. Both grid environments share this module, so that their
maps are checked alike.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from stlspec.envs.signals import Grid
from stlspec.errors import DataError, Diagnostic, diagnostic

CELLS_AT_MOST = 1_000_000
_BYTES_AT_MOST = 4 * CELLS_AT_MOST
_STEPS = ((0, -1), (1, 0), (0, 1), (-1, 0))


@dataclass(frozen=True, slots=True)
class Letters:
    """What the characters of a map mean in one environment; `described` is shown when one is unknown.

    cells_at_most: the size of the largest map of this environment.
    """

    obstacle: str
    free: str
    numbered: bool
    described: str
    cells_at_most: int


GRIDWORLD = Letters("#", ".", True, "S start, . free, # obstacle, G goal, 1 to 9 goals, a to z regions", CELLS_AT_MOST)
# gymnasium builds its table of a frozen lake from Python objects, some 4 kB and 60 us a cell, even where a
# demonstration that names such a map is only scored.
FROZENLAKE = Letters("H", "F", False, "S start, F frozen, H hole, G goal", 10_000)


def read_map(path: Path | str) -> tuple[str, ...]:
    """Read a map file: its lines without their ends; blank lines at the end do not count.

    Not in the paper: a file format.

    Raises: DataError: the file is missing, unreadable, too large (D826), no UTF-8 text (D832) or empty
        (D833).
    """
    name, file = str(path), Path(path)
    try:
        if not file.is_file():
            reason = "it is a directory" if file.is_dir() else "there is no such file"
            raise DataError([diagnostic("D830", file=name, reason=reason, help="give the name of a map file")])
        with file.open("rb") as stream:
            data = stream.read(_BYTES_AT_MOST + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise DataError([diagnostic("D830", file=name, reason=reason, help="check its permissions")]) from None
    if len(data) > _BYTES_AT_MOST:
        raise DataError([_bad_size("is larger than any map", CELLS_AT_MOST, name)])
    text = _text(data, name)
    rows = tuple(line.rstrip() for line in text.removeprefix("\ufeff").rstrip().splitlines())
    if not rows:
        raise DataError([diagnostic("D833", file=name, expected="a map, one line a row")])
    return rows


def parse_map(rows: Sequence[str], letters: Letters, *, file: str | None = None) -> Grid:
    """Read the rows of a map.

    Goals marked by a digit keep it; those marked G take the numbers that are left, in reading order.

    Not in the paper: maps are given as text here.

    Raises: DataError D823 to D826: all mistakes of the map, each with row and column from 1.
    """
    n_cells = sum(map(len, rows))
    if not n_cells:
        raise DataError([_bad_size("is empty", letters.cells_at_most, file)])
    if n_cells > letters.cells_at_most:
        raise DataError([_bad_size(f"has {n_cells:,} cells", letters.cells_at_most, file)])
    ragged = _ragged(rows, file)
    if ragged:
        raise DataError(ragged)
    places = _places(rows)
    problems = _strange(places, len(rows[0]), letters, file)
    starts = len(places.get("S", ()))
    if starts != 1:
        problems.append(diagnostic("D825", file=file, count="no start" if not starts else f"{starts} starts"))
    if problems:
        raise DataError(problems)
    return Grid(
        n_rows=len(rows),
        n_columns=len(rows[0]),
        start=places["S"][0],
        obstacles=places.get(letters.obstacle, ()),
        goals=_goals(places),
        regions=tuple((x, places[x]) for x in sorted(places) if x.islower()),
    )


def four_moves(grid: Grid) -> npt.NDArray[np.int64]:
    """Tabulate the moves left, down, right, up, where the border keeps one in place.

    Paper: the grid-world experiments.

    Returns: (n_cells, 4), the next cell.
    """
    rows, columns = np.divmod(np.arange(grid.n_cells, dtype=np.int64), grid.n_columns)
    moves = [
        np.clip(rows + down, 0, grid.n_rows - 1) * grid.n_columns + np.clip(columns + right, 0, grid.n_columns - 1)
        for down, right in _STEPS
    ]
    return np.stack(moves, axis=1)


def _text(data: bytes, name: str) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        at = error.start
        line = f" (line {data.count(10, 0, at) + 1})"
        byte = f"0x{data[at]:02x}"
        raise DataError([diagnostic("D832", file=name, offset=at, line=line, byte=byte)]) from None


def _bad_size(what: str, limit: int, file: str | None) -> Diagnostic:
    return diagnostic("D826", file=file, what=what, limit=f"{limit:,}")


def _places(rows: Sequence[str]) -> dict[str, tuple[int, ...]]:
    """Find the cells of each character, in reading order."""
    found: dict[str, list[int]] = {}
    for row, text in enumerate(rows):
        for column, character in enumerate(text):
            found.setdefault(character, []).append(row * len(rows[0]) + column)
    return {character: tuple(cells) for character, cells in found.items()}


def _ragged(rows: Sequence[str], file: str | None) -> list[Diagnostic]:
    expected = len(rows[0])
    for row, text in enumerate(rows, 1):
        if len(text) != expected:
            return [diagnostic("D823", file=file, row=row, length=len(text), expected=expected)]
    return []


def _strange(
    places: dict[str, tuple[int, ...]], n_columns: int, letters: Letters, file: str | None
) -> list[Diagnostic]:
    known = {"S", "G", letters.obstacle, letters.free}
    if letters.numbered:
        known |= {*"123456789", *"abcdefghijklmnopqrstuvwxyz"}
    return [
        diagnostic(
            "D824",
            file=file,
            character=repr(character),
            row=cells[0] // n_columns + 1,
            column=cells[0] % n_columns + 1,
            help=f"a map is made of {letters.described}",
        )
        for character, cells in places.items()
        if character not in known
    ][:5]


def _goals(places: dict[str, tuple[int, ...]]) -> tuple[tuple[int, tuple[int, ...]], ...]:
    numbered = {int(x): cells for x, cells in places.items() if x in "123456789"}
    free = (k for k in range(1, len(numbered) + len(places.get("G", ())) + 1) if k not in numbered)
    plain = {k: (cell,) for k, cell in zip(free, places.get("G", ()), strict=False)}
    return tuple(sorted({**numbered, **plain}.items()))
