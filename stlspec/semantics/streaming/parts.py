"""What is remembered of each outermost operator: its value at sample 0 so far, and what decides it.

In: views of a recording, piece after piece. Out: a value and a `Finding`, exact once the part is closed. always,
eventually and until are folded sample by sample, so that only what their operands look at must be kept; any
other formula waits until its value at sample 0 is known.
"""

import math

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import Node
from stlspec.semantics.streaming.views import Finding, View

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class Part:
    """One formula at sample 0. done: the number of samples that are taken in. closed: `value` can no longer change."""

    def __init__(self, index: int, node: Node) -> None:
        self.index, self.node = index, node
        self.done, self.closed = 0, False
        self.value = math.nan
        self.finding = Finding()

    @property
    def watched(self) -> tuple[int, ...]:
        """The nodes whose values it takes."""
        return (self.index,)

    def take(self, view: View) -> None:
        """Take what a view has beyond what was taken before."""
        if view.end(self.index):
            start = np.zeros(view.trace.n_samples, dtype=np.bool_)
            start[0] = True
            self.value = float(view.values[self.index][0])
            self.finding = view.deciding(self.index, start, self.value)
            self.closed = True


class Fold(Part):
    """What is common to operators that are folded: their samples in order, and the end of their window."""

    @property
    def watched(self) -> tuple[int, ...]:
        """The operands."""
        return self.node.children

    def take(self, view: View) -> None:
        """Take the samples at which all operands are exact."""
        assert self.node.interval is not None
        low, high = self.node.interval
        here = slice(self.done - view.first, min(view.end(c) for c in self.node.children))
        times = view.times[here]
        inside = times >= low
        if high is not None:
            inside &= times <= high
        if len(times):
            self.fold(view, here, inside)
            self.done = view.first + here.stop
        self.closed = view.ended or (high is not None and len(times) > 0 and int(times[-1]) > high)

    def fold(self, view: View, here: slice, inside: Bools) -> None:
        """Take in the samples `here`; inside: which of them are in the window."""
        raise NotImplementedError


class Extremum(Fold):
    """always and eventually: the least or the greatest value in the window."""

    def __init__(self, index: int, node: Node) -> None:
        super().__init__(index, node)
        self.value = math.inf if node.op == "always" else -math.inf
        # As long as no sample was in the window.
        self.finding = Finding(None, ran_out=True)
        self._seen = False

    def fold(self, view: View, here: slice, inside: Bools) -> None:
        """Take in samples."""
        (child,) = self.node.children
        values = view.values[child][here]
        if not inside.any():
            return
        found = values[inside]
        extremum = float(found.min() if self.node.op == "always" else found.max())
        better = extremum < self.value if self.node.op == "always" else extremum > self.value
        if self._seen and not better and (extremum != self.value or view.decided_before(self.finding)):
            return
        finding = view.deciding(child, _marked(view, here, inside & (values == extremum)), extremum)
        self.finding = self.finding.merged(finding) if self._seen and not better else finding
        self.value, self._seen = extremum, True


class Until(Fold):
    """until: the best branch so far, and how far down the left operand has been.

    Paper: robustness of until; what decides it is what `witness` says: the right operand at samples up to which the
    left one has not been below the value, the left one before the last sample at which the right one suffices.
    """

    def __init__(self, index: int, node: Node) -> None:
        super().__init__(index, node)
        self.value = -math.inf
        self.finding = Finding(None, ran_out=True)
        self._seen = False
        self._held, self._holding = math.inf, Finding()

    def fold(self, view: View, here: slice, inside: Bools) -> None:
        """Take in samples."""
        left, right = (view.values[c][here] for c in self.node.children)
        held = np.minimum.accumulate(np.concatenate(([self._held], left)))[:-1]
        if inside.any():
            best = float(np.minimum(right, held)[inside].max())
            if not self._seen or best > self.value:
                self.value, self.finding, self._seen = best, Finding(), True
            if best == self.value:
                self._decided(view, here, inside & (held >= self.value))
        self._hold(view, here, left)

    def _decided(self, view: View, here: slice, reached: Bools) -> None:
        """Find what decides the value among the samples at which the left operand has held so far."""
        left, right = self.node.children
        self._merge(view, here, right, reached)
        enough = np.flatnonzero(reached & (view.values[right][here] >= self.value))
        if not len(enough):
            return
        if self._held == self.value:
            self.finding = self.finding.merged(self._holding)
        before = np.arange(len(reached)) < enough[-1]
        self._merge(view, here, left, before)

    def _merge(self, view: View, here: slice, child: int, among: Bools) -> None:
        mask = among & (view.values[child][here] == self.value)
        if mask.any() and not view.decided_before(self.finding):
            self.finding = self.finding.merged(view.deciding(child, _marked(view, here, mask), self.value))

    def _hold(self, view: View, here: slice, left: Floats) -> None:
        """Remember the least value of the left operand, and what decides it."""
        least = float(left.min())
        if least > self._held or (least == self._held and view.decided_before(self._holding)):
            return
        finding = view.deciding(self.node.children[0], _marked(view, here, left == least), least)
        self._holding = self._holding.merged(finding) if least == self._held else finding
        self._held = least


def _marked(view: View, here: slice, mask: Bools) -> Bools:
    """Return a mask over the samples of a view."""
    marked = np.zeros(view.trace.n_samples, dtype=np.bool_)
    marked[here] = mask
    return marked


def part_of(index: int, node: Node) -> Part:
    """Make what remembers an outermost formula."""
    kinds = {"always": Extremum, "eventually": Extremum, "until": Until}
    return kinds.get(node.op, Part)(index, node)
