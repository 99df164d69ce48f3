"""The values of a piece, and what decides one of them.

In: a piece of a recording, and what is remembered of the samples before it. Out: a `View`. What decides a value is
found as `witness` finds it, with one addition: where an operator's window goes back beyond the piece, what was found
there long ago takes part.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import REAL, Node
from stlspec.compiler.rates import written_unit
from stlspec.semantics.expressions import expression_values
from stlspec.semantics.reasons import reason_of
from stlspec.semantics.robustness import formula_values
from stlspec.semantics.streaming.regions import exact_from, exact_to
from stlspec.semantics.windows import Grid
from stlspec.semantics.witness import Marks
from stlspec.traces import Trace

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Label:
    """A deciding predicate: its sample, its node, and whether it stands under an odd number of negations.

    time: of the sample, in the spec's unit. operands: the values of the predicate's operands there.
    """

    sample: int
    predicate: int
    negated: bool
    time: float
    operands: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Finding:
    """What decides a value: the earliest predicate, if any, and whether a window ran out of samples."""

    label: Label | None = None
    ran_out: bool = False

    def merged(self, other: "Finding") -> "Finding":
        """Return what decides if both do."""
        labels = [x for x in (self.label, other.label) if x is not None]
        first = min(labels, key=lambda x: (x.sample, x.predicate), default=None)
        return Finding(first, self.ran_out or other.ran_out)

    def seen_from(self, sign: float) -> "Finding":
        """Return it as it looks from above a negation, if `sign` is negative."""
        if sign > 0 or self.label is None:
            return self
        return Finding(replace(self.label, negated=not self.label.negated), self.ran_out)


@dataclass(frozen=True, slots=True)
class Past:
    """What an operator without end remembers of its operand before a sample, by the sample's number."""

    until: int
    value: float
    finding: Finding


class View:
    """A piece with the values of some nodes; samples are counted from its first one.

    times: (n_samples,). first: the number of the first sample in the recording. ended: no sample comes after it.
    """

    def __init__(
        self, nodes: Sequence[Node], needed: Sequence[int], trace: Trace, pasts: Mapping[int, Past], ended: bool
    ) -> None:
        self.nodes, self.trace, self.pasts, self.ended = nodes, trace, pasts, ended
        self.times, self.first = trace.times, trace.first
        self._held = {index: past.until - self.first for index, past in pasts.items()}
        self._from = exact_from(nodes, needed, trace.times, self._held) if self.first else {}
        n = trace.n_samples
        self._to = dict.fromkeys(needed, n) if ended else exact_to(nodes, needed, trace.times)
        self.values: dict[int, Floats] = {}
        with np.errstate(all="ignore"):
            for index in needed:
                self.values[index] = self._evaluated(index)

    def end(self, index: int) -> int:
        """Return the end of the samples at which a node is exact."""
        return self._to[index]

    def _evaluated(self, index: int) -> Floats:
        node = self.nodes[index]
        operands = [self.values[c] for c in node.children]
        if node.op in REAL:
            return self._expression(index, operands)
        if index in self._held:
            filled = operands[0].copy()
            filled[: self._held[index]] = self.pasts[index].value
            operands = [filled]
        n_samples = self.trace.n_samples
        return formula_values(node, operands, self.trace, (0, n_samples), np.empty(n_samples))

    def _expression(self, index: int, operands: Sequence[Floats]) -> Floats:
        """Evaluate an expression where its operands are exact: elsewhere it might not even be a number."""
        begin = max((self._from.get(c, 0) for c in self.nodes[index].children), default=0)
        trace = self.trace
        if begin:
            signals = {name: values[begin:] for name, values in trace.signals.items()}
            trace = replace(trace, ticks=trace.times[begin:], signals=signals, first=trace.first + begin)
            operands = [o if o.ndim == 0 else o[begin:] for o in operands]
        found = expression_values(self.nodes, index, operands, trace)
        if found.ndim == 0 or not begin:
            return found
        return np.concatenate([np.zeros(begin), found])

    def decided_before(self, finding: Finding) -> bool:
        """Say whether nothing in this piece can decide earlier than what was found before it."""
        label = finding.label
        if label is None or label.sample >= self.first:
            return False
        return all(p.finding.label is None or p.finding.label.sample > label.sample for p in self.pasts.values())

    def deciding(self, index: int, start: Bools, wanted: float, sign: float = 1.0) -> Finding:
        """Find what decides the value of a formula at the marked samples, at all of which it is `wanted`.

        Not in the paper: it explains a value.

        Args:    start: (n_samples,). sign: negative if the formula stands under a negation, for the result.
        """
        rows = {i: v.reshape(1, -1) for i, v in self.values.items() if self.nodes[i].op not in REAL}
        marks = _PieceMarks(self, rows, wanted)
        marks.descend(index, start.reshape(1, -1))
        found = Finding(None, bool(marks.ran_out[0]))
        if marks.samples[0] >= 0:
            found = Finding(self._label(marks), found.ran_out)
        return found.merged(marks.older).seen_from(sign)

    def _label(self, marks: Marks) -> Label:
        sample, predicate = int(marks.samples[0]), int(marks.predicates[0])
        node = self.nodes[predicate]
        columns = [self.values[c] for c in node.children] or [self.trace.signals[str(node.value)]]
        operands = tuple(float(c if c.ndim == 0 else c[sample]) for c in columns)
        return Label(self.first + sample, predicate, bool(marks.negated[0]), self.trace.time(sample), operands)


def reason(bundle: BundleData, label: Label) -> str:
    """Say what a deciding predicate's operands are, and what is needed of them."""
    written = written_unit(bundle, label.predicate)
    return reason_of(bundle.nodes, label.predicate, label.negated, label.operands, written)


class _PieceMarks(Marks):
    """Marks that may lead back beyond the beginning of a piece; older: what decides there."""

    def __init__(self, view: View, values: Mapping[int, Floats], wanted: float) -> None:
        super().__init__(view.nodes, values, Grid(view.times, view.trace.spacing), np.array([[wanted]]))
        self._view = view
        self.older = Finding()

    def hand_window(self, index: int, sign: float, window: Bools) -> None:
        """Mark the samples in the windows of an operator; those before the piece are remembered as one."""
        past = self._view.pasts.get(index)
        if past is not None:
            begin = past.until - self._view.first
            if window[:, :begin].any() and past.value == sign * self.wanted[0, 0]:
                self.older = self.older.merged(past.finding.seen_from(sign))
            window = window.copy()
            window[:, :begin] = False
        super().hand_window(index, sign, window)
