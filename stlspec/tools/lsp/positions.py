"""Places as editors count them: lines from 0, and columns in units of UTF-8, UTF-16 or UTF-32.

In: the text of a buffer, and how its editor counts. Out: `Lines`, which turns offsets in code points into places and
back. A line ends at LF, CR LF or CR and at nothing else; a place beyond the end of a line or of the text is its end,
and one inside a character is its beginning.
"""

import re
from array import array
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

Encoding = Literal["utf-8", "utf-16", "utf-32"]
DEFAULT: Encoding = "utf-16"
"""What an editor counts in that does not say."""

_LINE_END = re.compile(r"\r\n|\r|\n")
_UNITS: dict[Encoding, Callable[[str], int]] = {
    "utf-8": lambda c: len(c.encode("utf-8", "surrogatepass")),
    "utf-16": lambda c: 2 if c > "\uffff" else 1,
    "utf-32": lambda _: 1,
}


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A line and a character in it, both counted from 0; the character in units of the encoding."""

    line: int
    character: int


@dataclass(frozen=True, slots=True)
class Lines:
    """The lines of one text."""

    text: str
    encoding: Encoding = DEFAULT
    _starts: list[int] = field(init=False, repr=False, compare=False)
    _ends: list[int] = field(init=False, repr=False, compare=False)
    _tables: "dict[int, array[int] | None]" = field(init=False, repr=False, compare=False, default_factory=dict)

    def __post_init__(self) -> None:
        breaks = [match.span() for match in _LINE_END.finditer(self.text)]
        object.__setattr__(self, "_starts", [0, *(end for _, end in breaks)])
        object.__setattr__(self, "_ends", [*(start for start, _ in breaks), len(self.text)])

    def place(self, offset: int) -> Place:
        """Return the place of an offset; one between CR and LF is that of the CR."""
        line = bisect_right(self._starts, max(0, offset)) - 1
        column = min(offset, self._ends[line]) - self._starts[line]
        table = self._table(line)
        return Place(line, max(0, column) if table is None else table[max(0, column)])

    def offset(self, line: int, character: int) -> int:
        """Return the offset of a place, moved to the nearest one that there is."""
        if line < 0:
            return 0
        if line >= len(self._starts):
            return len(self.text)
        start, end = self._starts[line], self._ends[line]
        table = self._table(line)
        column = max(0, character) if table is None else bisect_right(table, max(0, character)) - 1
        return min(start + column, end)

    def _table(self, line: int) -> "array[int] | None":
        """Return how many units precede each character of a line and its end; None where each is one unit."""
        if line not in self._tables:
            text = self.text[self._starts[line] : self._ends[line]]
            table = None
            if not text.isascii() and self.encoding != "utf-32":
                units = _UNITS[self.encoding]
                table = array("L", [0])
                for character in text:
                    table.append(table[-1] + units(character))
            self._tables[line] = table
        return self._tables[line]
