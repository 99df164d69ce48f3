"""State that can be saved: what an object must remember of the samples so far, as plain data.

In: objects that name their state. Out: JSON values, and back. Every kind of value has one reader that refuses
anything else, so bytes from outside cannot make an object that its own code could not have made, short of
numbers that are wrong; nothing in them is executed.
"""

import math
from array import array
from collections import deque
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, ClassVar

INF = math.inf
State = dict[str, Callable[[Any], Any]]
"""The attributes that make up a state, each with the reader of its value."""

LARGEST = 2**63 - 1


class Unsound(Exception):  # noqa: N818 - never leaves the package: it becomes a D893
    """Saved state breaks a rule of its structure."""


def number(value: Any) -> float:
    """Read a number that is not NaN; infinities are texts."""
    if value in ("inf", "-inf") and isinstance(value, str):
        return float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Unsound("a value is no number")
    try:
        read = float(value)
    except OverflowError:
        read = INF
    if not math.isfinite(read):
        raise Unsound("a value is no finite number")
    return read


def whole(value: Any) -> int:
    """Read a whole number."""
    if isinstance(value, bool) or not isinstance(value, int) or abs(value) > LARGEST:
        raise Unsound("a value is no whole number")
    return value


def items(value: Any) -> list[Any]:
    """Read a list."""
    if not isinstance(value, list):
        raise Unsound("a value is no list")
    return value


def numbers(value: Any) -> list[float]:
    """Read a list of numbers."""
    return [number(x) for x in items(value)]


def row_of(*kinds: Callable[[Any], Any]) -> Callable[[Any], tuple[Any, ...]]:
    """Return a reader of a row with one value of each kind."""

    def read(value: Any) -> tuple[Any, ...]:
        if len(items(value)) != len(kinds):
            raise Unsound("a row has a wrong length")
        return tuple(kind(x) for kind, x in zip(kinds, value, strict=True))

    return read


def rows(*kinds: Callable[[Any], Any]) -> Callable[[Any], list[tuple[Any, ...]]]:
    """Return a reader of a list of rows that begin with a time, earliest first."""
    read_row = row_of(*kinds)

    def read(value: Any) -> list[tuple[Any, ...]]:
        found = [read_row(x) for x in items(value)]
        if any(a[0] >= b[0] for a, b in pairwise(found)):
            raise Unsound("times do not increase")
        return found

    return read


def line_of(*kinds: Callable[[Any], Any]) -> Callable[[Any], deque[tuple[Any, ...]]]:
    """Return a reader of a queue of rows that begin with a time."""
    read_rows = rows(*kinds)
    return lambda value: deque(read_rows(value))


def optional(kind: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return a reader that takes null too."""
    return lambda value: None if value is None else kind(value)


def times(value: Any) -> "array[int]":
    """Read increasing times."""
    found = array("q", [whole(x) for x in items(value)])
    if any(a >= b for a, b in pairwise(found)):
        raise Unsound("times do not increase")
    return found


def column(value: Any) -> "array[float]":
    """Read a column of numbers."""
    return array("d", numbers(value))


def plain(value: Any) -> Any:
    """Return a value as JSON has it."""
    if isinstance(value, float):
        return value if abs(value) != INF else ("inf" if value > 0 else "-inf")
    if isinstance(value, list | tuple | deque | array):
        return [plain(x) for x in value]
    return value


class Remembering:
    """An object whose state can be saved.

    STATE names its attributes, each with the reader of its value; TIMED those that are rows which begin with a
    time, or times.
    """

    __slots__ = ()
    STATE: ClassVar[State] = {}
    TIMED: ClassVar[tuple[str, ...]] = ()

    def parts(self) -> "Sequence[Remembering]":
        """Return the objects that it consists of."""
        return ()

    def save(self) -> dict[str, Any]:
        """Return the state as JSON values."""
        state = {name: plain(getattr(self, name)) for name in self.STATE}
        return state | {"parts": [part.save() for part in self.parts()]}

    def load(self, state: Any) -> None:
        """Take over a saved state. Raises: Unsound: it is none of this object's."""
        if not isinstance(state, dict) or state.keys() != self.STATE.keys() | {"parts"}:
            raise Unsound("a value is missing")
        parts = self.parts()
        if len(items(state["parts"])) != len(parts):
            raise Unsound("it has another number of parts")
        for name, kind in self.STATE.items():
            setattr(self, name, kind(state[name]))
        for part, saved in zip(parts, state["parts"], strict=True):
            part.load(saved)

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey after `n` samples, the newest at that time.

        Raises: Unsound: they do not.
        """
        for name in self.TIMED:
            times = [row[0] if isinstance(row, tuple) else row for row in getattr(self, name)]
            if any(time is not None and time > newest for time in times):
                raise Unsound("a time is later than the newest sample")
        for part in self.parts():
            part.check(n, newest)
