"""Witnesses: which predicate, at which sample, decides the value of a requirement.

In: the DAG, a requirement's root, a trace, a sample. Out: the deciding predicate and its sample. Min, max and
negation only select and flip, so a (node, sample) decides if a chain of operands with the value v (-v behind
a negation) leads to it from the root. The marks travel down the DAG as Boolean masks, one for each node and
sign, and windows as unions of ranges, so the work is linear in the number of samples.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import COMPARISONS, PAST, REAL, Node
from stlspec.semantics.robustness import evaluate_nodes, needed_nodes
from stlspec.semantics.windows import Grid, index_windows
from stlspec.traces import Trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """What decides a requirement, for each trace; arrays (n_traces,).

    samples: of the deciding predicate, -1 if none decides. predicates: its node, -1 if none. negated: it
    stands under an odd number of negations. vacuous: the value comes from an empty window, or from a next
    or prev off the end, and from no predicate.
    """

    samples: Ints
    predicates: Ints
    negated: Bools
    vacuous: Bools


def decide(nodes: Sequence[Node], root: int, trace: Trace, at: int) -> Decision:
    """Find what decides a requirement's value at sample `at`: of several predicates the earliest.

    Not in the paper: it explains a value.

    Args:    nodes: the DAG. root: a formula. trace: one or a batch. at: a sample, from 0.
    Returns: the decision for each trace; of several predicates at one sample the first in the DAG.
    """
    formulas = [i for i in needed_nodes(nodes, [root]) if nodes[i].op not in REAL]
    columns = evaluate_nodes(nodes, formulas, trace)
    rows = (np.ascontiguousarray(c.T).reshape(trace.n_traces, -1) for c in columns)
    values = dict(zip(formulas, rows, strict=True))
    start = np.zeros((trace.n_traces, trace.n_samples), dtype=np.bool_)
    start[:, at] = True
    marks = Marks(nodes, values, Grid(trace.ticks, trace.spacing), values[root][:, at : at + 1])
    marks.descend(root, start)
    vacuous = marks.ran_out & (marks.samples < 0)
    return Decision(marks.samples, marks.predicates, marks.negated, vacuous)


class Marks:
    """The masks still to be handed down, (n_traces, n_samples) each, and what was found.

    values: of every formula that may be reached. wanted: the value that is looked for, (n_traces, 1). samples,
    predicates, negated: as in `Decision`. ran_out: a window was empty, or a next or prev off the end.
    """

    def __init__(self, nodes: Sequence[Node], values: Mapping[int, Floats], grid: Grid, wanted: Floats) -> None:
        self.nodes, self.values, self.grid, self.wanted = nodes, values, grid, wanted
        n_traces = len(wanted)
        self.samples = np.full(n_traces, -1, dtype=np.int64)
        self.predicates = np.full(n_traces, -1, dtype=np.int64)
        self.negated = np.zeros(n_traces, dtype=np.bool_)
        self.ran_out = np.zeros(n_traces, dtype=np.bool_)
        self._open: dict[tuple[int, float], Bools] = {}

    def descend(self, root: int, start: Bools) -> None:
        """Follow the wanted value from the marked samples of a formula down to predicates."""
        self._open = {(root, 1.0): start}
        for index in range(root, -1, -1):
            for sign in (1.0, -1.0):
                mask = self._open.pop((index, sign), None)
                if mask is not None and mask.any():
                    _descend(self, index, sign, mask)

    def hand_window(self, index: int, sign: float, window: Bools) -> None:
        """Mark the samples in the windows of an operator over one operand."""
        self.hand(self.nodes[index].children[0], sign, window)

    def hand(self, child: int, sign: float, mask: Bools) -> None:
        """Mark the samples of `mask` at which the child has the wanted value."""
        mask = mask & (self.values[child] == sign * self.wanted)
        before = self._open.get((child, sign))
        self._open[child, sign] = mask if before is None else before | mask

    def found(self, index: int, sign: float, mask: Bools) -> None:
        """Keep the earliest sample of a deciding predicate; nodes come in falling order."""
        first = mask.argmax(axis=1)
        better = mask.any(axis=1) & ((self.samples < 0) | (first <= self.samples))
        self.samples[better] = first[better]
        self.predicates[better] = index
        self.negated[better] = sign < 0


def _descend(marks: Marks, index: int, sign: float, mask: Bools) -> None:
    """Hand the marks of a node to its operands."""
    node = marks.nodes[index]
    if node.op in COMPARISONS or node.op == "bool":
        marks.found(index, sign, mask)
    elif node.op == "not":
        marks.hand(node.children[0], -sign, mask)
    elif node.op in ("and", "or"):
        for child in node.children:
            marks.hand(child, sign, mask)
    elif node.op not in ("true", "false"):
        _descend_in_time(marks, index, sign, mask)


def _descend_in_time(marks: Marks, index: int, sign: float, mask: Bools) -> None:
    """Hand the marks of a temporal operator on; the past ones are seen backwards in time."""
    node = marks.nodes[index]
    step = -1 if node.op in PAST else 1
    grid = marks.grid.reversed() if node.op in PAST else marks.grid
    mask = mask[:, ::step]
    if node.interval is None:
        marks.ran_out |= mask[:, -1]
        shifted = np.zeros_like(mask)
        shifted[:, 1:] = mask[:, :-1]
        marks.hand(node.children[0], sign, shifted[:, ::step])
        return
    begin, end = index_windows(grid, node.interval)
    rows, samples = np.nonzero(mask)
    empty = begin[samples] == end[samples]
    marks.ran_out[rows[empty]] = True
    rows, samples = rows[~empty], samples[~empty]
    if len(node.children) == 1:
        window = _union(rows, begin[samples], end[samples], mask.shape)
        marks.hand_window(index, sign, window[:, ::step])
        return
    left, right = (marks.values[c][:, ::step] for c in node.children)
    wanted = sign * marks.wanted
    for child, window in zip(node.children, _until_ranges(left, right, wanted, rows, samples, begin, end), strict=True):
        marks.hand(child, sign, window[:, ::step])


def _until_ranges(
    left: Floats, right: Floats, wanted: Floats, rows: Ints, samples: Ints, begin: Ints, end: Ints
) -> tuple[Bools, Bools]:
    """Return where the operands of until may decide: masks for left and right.

    The right operand may at t' if the left one is not below the value before t'; the left one may at any
    sample before the last such t' at which the right one is not below the value.
    """
    n = left.shape[1]
    base = rows * n
    here, first, last = base + samples, base + begin[samples], base + end[samples]
    # One flat row of all traces: a position beyond a trace's own end is cut off by `last`.
    below = np.append(np.flatnonzero(left < wanted), left.size)
    barrier = below[np.searchsorted(below, here)]
    last = np.maximum(first, np.minimum(last, barrier + 1))
    enough = np.append(np.flatnonzero(right >= wanted), -1)
    latest = enough[np.searchsorted(enough[:-1], last) - 1]
    latest = np.where(latest >= first, latest, here)
    reach = _union(rows, samples, latest - base, left.shape)
    return reach, _union(rows, first - base, last - base, left.shape)


def _union(rows: Ints, begin: Ints, end: Ints, shape: tuple[int, ...]) -> Bools:
    """Return the mask of the union of ranges [begin, end), each in its row."""
    n_rows, width = shape[0], shape[1] + 1
    opened = np.bincount(rows * width + begin, minlength=n_rows * width)
    closed = np.bincount(rows * width + end, minlength=n_rows * width)
    depth = np.cumsum(opened - closed).reshape(n_rows, width)
    return np.asarray(depth[:, :-1] > 0)
