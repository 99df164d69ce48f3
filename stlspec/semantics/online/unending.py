"""Enclosures at sample 0 of formulas whose operators that look ahead have no end, at any depth.

In: at every sample, for each combination of -inf and inf in place of the operators' values at the next sample,
their values at this one. Out: low, high and current value, in memory that does not grow. Every open sample waits
for the same few numbers, the operators' values at the next sample. So the whole formula is one function of min
and max of these, fixed by its corners, and a sample replaces each number by what it says about it.
"""

from collections.abc import Sequence
from typing import ClassVar

from stlspec.compiler.ranges import INF
from stlspec.semantics.online.corners import Table, value_at
from stlspec.semantics.online.nested import Enclosure
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, State, Unsound, numbers

Signed = tuple[int, bool]
"""A node, and whether its negation is meant."""

MOST_UNKNOWNS = 5


def unending_operators(plan: Plan, root: Signed) -> list[Signed] | None:
    """Return the operators under a formula that look ahead, each after those under it.

    Not in the paper: it serves monitors.

    Returns: operators with their sign, the root last; None if one of them has a bound, or there are too many.
    """
    found: list[Signed] = []
    seen: set[Signed] = set()

    def collect(signed: Signed) -> bool:
        index, negated = signed
        node = plan.nodes[index]
        if plan.settled[index] or signed in seen:
            return True
        seen.add(signed)
        if node.op == "not":
            return collect((node.children[0], not negated))
        endless = node.op in ("always", "eventually", "until") and node.interval == (0, None)
        if node.op not in ("and", "or") and not endless:
            return False
        if not all(collect((child, negated)) for child in node.children):
            return False
        if endless:
            found.append(signed)
        return len(found) <= MOST_UNKNOWNS

    return found if collect(root) else None


class Unending(Remembering):
    """The value of one of some endless operators at the first sample.

    table: corners of that value as a function of all of the operators' values at the next sample.
    """

    __slots__ = ("_fills", "_size", "table")
    STATE: ClassVar[State] = {"table": numbers}

    def __init__(self, fills: Sequence[Enclosure], wanted: int) -> None:
        self._size = 2 ** len(fills)
        self._fills = [list(point) for point in zip(*fills, strict=True)]
        self.table: Table = [INF if m >> wanted & 1 else -INF for m in range(self._size)]

    def step(self, _: int, *values: float) -> Enclosure:
        """Take the newest sample.

        Args: values: for each corner, the value of each operator at this sample.
        """
        table, size, count = self.table, self._size, len(self._fills[0])
        self.table = [value_at(table, values[m * count : (m + 1) * count]) for m in range(size)]
        low, high, current = (value_at(self.table, point) for point in self._fills)
        return low, high, current

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if len(self.table) != self._size:
            raise Unsound("a table has a wrong size")
