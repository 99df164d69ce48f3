"""The enclosure at sample 0 of a formula of any depth.

In: at every sample the values of the settled formulas under one outermost operator. Out: its low, high and
current value. Samples whose operands can no longer change are folded into a few numbers; the enclosures of
the others are computed again from the tape, so the work grows with the number of samples that are open.
"""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.horizon import horizons
from stlspec.compiler.ranges import INF
from stlspec.semantics.online.arrays import Columns, Stretch, enclosures, needed, stretch, three
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, State, Unsound, number, optional, row_of, whole
from stlspec.semantics.online.tape import Tape, reach_back

Floats = NDArray[np.float64]
Enclosure = tuple[float, float, float]
"""low, high, and current: the value if the trace ends here."""

NOWHERE: Enclosure = (0.0, 0.0, 0.0)
"""What is given for a sample that does not exist yet; nobody may look at it."""


class General(Remembering):
    """The enclosure of a formula at sample number `origin`.

    folded: numbers of the next sample that is not folded. start: time of the sample `origin`. bounds: what is
    folded, (L, H): the value is max(L, min(H, rest)), where rest is that of the samples not folded.
    """

    __slots__ = (
        *("_ahead", "_inputs", "_node", "_origin", "_others", "_plan", "_reach", "_roots", "_whole"),
        *("bounds", "done", "folded", "start", "tape"),
    )
    STATE: ClassVar[State] = {
        "folded": whole,
        "start": optional(whole),
        "bounds": row_of(number, number),
        "done": optional(row_of(number, number, number)),
    }

    def __init__(self, plan: Plan, index: int, origin: int = 0) -> None:
        node = plan.nodes[index]
        # Any other operator is computed anew over all samples.
        self._whole = node.op not in ("always", "eventually", "until")
        self._roots = (index,) if self._whole else node.children
        self._plan, self._node, self._origin = plan, node, origin
        self._inputs, self._others = needed(plan, self._roots)
        self._reach = None if self._whole else reach_back(plan, self._others, self._roots)
        ahead = horizons(plan.nodes, plan.base)
        known = [h for h in (ahead[c] for c in node.children) if h is not None]
        self._ahead = max(known, default=0) if len(known) == len(node.children) else None
        self.folded = origin
        self.start: int | None = None
        self.bounds: tuple[float, float] = (-INF, INF)
        self.done: Enclosure | None = None
        self.tape = Tape(len(self._inputs))

    @property
    def inputs(self) -> tuple[int, ...]:
        """The settled formulas whose values are wanted."""
        return self._inputs

    def step(self, time: int, *values: float) -> Enclosure:
        """Take the values at the newest sample."""
        if self.done is not None:
            return self.done
        self.tape.push(time, values)
        number_of = self.tape.base + len(self.tape.times) - 1
        if number_of < self._origin:
            return NOWHERE
        if number_of == self._origin:
            self.start = time
        base = self.tape.base if self._whole else self.tape.needed(self.folded, self._reach)
        times, columns = self.tape.arrays(base)
        span = stretch(self._plan, times)
        found = enclosures(span, self._inputs, self._others, columns)
        if self._whole:
            low, high, current = (float(column[self._origin]) for column in found[self._roots[0]])
            result = (low, high, current)
        else:
            result = self._combined(span, [found[c] for c in self._roots], self.folded - base)
        if result[0] == result[1] and not self._plan.certain:
            self.done = result
            self.tape = Tape(len(self._inputs))
        return result

    def _combined(self, span: Stretch, operands: list[Columns], first: int) -> Enclosure:
        assert self.start is not None and self._node.interval is not None
        ages = span.grid.times[first:] - self.start
        rest = [three(x, first) for x in operands]
        low, high = self._node.interval
        inside = ages >= low
        if high is not None:
            inside &= ages <= high
        age = span.last - self.start
        still_open = high is None or age < high
        if len(rest) == 1:
            result = self._extremum(rest[0], inside, still_open)
        else:
            result = self._until(rest, inside, still_open, age + self._plan.stride < low)
        self._fold(span, ages, rest, inside)
        return result

    def _extremum(self, values: Floats, inside: NDArray[np.bool_], still_open: bool) -> Enclosure:
        always = self._node.op == "always"
        extremum, folded = (np.minimum, self.bounds[1]) if always else (np.maximum, self.bounds[0])
        ends = extremum.reduce(values[inside], axis=0, initial=folded)
        if still_open:
            for side in (0, 1) if self._plan.certain else (0,) if always else (1,):
                ends[side] = extremum(ends[side], self._plan.tails[self._node.children[0]][side])
        return tuple(ends.tolist())

    def _until(self, rest: list[Floats], inside: NDArray[np.bool_], still_open: bool, late: bool) -> Enclosure:
        left, right = rest
        lowest, highest = self.bounds
        held = np.minimum.accumulate(np.concatenate((np.full((1, 3), highest), left)), axis=0)
        ends = np.minimum(held[:-1], right)[inside].max(axis=0, initial=lowest)
        if still_open:
            tails = [self._plan.tails[c] for c in self._node.children]
            for side in (0, 1) if self._plan.certain else (1,):
                branch = min(held[-1, side], tails[1][side])
                if late and self._plan.dense:
                    branch = min(branch, tails[0][side])
                ends[side] = max(ends[side], branch)
        return tuple(ends.tolist())

    def _fold(self, span: Stretch, ages: NDArray[np.int64], rest: list[Floats], inside: NDArray[np.bool_]) -> None:
        """Take in the samples whose operands can no longer change, in order."""
        if self._plan.certain:
            fixed = np.zeros(len(ages), dtype=np.bool_)
            if self._ahead is not None:
                fixed = span.grid.times[len(span.grid.times) - len(ages) :] <= span.last - self._ahead
        else:
            fixed = np.logical_and.reduce([x[:, 0] == x[:, 1] for x in rest])
        count = len(fixed) if fixed.all() else int(fixed.argmin())
        low, high = self.bounds
        for row in range(count):
            if len(rest) == 2:
                if inside[row]:
                    low = max(low, min(high, rest[1][row, 0]))
                high = min(high, rest[0][row, 0])
            elif inside[row] and self._node.op == "always":
                high = min(high, rest[0][row, 0])
            elif inside[row]:
                low = max(low, rest[0][row, 0])
        self.bounds = (float(low), float(high))
        self.folded += count
        self.tape.drop(self.folded, self._reach)

    def parts(self) -> list[Tape]:
        """Return the objects that it consists of."""
        return [self.tape]

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        begun = self.start is not None and 0 <= self.start <= newest
        held = self.tape.base + len(self.tape.times)
        if begun != (n > self._origin) or held != (n if self.done is None else 0):
            raise Unsound("a tape does not fit")
        if not max(self._origin, self.tape.base) <= self.folded <= max(n, self._origin):
            raise Unsound("a tape does not fit")


def inputs_of(plan: Plan, index: int) -> Sequence[int]:
    """Return the settled formulas whose values the enclosure of a formula takes."""
    return General(plan, index).inputs
