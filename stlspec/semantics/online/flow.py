"""Exact values where samples are counted: a schedule that is fixed, written into the monitor's function.

In: the DAG. Out: lines, and the objects that remember. Where time is the index of the sample, an operator whose
horizon is d gives at sample n its value at n - d, always. So no value carries its time, nothing waits in queues of
open samples, and the operators are lines of one function in the order of their horizons, in place of the objects
of `late` that call each other. A window is cut into blocks of its length (van Herk 1992; Gil and Werman 1993): it
is the end of one block and the beginning of the next, so that it costs constant work a sample on average.
"""

from array import array
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from stlspec.compiler.horizon import horizons
from stlspec.compiler.ranges import INF
from stlspec.semantics.online.front import Front
from stlspec.semantics.online.past import Greatest, Since, Sliding
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, State, Unsound, column, numbers

_SHORT = 48
"""Blocks up to this length are faster in Python than in NumPy."""


def queue(value: Any) -> deque[float]:
    """Read a queue of numbers."""
    return deque(numbers(value))


class Delay(Remembering):
    """The values of the latest `length` samples; the first value comes with sample number `begin`."""

    __slots__ = ("_begin", "_length", "values")
    STATE: ClassVar[State] = {"values": queue}

    def __init__(self, begin: int, length: int) -> None:
        self._begin, self._length = begin, length
        self.values: deque[float] = deque()

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if len(self.values) != min(max(0, n - self._begin), self._length):
            raise Unsound("a delay has another length")


class Block(Remembering):
    """The latest `length` values of an operand whose first value comes with sample number `begin`.

    newer: of the running block, if it is kept here; the values of settled operands are on the tape anyway. older:
    the least (greatest) of each end of the block before, without that block itself, the shortest first: those
    that windows still reach into.
    """

    __slots__ = ("_begin", "_kept", "_least", "_length", "newer", "older")
    STATE: ClassVar[State] = {"newer": column, "older": numbers}

    def __init__(self, begin: int, length: int, least: bool, kept: bool) -> None:
        self._begin, self._length, self._least, self._kept = begin, length, least, kept
        self.newer = array("d")
        self.older: list[float] = []

    def turn(self, values: "array[float]") -> None:
        """Make the running block, which is complete, the one before; values: end with those of the block."""
        self.older += extrema_of_ends(values, self._length, self._least)
        del self.newer[:]

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        new, old = _sizes(n - self._begin, self._length)
        if [len(self.newer), len(self.older)] != [new * self._kept, old]:
            raise Unsound("a block has another length")


class UntilBlock(Remembering):
    """The same for until: best, held: for each end of the block before until over it, and the least left value."""

    __slots__ = ("_begin", "_kept", "_length", "best", "held", "lefts", "rights")
    STATE: ClassVar[State] = {"lefts": column, "rights": column, "best": numbers, "held": numbers}

    def __init__(self, begin: int, length: int, kept: tuple[bool, bool]) -> None:
        self._begin, self._length, self._kept = begin, length, kept
        self.lefts, self.rights = array("d"), array("d")
        self.best: list[float] = []
        self.held: list[float] = []

    def turn(self, lefts: "array[float]", rights: "array[float]") -> None:
        """Make the running block, which is complete, the one before."""
        self.held += extrema_of_ends(lefts, self._length, least=True)
        keep, best, first = self.best.append, -INF, -self._length
        for left, right in zip(lefts[:first:-1], rights[:first:-1], strict=True):
            if left < best:
                best = left
            if right > best:
                best = right
            keep(best)
        del self.lefts[:]
        del self.rights[:]

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        new, old = _sizes(n - self._begin, self._length)
        wanted = [new * self._kept[0], new * self._kept[1], old, old]
        if [len(x) for x in (self.lefts, self.rights, self.best, self.held)] != wanted:
            raise Unsound("a block has another length")


def extrema_of_ends(values: "array[float]", length: int, least: bool) -> list[float]:
    """Return the least (greatest) of the last value, of the last two, and so on up to length - 1 of them.

    Not in the paper: it serves monitors.
    """
    if length > _SHORT:
        # The view must be gone before the array grows again.
        ends = np.frombuffer(values, dtype=np.float64)[:-length:-1]
        found: list[float] = (np.minimum if least else np.maximum).accumulate(ends).tolist()
        return found
    best = INF if least else -INF
    if least:
        return [best := x if x < best else best for x in values[:-length:-1]]
    return [best := x if x > best else best for x in values[:-length:-1]]


def _sizes(count: int, length: int) -> tuple[int, int]:
    """Return how many values of the running block there are after `count`, and how many ends of that before."""
    blocks, new = divmod(max(0, count), length)
    return new, length - 1 - new if blocks else 0


class Flow:
    """Writes the lines that compute operators, each value late by its operator's horizon.

    At sample n the lines of a level run only if n has reached it, those of lower levels before. taped: for variables
    whose latest values are on the tape what names the column.
    """

    def __init__(self, plan: Plan, front: Front, taped: Mapping[str, str]) -> None:
        self._plan, self._front, self._lines, self._taped = plan, front, front.lines, taped
        found = horizons(plan.nodes, plan.base)
        self._horizons = [0 if settled else h for settled, h in zip(plan.settled, found, strict=True)]
        self._levels: dict[int, list[str]] = {0: self._lines.lines}
        self._names: dict[tuple[int, int], str] = {}
        self._delayed: dict[tuple[str, int, int], str] = {}

    def horizon(self, index: int) -> int:
        """Return how many samples late the values of a formula are."""
        found = self._horizons[index]
        assert found is not None
        return found

    def write(self, others: Sequence[int], roots: Sequence[int], tell: Callable[[int, int, str], str]) -> None:
        """Write formulas and what the function returns.

        Args: others: those that are not settled, children first. roots: of the requirements. tell: names what is
            told of requirement number i, given its horizon and the variable of its value.
        """
        values = {index: self._operator(index) for index in others}
        told: list[tuple[int, str]] = []
        for i, root in enumerate(roots):
            level = self.horizon(root)
            name = values[root] if root in values else self._front.value(root)
            self._at(level)
            told.append((level, self._lines.let(tell(i, level, name))))
        lines = self._lines.lines = self._levels[0]
        for level in sorted(self._levels):
            if level:
                lines.append(f"if n < {self._lines.bind(level)}:")
                lines.append(f"    return [{', '.join(name for at, name in told if at < level)}]")
                lines += self._levels[level]
        lines.append(f"return [{', '.join(name for _, name in sorted(told, key=lambda x: x[0]))}]")

    def _at(self, level: int) -> None:
        """Let the next lines be of a level."""
        self._lines.lines = self._levels.setdefault(level, [])

    def _value(self, index: int, level: int) -> str:
        """Name the variable that holds the value of a formula from a level on, as late as that level."""
        own = self.horizon(index)
        if self._plan.settled[index]:
            self._at(0)
            name = self._front.value(index)
        else:
            name = self._names[index, own]
        name = self._later(name, own, level)
        self._at(level)
        return name

    def _later(self, name: str, begin: int, level: int) -> str:
        """Delay a variable; constants and the newest values need none."""
        if begin == level or name in ("INF", "NINF"):
            return name
        key = (name, begin, level)
        if key not in self._delayed:
            part = self._lines.keep(lambda: Delay(begin, level - begin))
            self._at(begin)
            self._lines.add(f"{self._lines.call(part, lambda delay: delay.values.append)}({name})")
            self._at(level)
            self._delayed[key] = self._lines.let(f"{self._lines.call(part, lambda delay: delay.values.popleft)}()")
        return self._delayed[key]

    def _operator(self, index: int) -> str:
        """Write an operator once its operands are written."""
        node = self._plan.nodes[index]
        level = max(self.horizon(c) for c in node.children)
        names = [self._value(c, level) for c in node.children]
        result = self._written(node.op, names, level, node.interval)
        self._names[index, self.horizon(index)] = result
        return result

    def _written(self, op: str, names: list[str], level: int, interval: tuple[int, int | None] | None) -> str:
        lines = self._lines
        if op == "not":
            # Not `negated`: a variable may have been passed on to a level above its own.
            return {"INF": "NINF", "NINF": "INF"}.get(names[0]) or lines.let(f"-{names[0]}")
        if op in ("and", "or"):
            return lines.least(names) if op == "and" else lines.greatest(names)
        if op == "next":
            return names[0]
        if op == "prev":
            before = lines.remember(-INF)
            result = lines.let(before)
            lines.add(f"{before} = {names[0]}")
            return result
        assert interval is not None
        low, high = interval
        if op in ("historically", "once", "since"):
            kind: Callable[..., Any] = {"historically": Sliding, "once": Greatest, "since": Since}[op]
            return lines.let(f"{lines.part(lambda: kind(low, high))}(n - {lines.bind(level)}, {', '.join(names)})")
        assert high is not None
        if op == "until":
            return self._until(names, level, low, high)
        return self._window(names[0], level, high - low + 1, op == "always")

    def _window(self, name: str, begin: int, length: int, least: bool) -> str:
        """Write the least (greatest) of the latest `length` values of a variable."""
        if length == 1 or name in ("INF", "NINF"):
            return name
        lines, sign, neutral = self._lines, "<" if least else ">", INF if least else -INF
        part = lines.keep(lambda: Block(begin, length, least, name not in self._taped))
        running = lines.remember(neutral)
        values = self._running_block(part, name, lambda block: block.newer)
        lines.add(f"if {name} {sign} {running}:")
        lines.add(f"    {running} = {name}")
        result = lines.let(running)
        lines.add(f"if {lines.call(part, lambda block: block.older)}:")
        before = f"{result}o"
        lines.add(f"    {before} = {lines.call(part, lambda block: block.older.pop)}()")
        lines.add(f"    if {before} {sign} {result}:")
        lines.add(f"        {result} = {before}")
        lines.add(f"elif n >= {lines.bind(begin + length - 1)}:")
        lines.add(f"    {lines.call(part, lambda block: block.turn)}({values})")
        lines.add(f"    {running} = {lines.number(neutral)}")
        return result

    def _running_block(self, part: int, name: str, list_of: Callable[[Any], Any]) -> str:
        """Name what ends with the values of the running block; write what keeps them if the tape does not."""
        if name in self._taped:
            return self._taped[name]
        self._lines.add(f"{self._lines.call(part, lambda block: list_of(block).append)}({name})")
        return self._lines.call(part, list_of)

    def _until(self, names: Sequence[str], begin: int, low: int, high: int) -> str:
        """Write until over [low, high]: until over the last samples, after the least left value before these."""
        length = high - low + 1
        result = names[1] if length == 1 else self._until_at_once(names[0], names[1], begin, length)
        if low == 0:
            return result
        level = begin + length
        left = self._later(names[0], begin, level)
        self._at(level)
        held = self._window(left, level, low, least=True)
        self._at(begin + high)
        return self._lines.least([held, result])

    def _until_at_once(self, left: str, right: str, begin: int, length: int) -> str:
        lines = self._lines
        part = lines.keep(lambda: UntilBlock(begin, length, (left not in self._taped, right not in self._taped)))
        best, held = lines.remember(-INF), lines.remember(INF)
        lefts = self._running_block(part, left, lambda block: block.lefts)
        rights = self._running_block(part, right, lambda block: block.rights)
        result = lines.let(best)
        reached = f"{result}r"
        lines.add(f"{reached} = {held}")
        lines.add(f"if {right} < {reached}:")
        lines.add(f"    {reached} = {right}")
        lines.add(f"if {reached} > {result}:")
        lines.add(f"    {best} = {result} = {reached}")
        lines.add(f"if {left} < {held}:")
        lines.add(f"    {held} = {left}")
        lines.add(f"if {lines.call(part, lambda block: block.best)}:")
        before = f"{result}o"
        lines.add(f"    {before} = {lines.call(part, lambda block: block.held.pop)}()")
        lines.add(f"    if {before} < {result}:")
        lines.add(f"        {result} = {before}")
        lines.add(f"    {before} = {lines.call(part, lambda block: block.best.pop)}()")
        lines.add(f"    if {before} > {result}:")
        lines.add(f"        {result} = {before}")
        lines.add(f"elif n >= {lines.bind(begin + length - 1)}:")
        lines.add(f"    {lines.call(part, lambda block: block.turn)}({lefts}, {rights})")
        lines.add(f"    {best} = NINF; {held} = INF")
        return result
