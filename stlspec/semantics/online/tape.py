"""The latest samples of settled formulas, kept for as long as an open formula may look at them.

In: one row of values a sample. Out: columns as arrays. Memory follows what is kept: rows that are no longer
needed are cut off when they are as many as the others, so that a sample costs constant work on average.
"""

from array import array
from bisect import bisect_left
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import PAST
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, State, Unsound, column, items, times, whole

_SMALL = 64


class Tape(Remembering):
    """Rows from sample number `base` on: `times` in ticks and one column for each formula."""

    __slots__ = ("_width", "base", "columns", "times")
    STATE: ClassVar[State] = {"base": whole, "times": times, "columns": lambda value: [column(x) for x in items(value)]}
    TIMED: ClassVar[tuple[str, ...]] = ("times",)

    def __init__(self, width: int) -> None:
        self._width = width
        self.base = 0
        self.times = array("q")
        self.columns = [array("d") for _ in range(width)]

    def push(self, time: int, values: Sequence[float]) -> None:
        """Add the newest sample."""
        self.times.append(time)
        for kept, value in zip(self.columns, values, strict=True):
            kept.append(value)

    def needed(self, first: int, reach: int | None) -> int:
        """Return the first sample that is looked at from sample number `first` on, `reach` ticks back."""
        if reach is None:
            return self.base
        kept = first - self.base
        # The newest sample is looked at too, should it be the only one.
        kept = min(kept, len(self.times) - 1)
        return self.base + bisect_left(self.times, self.times[kept] - reach, 0, kept)

    def drop(self, first: int, reach: int | None) -> None:
        """Forget samples that nothing looks at from sample number `first` on; reach: None keeps all."""
        if reach is None or first - self.base < max(_SMALL, len(self.times) // 2):
            return
        kept = self.needed(first, reach) - self.base
        if kept >= _SMALL:
            self.base += kept
            del self.times[:kept]
            for values in self.columns:
                del values[:kept]

    def arrays(self, first: int) -> tuple[NDArray[np.int64], list[NDArray[np.float64]]]:
        """Return copies from sample number `first` on: (n_samples,) times and columns."""
        row = first - self.base
        # A view would forbid the tape to grow for as long as somebody holds it.
        columns = [np.frombuffer(c, dtype=np.float64)[row:].copy() for c in self.columns]
        return np.frombuffer(self.times, dtype=np.int64)[row:].copy(), columns

    def __len__(self) -> int:
        return len(self.times)

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if self.base < 0 or len(self.columns) != self._width or any(len(c) != len(self.times) for c in self.columns):
            raise Unsound("columns are of unequal length")


class CountedTape(Remembering):
    """The same where time is the number of the sample: at least one column, and no times."""

    __slots__ = ("_width", "base", "columns")
    STATE: ClassVar[State] = {"base": whole, "columns": lambda value: [column(x) for x in items(value)]}

    def __init__(self, width: int) -> None:
        self._width = width
        self.base = 0
        self.columns = [array("d") for _ in range(width)]

    def needed(self, first: int, reach: int | None) -> int:
        """Return the first sample that is looked at from sample number `first` on, `reach` samples back."""
        if reach is None:
            return self.base
        # The newest sample is looked at too, should it be the only one.
        return max(self.base, min(first, self.base + len(self) - 1) - reach)

    def drop(self, first: int, reach: int | None) -> None:
        """Forget samples that nothing looks at from sample number `first` on; reach: None keeps all."""
        if reach is None or first - self.base < max(_SMALL, len(self) // 2):
            return
        kept = self.needed(first, reach) - self.base
        if kept >= _SMALL:
            self.base += kept
            for values in self.columns:
                del values[:kept]

    def arrays(self, first: int) -> tuple[NDArray[np.int64], list[NDArray[np.float64]]]:
        """Return copies from sample number `first` on: (n_samples,) times and columns."""
        row = first - self.base
        columns = [np.frombuffer(c, dtype=np.float64)[row:].copy() for c in self.columns]
        return np.arange(first, self.base + len(self)), columns

    def __len__(self) -> int:
        return len(self.columns[0])

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if self.base < 0 or len(self.columns) != self._width or len({len(c) for c in self.columns}) != 1:
            raise Unsound("columns are of unequal length")


def reach_back(plan: Plan, others: Sequence[int], roots: Sequence[int]) -> int | None:
    """Return how many ticks before a sample the past operators among `others` look; None: there is no end.

    Not in the paper: it bounds the memory of monitors.

    Args: others: formulas that are not settled, children first. roots: those that are looked at.
    """
    found: dict[int, int | None] = {}
    for index in others:
        node = plan.nodes[index]
        below = [found[c] for c in node.children if c in found]
        own: int | None = 0
        if node.op == "prev":
            own = plan.stride if plan.counted else None
        elif node.op in PAST and node.interval is not None:
            own = node.interval[1]
        known = [x for x in below if x is not None]
        found[index] = None if own is None or len(known) < len(below) else own + max(known, default=0)
    wanted = [found[r] for r in roots if r in found]
    known = [x for x in wanted if x is not None]
    return None if len(known) < len(wanted) else max(known, default=0)
