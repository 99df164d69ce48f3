"""Enclosures at sample 0 of always and until over settled formulas: a few numbers, constant work a sample.

In: at every sample the time and the operands' values. Out: low, high, and the value if the trace ends here.
Everything known is one clamp x -> max(L, min(H, x)) of the value that the rest of the trace gives.
`eventually` is `always` of the negation, negated.
"""

from typing import Any, ClassVar

from stlspec.compiler.ir import Interval
from stlspec.compiler.ranges import INF, Range
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, State, Unsound, number, optional, row_of, whole

Enclosure = tuple[float, float, float]
"""low, high, and current: the value if the trace ends here."""

NOWHERE: Enclosure = (0.0, 0.0, 0.0)
"""What is given before the sample at which a formula is wanted; nobody looks at it."""

_FOREVER = 2**62


class Always(Remembering):
    """always[low, high] of a settled formula; least: of the values in its window so far."""

    __slots__ = ("_begin", "_certain", "_close", "_end", "_tail", "least", "result")
    STATE: ClassVar[State] = {"least": number, "result": row_of(number, number, number)}

    def __init__(self, plan: Plan, interval: Interval, tail: Range) -> None:
        self._begin = interval[0]
        self._end = _FOREVER if interval[1] is None else interval[1]
        # From the newest time on after which no sample can come into the window.
        self._close = self._end - plan.stride
        self._tail, self._certain = tail, plan.certain
        self.least = INF
        self.result: Enclosure = NOWHERE
        self._tell(-1)

    def step(self, time: int, value: float) -> Enclosure:
        """Take the newest value."""
        if value < self.least:
            if self._begin <= time <= self._end:
                self.least = value
        elif time <= self._close:
            return self.result
        self._tell(time)
        return self.result

    def _tell(self, time: int) -> None:
        low = high = least = self.least
        if time <= self._close:
            low = min(low, self._tail[0])
            high = min(high, self._tail[1]) if self._certain else high
        self.result = (low, high, least)


class Until(Remembering):
    """left until[low, high] right of settled formulas; best, held: L and H of the clamp."""

    __slots__ = ("_begin", "_certain", "_close", "_end", "_late", "_left", "_right", "best", "held")
    STATE: ClassVar[State] = {"best": number, "held": number}

    def __init__(self, plan: Plan, interval: Interval, left: Range, right: Range) -> None:
        self._begin = interval[0]
        self._end = _FOREVER if interval[1] is None else interval[1]
        self._close = self._end - plan.stride
        # Up to this time the left operand must hold at a sample to come before the window begins.
        self._late = self._begin - plan.stride if plan.dense else -1
        self._left, self._right, self._certain = left, right, plan.certain
        self.best, self.held = -INF, INF

    def step(self, time: int, left: float, right: float) -> Enclosure:
        """Take the newest values."""
        best, held = self.best, self.held
        if best < held:
            if time <= self._end:
                if time >= self._begin:
                    right = right if right < held else held
                    if right > best:
                        self.best = best = right
                if left < held:
                    self.held = held = left
            if best < held and time <= self._close:
                tails = (self._left, self._right) if time < self._late else (self._right,)
                high = max(best, min(held, *(tail[1] for tail in tails)))
                low = max(best, min(held, *(tail[0] for tail in tails))) if self._certain else best
                return low, high, best
        return best, best, best


class First(Remembering):
    """A settled formula at the first sample that it is asked for."""

    __slots__ = ("value",)
    STATE: ClassVar[State] = {"value": optional(number)}

    def __init__(self) -> None:
        self.value: float | None = None

    def step(self, _: int, value: float) -> Enclosure:
        """Take the newest value."""
        if self.value is None:
            self.value = value
        return self.value, self.value, self.value


class Starting(Remembering):
    """An enclosure at sample number `origin`: the samples before are not shown to it."""

    __slots__ = ("_origin", "part", "seen", "start")
    STATE: ClassVar[State] = {"seen": whole, "start": whole}

    def __init__(self, part: Any, origin: int) -> None:
        self.part, self._origin = part, origin
        self.seen = self.start = 0

    def step(self, time: int, *values: float) -> Enclosure:
        """Take the newest values."""
        self.seen += 1
        if self.seen <= self._origin:
            return NOWHERE
        if self.seen == self._origin + 1:
            self.start = time
        result: Enclosure = self.part.step(time - self.start, *values)
        return result

    def parts(self) -> list[Remembering]:
        """Return the objects that it consists of."""
        return [self.part]

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if self.seen != n or not 0 <= self.start <= max(newest, 0):
            raise Unsound("samples are missing")
