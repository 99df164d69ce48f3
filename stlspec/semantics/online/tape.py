"""The latest samples of settled formulas, kept for as long as an open formula may look at them.

In: one row of values a sample. Out: columns as arrays. Memory follows what is kept: rows that are no longer
needed are cut off when they are as many as the others, so that a sample costs constant work on average.
"""

from array import array
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import PAST
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, Unsound, column, items, times, whole

_SMALL = 64


class Tape(Remembering):
    """Rows from sample number `base` on: `times` in ticks and one column for each formula."""

    __slots__ = ("base", "columns", "times")
    STATE = {"base": whole, "times": times, "columns": lambda value: [column(x) for x in items(value)]}

    def __init__(self, width: int) -> None:
        self.base = 0
        self.times = array("q")
        self.columns = [array("d") for _ in range(width)]

    def push(self, time: int, values: Sequence[float]) -> None:
        """Add the newest sample."""
        self.times.append(time)
        for kept, value in zip(self.columns, values, strict=True):
            kept.append(value)

    def drop(self, first: int, reach: int | None) -> None:
        """Forget samples that are more than `reach` ticks before sample number `first`; None: keep all."""
        if reach is None or first - self.base < max(_SMALL, len(self.times) // 2):
            return
        kept = min(first - self.base, len(self.times) - 1)
        # Samples are at least one tick apart, so none within reach lies before this one.
        earliest = self.times[kept] - reach
        while kept > 0 and self.times[kept - 1] >= earliest:
            kept -= 1
        if kept >= _SMALL:
            self.base += kept
            del self.times[:kept]
            for values in self.columns:
                del values[:kept]

    def arrays(self) -> tuple[NDArray[np.int64], list[NDArray[np.float64]]]:
        """Return copies: (n_samples,) times and columns."""
        return np.array(self.times, dtype=np.int64), [np.array(c, dtype=np.float64) for c in self.columns]

    def check(self) -> None:
        if self.base < 0 or any(len(c) != len(self.times) for c in self.columns):
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
