"""Past operators and windows over values that come one at a time, in order of time.

In: times in ticks and values. Out: the operator's value at the newest time. A window is a queue of those values
that can still become its least one, so every value is added and removed once: constant work on average,
memory bounded by the window.
"""

from collections import deque
from itertools import pairwise
from typing import ClassVar

from stlspec.compiler.ranges import INF
from stlspec.semantics.online.saving import Remembering, State, Unsound, line_of, number, whole

Row = tuple[int, float]


class Sliding(Remembering):
    """The least of the values from `low` to `high` ticks back, +inf if there is none; high None: of all."""

    __slots__ = ("_high", "_low", "least", "waiting", "window")
    STATE: ClassVar[State] = {"waiting": line_of(whole, number), "window": line_of(whole, number), "least": number}
    TIMED: ClassVar[tuple[str, ...]] = ("waiting", "window")

    def __init__(self, low: int, high: int | None) -> None:
        self._low, self._high = low, high
        self.waiting: deque[Row] = deque()
        self.window: deque[Row] = deque()
        self.least = INF

    def step(self, time: int, value: float) -> float:
        """Take the newest value."""
        window = self.window
        if self._low == 0:
            if self._high is None:
                self.least = min(self.least, value)
                return self.least
            while window and window[-1][1] >= value:
                window.pop()
            window.append((time, value))
        else:
            self.waiting.append((time, value))
            latest = time - self._low
            while self.waiting and self.waiting[0][0] <= latest:
                row = self.waiting.popleft()
                if self._high is None:
                    self.least = min(self.least, row[1])
                    continue
                while window and window[-1][1] >= row[1]:
                    window.pop()
                window.append(row)
        if self._high is None:
            return self.least
        earliest = time - self._high
        while window and window[0][0] < earliest:
            window.popleft()
        return window[0][1] if window else INF

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if any(a[1] >= b[1] for a, b in pairwise(self.window)):
            raise Unsound("a window is not in order")


class Greatest(Sliding):
    """The greatest of the values in the window, -inf if there is none."""

    __slots__ = ()

    def step(self, time: int, value: float) -> float:
        """Take the newest value."""
        return -super().step(time, -value)


class Since(Remembering):
    """left since[low, high] right, by the mirror image of the identity that the offline kernel uses for until.

    running: the value without bounds. waiting: its values less than `low` ticks old. reached: the last of the
    older ones.
    """

    __slots__ = ("_held", "_low", "_once", "reached", "running", "waiting")
    STATE: ClassVar[State] = {"running": number, "reached": number, "waiting": line_of(whole, number)}
    TIMED: ClassVar[tuple[str, ...]] = ("waiting",)

    def __init__(self, low: int, high: int | None) -> None:
        self._low = low
        self._held = Sliding(0, low - 1) if low > 0 else None
        self._once = Greatest(low, high) if high is not None else None
        self.running = self.reached = -INF
        self.waiting: deque[Row] = deque()

    def step(self, time: int, left: float, right: float) -> float:
        """Take the newest values."""
        self.running = max(right, min(left, self.running))
        self.waiting.append((time, self.running))
        while self.waiting and self.waiting[0][0] <= time - self._low:
            self.reached = self.waiting.popleft()[1]
        value = self.reached
        if self._held is not None:
            value = min(value, self._held.step(time, left))
        if self._once is not None:
            value = min(value, self._once.step(time, right))
        return value

    def parts(self) -> list[Sliding]:
        """Return the objects that it consists of."""
        return [part for part in (self._held, self._once) if part is not None]
