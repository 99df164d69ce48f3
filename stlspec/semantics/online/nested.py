"""Enclosures at sample 0 of `always` over a body with one operator that looks ahead, such as G(a -> F b).

In: at every sample the body as a function of the inner operator's value, and what the sample does to inner
operators that are still open. Out: low, high and current value, for constant work a sample on average.

With its inner operator open the body at a sample is a clamp x -> max(L, min(H, x)), and so is the least of many
such bodies: min and max are taken end by end. A new sample changes the unknown x of all open samples in the same
way, by a clamp again. So the open samples form a queue, with the least of all as one clamp. Samples leave it at
the old end, and a least cannot be taken back; hence two stacks: `newer` holds single samples and the changes
since, `older` the least of each sample and those after it, with one change for all of them.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import ClassVar

from stlspec.compiler.ir import Interval
from stlspec.compiler.ranges import INF, Range
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, State, Unsound, items, number, row_of, whole

Enclosure = tuple[float, float, float]

FOREVER = 2**62

Entry = tuple[int, float, float]
_CHANGE = -1
"""Stands for the time in an entry of `newer` that is a change, not a sample."""


class Clamps(Remembering):
    """A queue of clamps with their least: (low, high) of the newer ones, on top of `older` that of the others.

    front: time of the oldest sample; FOREVER if there is none. change: (low, high) of what happened to the older
    ones since they became older. A queue that does not `forget` never gives a sample back, and keeps the least
    only.
    """

    __slots__ = ("_forget", "change_high", "change_low", "front", "high", "low", "newer", "older")
    STATE: ClassVar[State] = {
        "front": whole,
        "low": number,
        "high": number,
        "change_low": number,
        "change_high": number,
        "newer": lambda value: [row_of(whole, number, number)(x) for x in items(value)],
        "older": lambda value: [row_of(whole, number, number, number, number)(x) for x in items(value)],
    }
    TIMED: ClassVar[tuple[str, ...]] = ("newer", "older")

    def __init__(self, forget: bool) -> None:
        self._forget = forget
        self.front = FOREVER
        self.low = self.high = INF
        self.change_low, self.change_high = -INF, INF
        self.newer: list[Entry] = []
        self.older: list[tuple[int, float, float, float, float]] = []

    def push(self, time: int, low: float, high: float) -> None:
        """Add the body at a newer sample."""
        if low < self.low:
            self.low = low
        if high < self.high:
            self.high = high
        if self._forget:
            self.newer.append((time, low, high))
            if self.front == FOREVER:
                self.front = time

    def change(self, low: float, high: float) -> None:
        """Let every unknown x become max(low, min(high, x))."""
        a, b = self.low, self.high
        self.low = a if low < a else b if low > b else low
        self.high = a if high < a else b if high > b else high
        if self.newer:
            last, before, above = self.newer[-1]
            if last == _CHANGE:
                low_now = before if low < before else above if low > above else low
                high_now = before if high < before else above if high > above else high
                self.newer[-1] = (_CHANGE, low_now, high_now)
            else:
                self.newer.append((_CHANGE, low, high))
        if self.older:
            a, b = self.change_low, self.change_high
            self.change_low = a if low < a else b if low > b else low
            self.change_high = a if high < a else b if high > b else high

    def pop(self) -> Entry:
        """Take out the oldest sample: its time, and its body after all that happened."""
        if not self.older:
            self._turn()
        time, a, b, _, _ = self.older.pop()
        low, high = self.change_low, self.change_high
        self.front = self.older[-1][0] if self.older else self.newer[0][0] if self.newer else FOREVER
        low, high = (a if low < a else b if low > b else low), (a if high < a else b if high > b else high)
        return time, low, high

    def _turn(self) -> None:
        """Make the newer samples older ones."""
        low, high = -INF, INF
        least_low = least_high = INF
        for time, a, b in reversed(self.newer):
            now_low = a if low < a else b if low > b else low
            now_high = a if high < a else b if high > b else high
            if time == _CHANGE:
                low, high = now_low, now_high
                continue
            least_low = now_low if now_low < least_low else least_low
            least_high = now_high if now_high < least_high else least_high
            self.older.append((time, now_low, now_high, least_low, least_high))
        self.newer = []
        self.low = self.high = INF
        self.change_low, self.change_high = -INF, INF

    def least(self, x: float) -> float:
        """Return the least body of all samples if the unknown is x."""
        a, b = self.low, self.high
        result = a if x < a else b if x > b else x
        if self.older:
            a, b = self.change_low, self.change_high
            x = a if x < a else b if x > b else x
            _, _, _, a, b = self.older[-1]
            x = a if x < a else b if x > b else x
            return x if x < result else result
        return result

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if self.newer and self.newer[0][0] == _CHANGE:
            raise Unsound("a change before all samples")
        order = [x[0] for x in self.older[::-1]] + [x[0] for x in self.newer if x[0] != _CHANGE]
        if any(a >= b for a, b in pairwise(order)) or self.front != (order or [FOREVER])[0]:
            raise Unsound("a queue is not in order")


class Nested(Remembering):
    """always[outer] of a body with one inner operator over `inner`.

    waiting: samples whose inner window has not begun. running: those in whose inner window the next sample may
    be. closed: the least body of all others.
    """

    __slots__ = (
        *("_begin", "_certain", "_changes", "_close", "_end", "_fill", "_high", "_low", "_stride", "_tail", "_wait"),
        *("closed", "running", "waiting"),
    )
    STATE: ClassVar[State] = {"closed": number}

    def __init__(
        self, plan: Plan, outer: Interval, inner: Interval, tail: Range, fills: Sequence[Enclosure], changes: bool
    ) -> None:
        self._begin, self._end = outer[0], FOREVER if outer[1] is None else outer[1]
        self._low, self._high = inner[0], FOREVER if inner[1] is None else inner[1]
        self._stride, self._certain = plan.stride, plan.certain
        self._close, self._tail = self._end - plan.stride, tail
        self._fill, self._wait = fills
        # Whether a sample before the inner window changes the inner operator (until), or not (eventually).
        self._changes = changes
        self.closed = INF
        self.waiting = Clamps(forget=True) if self._low else None
        self.running = Clamps(forget=inner[1] is not None)

    def step(
        self,
        time: int,
        body_low: float,
        body_high: float,
        low: float,
        high: float,
        wait_low: float = -INF,
        wait_high: float = INF,
    ) -> Enclosure:
        """Take the newest sample.

        Args:    body_low, body_high: the body if the inner operator is -inf, inf. low, high: the clamp that the
                 sample does to a running inner operator; wait_low, wait_high: to one whose window has not begun.
        """
        waiting, running = self.waiting, self.running
        if waiting is None:
            if running.front + self._high < time:
                self._close_until(time)
            if self._begin <= time <= self._end:
                running.push(time, body_low, body_high)
        else:
            self._move(time)
            if self._begin <= time <= self._end:
                waiting.push(time, body_low, body_high)
            if self._changes:
                waiting.change(wait_low, wait_high)
        running.change(low, high)
        following = time + self._stride
        if waiting is not None:
            self._move(following)
        elif running.front + self._high < following:
            self._close_until(following)
        return self._told(time)

    def _told(self, time: int) -> Enclosure:
        fill, closed, least = self._fill, self.closed, self.running.least
        low, high = least(fill[0]), least(fill[1])
        current = low if fill[2] == fill[0] else high if fill[2] == fill[1] else least(fill[2])
        if self.waiting is not None:
            fill, least = self._wait, self.waiting.least
            low, high, current = min(low, least(fill[0])), min(high, least(fill[1])), min(current, least(fill[2]))
        if closed < high:
            high = closed
        if closed < current:
            current = closed
        if closed < low:
            low = closed
        if time <= self._close:
            if self._tail[0] < low:
                low = self._tail[0]
            if self._certain and self._tail[1] < high:
                high = self._tail[1]
        return low, high, current

    def _move(self, time: int) -> None:
        """Let windows begin and end, as a sample at `time` sees them."""
        waiting, running = self.waiting, self.running
        assert waiting is not None
        while waiting.front + self._low <= time:
            running.push(*waiting.pop())
        self._close_until(time)

    def _close_until(self, time: int) -> None:
        running = self.running
        while running.front + self._high < time:
            _, low, high = running.pop()
            # No further sample comes into the window: the rest of it is empty.
            value = low if self._fill[2] < 0 else high
            self.closed = min(self.closed, value)

    def parts(self) -> list[Clamps]:
        """Return the objects that it consists of."""
        return [part for part in (self.running, self.waiting) if part is not None]
