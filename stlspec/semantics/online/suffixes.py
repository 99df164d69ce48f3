"""Enclosures at all open samples of one window over settled operands, where samples are counted.

In: the tape, whenever somebody asks. Out: low, high and current value at each open sample, ties as 0. Every window
that is open reaches to the newest sample, so its value is that of a suffix, and samples that came since the last
call change all suffixes alike: a few passes over the array of the last call give the new one. Arrays that were
handed out are never written to again.
"""

from array import array
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ranges import INF
from stlspec.semantics import windows
from stlspec.semantics.online.arrays import Columns
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.robustness import TIE, shown
from stlspec.semantics.windows import Grid

Floats = NDArray[np.float64]


def make_suffixes(plan: Plan, index: int) -> "Suffixes | None":
    """Return what encloses a formula at its open samples; None if it is no such window."""
    node = plan.nodes[index]
    if node.op not in ("always", "eventually", "until") or not all(plan.settled[c] for c in node.children):
        return None
    assert node.interval is not None
    low, high = node.interval
    if high is None or (node.op == "until" and low > 0):
        return None
    tails = [(_visible(a), _visible(b)) for a, b in (plan.tails[c] for c in node.children)]
    if node.op == "until":
        return UntilSuffixes(tails[-1], plan.certain)
    return WindowSuffixes(node.op == "always", low, tails[0], plan.certain)


def _visible(value: float) -> float:
    return 0.0 if abs(value) <= TIE else value


def latest(column: "array[float]", count: int) -> Floats:
    """Return a copy of the latest values of a column, ties as 0; shown values mix just as values do.

    Not in the paper: it serves monitors.
    """
    return shown(np.frombuffer(column, dtype=np.float64)[len(column) - count :])


class Suffixes:
    """Numbers of the samples that the last call was about: from `first` to before `end`."""

    def __init__(self) -> None:
        self.first = self.end = 0
        # One number as an array: quicker to take in than a scalar.
        self._one = np.empty(1)

    def columns(self, tape: "Sequence[array[float]]", first: int, n: int) -> Columns:
        """Return low, high and current at the samples from `first` to before `n`, at least one.

        Args: tape: the operands' latest values, those up to sample `n` - 1.
        """
        raise NotImplementedError

    def _newest(self, column: "array[float]") -> Floats:
        """Return the newest value, ties as 0; it holds until the next call."""
        value = column[-1]
        self._one[0] = value if value > TIE or value < -TIE else 0.0
        return self._one

    def _move(self, first: int, n: int) -> tuple[int, slice]:
        """Name the samples for the next call; return how many are new, and which of the last ones stay."""
        new, stay = n - max(self.end, first), slice(first - self.first, None)
        self.first, self.end = first, n
        return new, stay


class WindowSuffixes(Suffixes):
    """always (least) or eventually over [low, high]."""

    def __init__(self, least: bool, low: int, tail: tuple[float, float], certain: bool) -> None:
        super().__init__()
        self._extremum: np.ufunc = np.minimum if least else np.maximum
        self._empty = INF if least else -INF
        self._kernel = windows.always if least else windows.eventually
        self._low, self._tail, self._least, self._certain = low, tail, least, certain
        self._suffixes: Floats = np.empty(0)
        self._unknown: Floats = np.empty(0)

    def columns(self, tape: "Sequence[array[float]]", first: int, n: int) -> Columns:
        """Return low, high and current."""
        current = self._within(tape[0], first + self._low, n) if first + self._low < n else np.empty(0)
        if self._low:
            current = np.concatenate((current, np.full(n - first - len(current), self._empty)))
        low = self._with_tail(current, 0) if self._least or self._certain else current
        high = self._with_tail(current, 1) if not self._least or self._certain else current
        return low, high, current

    def _within(self, column: "array[float]", first: int, n: int) -> Floats:
        new, stay = self._move(first, n)
        before = self._suffixes[stay]
        if new == 0:
            self._suffixes = before
            return before
        values = self._newest(column) if new == 1 else self._within_new(latest(column, new))
        self._suffixes = found = np.empty(n - first)
        self._extremum(before, values[:1], out=found[:-new])
        found[-new:] = values
        return found

    def _within_new(self, values: Floats) -> Floats:
        return self._kernel(values, Grid(np.arange(len(values)), 1), (0, None))

    def _with_tail(self, values: Floats, side: int) -> Floats:
        bound = self._tail[side]
        if bound == -self._empty:
            if len(self._unknown) < len(values):
                self._unknown = np.full(2 * len(values), bound)
                self._unknown.flags.writeable = False
            return self._unknown[: len(values)]
        return values if bound == self._empty else self._extremum(values, bound)


class UntilSuffixes(Suffixes):
    """until over [0, high]: best: its value at each sample; held: the least left value from there on."""

    def __init__(self, tail: tuple[float, float], certain: bool) -> None:
        super().__init__()
        self._tail, self._certain = tail, certain
        self._best: Floats = np.empty(0)
        self._held: Floats = np.empty(0)

    def columns(self, tape: "Sequence[array[float]]", first: int, n: int) -> Columns:
        """Return low, high and current."""
        new, stay = self._move(first, n)
        best, held = self._best[stay], self._held[stay]
        if new:
            left, right = (latest(column, new) for column in tape)
            if new > 1:
                grid = Grid(np.arange(new), 1)
                right, left = windows.until(left, right, grid, (0, None)), windows.always(left, grid, (0, None))
            count = len(best)
            found, kept = np.empty(n - first), np.empty(n - first)
            reached = np.minimum(held, right[0], out=found[:count])
            np.maximum(best, reached, out=reached)
            np.minimum(held, left[0], out=kept[:count])
            found[count:], kept[count:] = right, left
            best, held = found, kept
        self._best, self._held = best, held
        return (self._branch(0) if self._certain else best), self._branch(1), best

    def _branch(self, side: int) -> Floats:
        """Return what the next sample may make of it at most."""
        bound = self._tail[side]
        return np.maximum(self._best, self._held if bound == INF else np.minimum(self._held, bound))
