"""Exact values at every sample, in order, each as soon as it can no longer change.

In: the values of settled formulas, as they come. Out: those of formulas that look a bounded time ahead, late by
their horizon. Every operator is an object that takes its operands' values in order and hands its own on, so
that each costs constant work a sample on average, whatever its window, at any depth. With each value comes the
time up to which no further one will follow (`upto`): a window closes when that passes its end.
"""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

from stlspec.compiler.ranges import INF
from stlspec.semantics.online.past import Row, Since, Sliding
from stlspec.semantics.online.saving import Remembering, State, Unsound, items, line_of, number, optional, rows, whole

Sink = Callable[[int, float, int], None]


def instants(value: Any) -> deque[int]:
    """Read a queue of increasing times."""
    return deque(row[0] for row in rows(whole)([[x] for x in items(value)]))


class Late(Remembering):
    """An operator whose values come in order; sinks: what takes them."""

    __slots__ = ("sinks",)

    def __init__(self) -> None:
        self.sinks: list[Sink] = []

    def inlets(self) -> list[Sink]:
        """Return what takes the values of each operand."""
        return [self.take]

    def take(self, time: int, value: float, upto: int) -> None:
        """Take the operand's next value."""
        raise NotImplementedError

    def give(self, time: int, value: float, upto: int) -> None:
        """Hand the operator's next value on."""
        for sink in self.sinks:
            sink(time, value, upto)


class LateNot(Late):
    """The negation."""

    __slots__ = ()

    def take(self, time: int, value: float, upto: int) -> None:
        """Take the operand's next value."""
        self.give(time, -value, upto)


class LateNext(Late):
    """The value at the next sample; before: time of the sample that waits for it."""

    __slots__ = ("before",)
    STATE: ClassVar[State] = {"before": optional(whole)}

    def __init__(self) -> None:
        super().__init__()
        self.before: int | None = None

    def take(self, time: int, value: float, _: int) -> None:
        """Take the operand's next value."""
        before, self.before = self.before, time
        if before is not None:
            self.give(before, value, time - 1)


class LatePrev(Late):
    """The value at the previous sample."""

    __slots__ = ("before",)
    STATE: ClassVar[State] = {"before": number}

    def __init__(self) -> None:
        super().__init__()
        self.before = -INF

    def take(self, time: int, value: float, upto: int) -> None:
        """Take the operand's next value."""
        before, self.before = self.before, value
        self.give(time, before, upto)


class LatePast(Late):
    """A past operator with one operand, over values that come late."""

    __slots__ = ("part",)

    def __init__(self, part: Sliding) -> None:
        super().__init__()
        self.part = part

    def take(self, time: int, value: float, upto: int) -> None:
        """Take the operand's next value."""
        self.give(time, self.part.step(time, value), upto)

    def parts(self) -> list[Sliding]:
        """Return the objects that it consists of."""
        return [self.part]


class LateWindow(Late):
    """always or eventually (`flip`: as the negation of always of the negation) over [low, high].

    open: times of the samples whose value is not known yet. window: values that can still be the least.
    """

    __slots__ = ("_flip", "_high", "_low", "open", "window")
    STATE: ClassVar[State] = {"open": instants, "window": line_of(whole, number)}
    TIMED: ClassVar[tuple[str, ...]] = ("open", "window")

    def __init__(self, low: int, high: int, flip: bool) -> None:
        super().__init__()
        self._low, self._high, self._flip = low, high, flip
        self.open: deque[int] = deque()
        self.window: deque[Row] = deque()

    def take(self, time: int, value: float, upto: int) -> None:
        """Take the operand's next value."""
        waiting, window, high = self.open, self.window, self._high
        while waiting and waiting[0] + high < time:
            self._close(time - 1)
        if self._flip:
            value = -value
        while window and window[-1][1] >= value:
            window.pop()
        window.append((time, value))
        waiting.append(time)
        while waiting and waiting[0] + high <= upto:
            self._close(upto)

    def _close(self, upto: int) -> None:
        """Hand on the value at the first open sample; `upto` as known if no other is open."""
        waiting, window = self.open, self.window
        time = waiting.popleft()
        first = time + self._low
        while window and window[0][0] < first:
            window.popleft()
        value = window[0][1] if window else INF
        if waiting:
            upto = waiting[0] - 1
        if self._flip:
            value = -value
        for sink in self.sinks:
            sink(time, value, upto)


class Aligned(Late):
    """An operator with several operands, whose values come with different delays.

    queues: values that wait for those of the other operands. known: up to when each operand has come.
    """

    __slots__ = ("_count", "known", "queues")
    STATE: ClassVar[State] = {
        "queues": lambda value: [line_of(whole, number)(x) for x in items(value)],
        "known": lambda value: [whole(x) for x in items(value)],
    }

    def __init__(self, count: int) -> None:
        super().__init__()
        self._count = count
        self.queues: list[deque[Row]] = [deque() for _ in range(count)]
        self.known = [-1] * count

    def inlets(self) -> list[Sink]:
        """Return what takes the values of each operand."""
        return [partial(self._put, slot) for slot in range(len(self.queues))]

    def _put(self, slot: int, time: int, value: float, upto: int) -> None:
        queues = self.queues
        queues[slot].append((time, value))
        self.known[slot] = upto
        while all(queues):
            found = [queue.popleft() for queue in queues]
            ahead = [queue[0][0] - 1 for queue in queues if queue]
            self.join(found[0][0], [value for _, value in found], ahead[0] if ahead else max(self.known))

    def join(self, time: int, values: list[float], upto: int) -> None:
        """Take the values of all operands at one sample."""
        raise NotImplementedError

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        late = [row for queue in self.queues for row in queue if row[0] > newest]
        if len(self.queues) != self._count or len(self.known) != self._count or all(self.queues) or late:
            raise Unsound("queues do not fit")


class LateBoolean(Aligned):
    """and, or: `pick` is min or max."""

    __slots__ = ("_pick",)

    def __init__(self, count: int, pick: Callable[[list[float]], float]) -> None:
        super().__init__(count)
        self._pick = pick

    def join(self, time: int, values: list[float], upto: int) -> None:
        """Take the values of all operands at one sample."""
        self.give(time, self._pick(values), upto)


class LateSince(Aligned):
    """since over values that come late."""

    __slots__ = ("part",)

    def __init__(self, part: Since) -> None:
        super().__init__(2)
        self.part = part

    def join(self, time: int, values: list[float], upto: int) -> None:
        """Take the values of all operands at one sample."""
        self.give(time, self.part.step(time, *values), upto)

    def parts(self) -> list[Since]:
        """Return the objects that it consists of."""
        return [self.part]


class LateUntil(Aligned):
    """until over [low, high], as the least of two windows.

    The left operand holds on [t, t + low): a queue of values that can be the least, `held`, fed from `waiting`.
    From there on every sample is a clamp x -> max(right, min(left, x)) of the value after it, and the window is
    the product of its clamps: `older` holds the products from each sample on to the last of them, earliest on
    top, `newer` the single clamps of the samples after these, whose product is (`low_end`, `high_end`).
    """

    __slots__ = ("_high", "_low", "held", "high_end", "low_end", "newer", "older", "open", "waiting")
    STATE: ClassVar[State] = Aligned.STATE | {
        "open": instants,
        "waiting": line_of(whole, number),
        "held": line_of(whole, number),
        "older": lambda value: rows(whole, number, number)(items(value)[::-1])[::-1],
        "newer": rows(whole, number, number),
        "low_end": number,
        "high_end": number,
    }
    TIMED: ClassVar[tuple[str, ...]] = ("open", "waiting", "held", "older", "newer")

    def __init__(self, low: int, high: int) -> None:
        super().__init__(2)
        self._low, self._high = low, high
        self.open: deque[int] = deque()
        self.waiting: deque[Row] = deque()
        self.held: deque[Row] = deque()
        self.older: list[tuple[int, float, float]] = []
        self.newer: list[tuple[int, float, float]] = []
        self.low_end, self.high_end = -INF, INF

    def join(self, time: int, values: list[float], upto: int) -> None:
        """Take the values of both operands at one sample."""
        left, right = values
        waiting, high = self.open, self._high
        while waiting and waiting[0] + high < time:
            self._close(time - 1)
        if self._low:
            self.waiting.append((time, left))
        low, top = right, left if left > right else right
        self.newer.append((time, low, top))
        # The product of the newer clamps and this one: each of its ends goes through that product.
        a, b = self.low_end, self.high_end
        self.low_end = a if low < a else b if low > b else low
        self.high_end = a if top < a else b if top > b else top
        waiting.append(time)
        while waiting and waiting[0] + high <= upto:
            self._close(upto)

    def _close(self, upto: int) -> None:
        """Hand on the value at the first open sample."""
        time = self.open.popleft()
        first = time + self._low
        while (self.older[-1] if self.older else self.newer[0] if self.newer else (first,))[0] < first:
            if not self.older:
                self._turn()
            self.older.pop()
        value = self.low_end
        if self.older:
            _, a, b = self.older[-1]
            value = a if value < a else b if value > b else value
        if self._low:
            value = min(value, self._least_left(time, first))
        self.give(time, value, self.open[0] - 1 if self.open else upto)

    def _turn(self) -> None:
        """Make the newer clamps older ones: products from each of them on."""
        low, high = -INF, INF
        for time, a, b in reversed(self.newer):
            low = a if low < a else b if low > b else low
            high = a if high < a else b if high > b else high
            self.older.append((time, low, high))
        self.newer = []
        self.low_end, self.high_end = -INF, INF

    def _least_left(self, time: int, first: int) -> float:
        """Return the least left value on [time, first)."""
        held, waiting = self.held, self.waiting
        while waiting and waiting[0][0] < first:
            row = waiting.popleft()
            while held and held[-1][1] >= row[1]:
                held.pop()
            held.append(row)
        while held and held[0][0] < time:
            held.popleft()
        return held[0][1] if held else INF
