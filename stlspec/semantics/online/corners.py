"""Enclosures at sample 0 of `always` over a clause with several operators that look ahead.

In: at every sample the settled part of the clause, and what the sample does to each of its k inner operators.
Out: low, high and current value, for constant work a sample on average (it grows with 2^k). This is `nested`
with tables of 2^k corners in place of pairs: a formula of min and max is fixed by its corners, the least of many
is taken corner by corner, and a clamp for one unknown mixes corners in pairs. Samples pass through phases by
age, in which other inner windows have begun or ended; each phase is a queue.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, ClassVar

from stlspec.compiler.ir import Interval
from stlspec.compiler.ranges import INF, Range
from stlspec.semantics.online.nested import FOREVER, Enclosure
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, State, Unsound, items, number, numbers, optional, row_of, whole

Table = list[float]
"""Corner m has inf for the unknowns whose bits are set in m, -inf for the others."""

Change = tuple[int, float, float]
"""An unknown, and the clamp that it goes through."""


def clamp(low: float, high: float, x: float) -> float:
    """Return max(low, min(high, x)), for low <= high."""
    return low if x < low else high if x > high else x


def changed(table: Table, changes: Sequence[Change]) -> Table:
    """Return the table after unknowns went through clamps."""
    if len(table) == 4:
        return _changed_pair(table, changes)
    result = table[:]
    for unknown, low, high in changes:
        bit = 1 << unknown
        for m in range(len(result)):
            if not m & bit:
                a, b = result[m], result[m | bit]
                result[m] = a if low < a else b if low > b else low
                result[m | bit] = a if high < a else b if high > b else high
    return result


def _changed_pair(table: Table, changes: Sequence[Change]) -> Table:
    """Return what `changed` does for two unknowns, five times as fast."""
    a, b, c, d = table
    for unknown, low, high in changes:
        if unknown:
            b, c = c, b
        # The pairs that differ in this unknown are now (a, b) and (c, d).
        if low != -INF:
            low_a, low_c = (a if low < a else b if low > b else low), (c if low < c else d if low > d else low)
        else:
            low_a, low_c = a, c
        if high != INF:
            b, d = (a if high < a else b if high > b else high), (c if high < c else d if high > d else high)
        a, c = low_a, low_c
        if unknown:
            b, c = c, b
    return [a, b, c, d]


def value_at(table: Table, point: Sequence[float]) -> float:
    """Return the value of the formula at a point, one number for each unknown."""
    if len(table) == 4:
        a, b, c, d = table
        x, y = point
        a, b = (a if y < a else c if y > c else y), (b if y < b else d if y > d else y)
        return a if x < a else b if x > b else x
    for x in reversed(point):
        half = len(table) // 2
        table = [a if x < a else b if x > b else x for a, b in zip(table[:half], table[half:], strict=True)]
    return table[0]


class Tables(Remembering):
    """A queue of tables with their least, as `nested.Clamps`; `older` rows hold (time, table, least from there on).

    changes: what happened to each unknown of the older ones since they became older.
    """

    __slots__ = ("_count", "_forget", "changes", "front", "least", "newer", "older")
    STATE: ClassVar[State] = {
        "front": whole,
        "least": numbers,
        "changes": lambda value: [row_of(whole, number, number)(x) for x in items(value)],
        "newer": lambda value: [_entry(x) for x in items(value)],
        "older": lambda value: [row_of(whole, numbers, numbers)(x) for x in items(value)],
    }
    TIMED: ClassVar[tuple[str, ...]] = ("newer", "older")

    def __init__(self, count: int, forget: bool) -> None:
        self._count, self._forget = count, forget
        self.front = FOREVER
        self.least: Table = [INF] * 2**count
        self.changes: list[Change] = [(i, -INF, INF) for i in range(count)]
        self.newer: list[tuple[int | None, Any]] = []
        self.older: list[tuple[int, Table, Table]] = []

    def push(self, time: int, table: Table) -> None:
        """Add the body at a newer sample."""
        self.least = [a if a < b else b for a, b in zip(self.least, table, strict=True)]
        if self._forget:
            self.newer.append((time, table))
            if self.front == FOREVER:
                self.front = time

    def change(self, changes: Sequence[Change]) -> None:
        """Let unknowns go through clamps."""
        self.least = changed(self.least, changes)
        if self.newer:
            self.newer.append((None, changes))
        if self.older:
            self._compose(self.changes, changes, before=False)

    @staticmethod
    def _compose(total: list[Change], changes: Sequence[Change], before: bool) -> None:
        """Add changes to a total: those that came `before` it apply last to the unknown."""
        for unknown, low, high in changes:
            _, a, b = total[unknown]
            if before:
                a, b, low, high = low, high, a, b
            low, high = (a if low < a else b if low > b else low), (a if high < a else b if high > b else high)
            total[unknown] = (unknown, low, high)

    def pop(self) -> tuple[int, Table]:
        """Take out the oldest sample: its time, and its body after all that happened."""
        if not self.older:
            self._turn()
        time, table, _ = self.older.pop()
        self.front = self.older[-1][0] if self.older else self._first_newer()
        return time, changed(table, self.changes)

    def _first_newer(self) -> int:
        time = self.newer[0][0] if self.newer else None
        return FOREVER if time is None else time

    def _turn(self) -> None:
        """Make the newer samples older ones."""
        total: list[Change] = [(i, -INF, INF) for i in range(self._count)]
        least: Table = [INF] * 2**self._count
        for time, entry in reversed(self.newer):
            if time is None:
                self._compose(total, entry, before=True)
                continue
            table = changed(entry, total)
            least = list(map(min, least, table))
            self.older.append((time, table, least))
        self.newer = []
        self.least = [INF] * 2**self._count
        self.changes = [(i, -INF, INF) for i in range(self._count)]

    def value(self, point: Sequence[float]) -> float:
        """Return the least body of all samples at a point."""
        result = value_at(self.least, point)
        if self.older:
            moved = [clamp(low, high, x) for (_, low, high), x in zip(self.changes, point, strict=True)]
            result = min(result, value_at(self.older[-1][2], moved))
        return result

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        size = 2**self._count
        tables = [self.least, *(t for row in self.older for t in row[1:]), *(e for t, e in self.newer if t is not None)]
        entries = [self.changes, *(e for t, e in self.newer if t is None)]
        if any(len(t) != size for t in tables) or [c[0] for c in self.changes] != list(range(self._count)):
            raise Unsound("a table has a wrong size")
        if any(not 0 <= c[0] < self._count for e in entries for c in e) or (self.newer and self.newer[0][0] is None):
            raise Unsound("a change does not fit")
        order = [x[0] for x in self.older[::-1]] + [t for t, _ in self.newer if t is not None]
        if any(a >= b for a, b in pairwise(order)) or self.front != (order or [FOREVER])[0]:
            raise Unsound("a queue is not in order")


def _entry(value: Any) -> tuple[int | None, Any]:
    time, entry = row_of(optional(whole), items)(value)
    return time, ([row_of(whole, number, number)(x) for x in entry] if time is None else numbers(entry))


class Phase:
    """What holds for samples of some ages: from `begin` ticks on, until the next phase.

    changing: unknowns that a sample changes, each with where its clamp is among the arguments. points: low,
    high, current. ending: unknowns whose windows end when the phase begins, with their value from then on.
    distinct, which: the points without repetition, and where each of the three is among them.
    """

    __slots__ = ("begin", "changing", "distinct", "ending", "forget", "points", "which")

    def __init__(
        self,
        begin: int,
        inners: Sequence[tuple[Interval, Sequence[Enclosure], bool]],
        last: bool,
    ) -> None:
        self.begin = begin
        self.changing: list[tuple[int, int]] = []
        self.ending: list[Change] = []
        columns: list[Enclosure] = []
        self.forget = not last or all(interval[1] is not None for interval, _, _ in inners)
        for i, ((low, high), fills, waits) in enumerate(inners):
            closed = high is not None and begin > high
            waiting = begin < low
            columns.append(fills[int(waiting)])
            if closed and high is not None and begin == high + 1:
                self.ending.append((i, fills[0][2], fills[0][2]))
            elif not closed and (not waiting or waits):
                self.changing.append((i, 1 + 4 * i + 2 * waiting))
        self.points = [list(point) for point in zip(*columns, strict=True)]
        self.distinct = [point for i, point in enumerate(self.points) if point not in self.points[:i]]
        self.which = [self.distinct.index(point) for point in self.points]


class Corners(Remembering):
    """always[outer] of a body with several inner operators.

    closed: the least body of the samples at which all of them are known. queues: one for each phase.
    """

    __slots__ = ("_begin", "_certain", "_close", "_end", "_phases", "_stride", "_tail", "_top", "closed", "queues")
    STATE: ClassVar[State] = {"closed": number}

    def __init__(
        self, plan: Plan, outer: Interval, tail: Range, inners: Sequence[tuple[Interval, Sequence[Enclosure], bool]]
    ) -> None:
        self._begin, self._end = outer[0], FOREVER if outer[1] is None else outer[1]
        self._stride, self._certain = plan.stride, plan.certain
        self._close, self._tail = self._end - plan.stride, tail
        # A clause is inf as soon as one of its unknowns is.
        self._top = [INF] * (2 ** len(inners) - 1)
        lows = {interval[0] for interval, _, _ in inners}
        ends = {interval[1] + 1 for interval, _, _ in inners if interval[1] is not None}
        begins = sorted({0} | lows | ends)
        self._phases = [Phase(begin, inners, begin == begins[-1]) for begin in begins]
        if self._phases[-1].begin in ends and self._phases[-1].forget:
            # All windows have ended: the body is a number.
            self._phases[-1].points = []
        self.queues = [Tables(len(inners), phase.forget) for phase in self._phases]
        self.closed = INF

    def step(self, time: int, *values: float) -> Enclosure:
        """Take the newest sample.

        Args: values: the settled part of the clause, then for each unknown the clamp of a running operator and
            that of one whose window has not begun, as (low, high).
        """
        self._move(time)
        if self._begin <= time <= self._end:
            self.queues[0].push(time, [values[0], *self._top])
        for phase, queue in zip(self._phases, self.queues, strict=True):
            if phase.changing:
                queue.change([(i, values[j], values[j + 1]) for i, j in phase.changing])
        self._move(time + self._stride)
        return self._told(time)

    def _told(self, time: int) -> Enclosure:
        low = high = current = self.closed
        for phase, queue in zip(self._phases, self.queues, strict=True):
            if phase.points and (queue.front != FOREVER or not phase.forget):
                values = [queue.value(point) for point in phase.distinct]
                low, high, current = map(min, (low, high, current), [values[i] for i in phase.which])
        if time <= self._close:
            low = min(low, self._tail[0])
            high = min(high, self._tail[1]) if self._certain else high
        return low, high, current

    def _move(self, time: int) -> None:
        """Let samples come of age, as a sample at `time` sees them."""
        for i in range(len(self._phases) - 1):
            phase, queue = self._phases[i + 1], self.queues[i]
            while queue.front + phase.begin <= time:
                sample, table = queue.pop()
                table = changed(table, phase.ending)
                if phase.points:
                    self.queues[i + 1].push(sample, table)
                else:
                    self.closed = min(self.closed, table[0])

    def parts(self) -> list[Tables]:
        """Return the objects that it consists of."""
        return self.queues
