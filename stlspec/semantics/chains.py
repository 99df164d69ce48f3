"""Chains: how the value of a requirement comes down to the predicate that decides it, and where that is wrong.

In: the DAG, a requirement's root, one trace, a sample, the witness. Out: the (formula, sample) pairs from the
root to the witness, and the samples at which the deciding predicate bears out the verdict. What an operator
reads of an operand is always one range of samples, so "does one of them lead to the witness" is a difference
of two running counts, and everything is linear in the number of samples.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import COMPARISONS, PAST, REAL, Interval, Node
from stlspec.semantics.robustness import TIE, evaluate_nodes, needed_nodes
from stlspec.semantics.windows import Grid, index_windows
from stlspec.traces import Trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Ranges = tuple[Ints, Ints]
"""For every sample the range [begin, end) of samples that are read, (n_samples,) each."""

_ONE_BREAKS = frozenset({"always", "historically"})
_ONE_MENDS = frozenset({"eventually", "once"})


@dataclass(frozen=True, slots=True)
class Link:
    """A formula, taken at a sample: a step of the chain.

    index: of the node. sign: -1 under an odd number of negations, else 1.
    """

    index: int
    sample: int
    sign: int


@dataclass(frozen=True, slots=True, eq=False)
class Values:
    """All formulas below a root on one trace; values: (n_samples,) each, ties as `robustness.TIE` says."""

    nodes: Sequence[Node]
    root: int
    at: int
    grid: Grid
    values: Mapping[int, Floats]

    @property
    def wanted(self) -> float:
        """The value of the root at the sample that was asked about."""
        return float(self.values[self.root][self.at])


def values_below(nodes: Sequence[Node], root: int, trace: Trace, at: int) -> Values:
    """Evaluate a formula and all formulas below it.

    Paper: robustness of STL.

    Args:    nodes: the DAG. root: a formula. trace: one trace. at: a sample, from 0.
    Returns: their values at every sample.
    """
    formulas = [i for i in needed_nodes(nodes, [root]) if nodes[i].op not in REAL]
    values = dict(zip(formulas, evaluate_nodes(nodes, formulas, trace), strict=True))
    return Values(nodes, root, at, Grid(trace.ticks, trace.spacing), values)


def find_chain(found: Values, predicate: int | None, sample: int) -> tuple[Link, ...]:
    """Find how the root's value comes from a predicate; every link has the root's value, up to its sign.

    Not in the paper: it explains a value.

    Args:    found: the values. predicate, sample: the witness; None where no predicate decides: the chain
             then ends at the empty window, or at the constant, that the value comes from.
    Returns: links from the root at `found.at` on; only the root if nothing leads on.
    """
    ends = _ends(found, predicate, sample)
    reached = _reached(found, ends)
    link = Link(found.root, found.at, 1)
    chain = [link]
    while not _at(ends, link):
        onward = _next_link(found, reached, link)
        if onward is None:
            break
        link = onward
        chain.append(link)
    return tuple(chain)


def bearing_samples(found: Values, chain: Sequence[Link], *, fewest: bool = False) -> Bools:
    """Find the samples at which the last link's predicate is as the verdict has it, inside what is read of it.

    Where a requirement is violated, these are its violating samples: a window in which all samples matter
    is searched as a whole, not only where the worst one is.

    Paper: equation (3), s_bad, for any formula.

    Args:    found: the values. chain: from the root on. fewest: of windows in which one sample is enough to
             turn the operator round keep as few samples as hit all of them, the chain's own first.
    Returns: (n_samples,) bool.
    """
    mask = np.zeros(len(found.grid), dtype=np.bool_)
    mask[found.at] = True
    holds = found.wanted > 0
    for link, below in pairwise(chain):
        node = found.nodes[link.index]
        position = node.children.index(below.index)
        true = holds == (link.sign > 0)
        lapsed = node.op in ("until", "since") and not true
        begin, end = (
            (_whole_left if position == 0 else _windows)(found, link.index)
            if lapsed
            else (_read(found, link.index, position, TIE))
        )
        rows = np.flatnonzero(mask & (begin < end))
        if fewest and node.op in (_ONE_BREAKS if true else _ONE_MENDS):
            mask = _hitting(begin[rows], end[rows], below.sample, len(mask))
        else:
            mask = _union(begin[rows], end[rows], len(mask))
        mask &= (found.values[below.index] * below.sign > 0) == holds
    return mask


def _ends(found: Values, predicate: int | None, sample: int) -> dict[int, Bools]:
    """Mark where a chain may end: (n_samples,) for each node."""
    n = len(found.grid)
    if predicate is not None:
        mark = np.zeros(n, dtype=np.bool_)
        mark[sample] = True
        return {predicate: mark}
    ends = {}
    for index in found.values:
        op = found.nodes[index].op
        if op in ("true", "false"):
            ends[index] = np.ones(n, dtype=np.bool_)
        elif found.nodes[index].interval is not None or op in ("next", "prev"):
            begin, end = _windows(found, index)
            ends[index] = begin == end
    return ends


def _reached(found: Values, ends: Mapping[int, Bools]) -> dict[tuple[int, int], Bools]:
    """Mark from where a chain of equal values leads to an end, for each node and sign."""
    reached: dict[tuple[int, int], Bools] = {}
    for index in sorted(found.values):
        node = found.nodes[index]
        for sign in (1, -1):
            here = found.values[index] == sign * found.wanted
            if not here.any():
                continue
            mark = ends[index].copy() if index in ends else np.zeros_like(here)
            for position, child in enumerate(_operands(node)):
                below = reached.get((child, -sign if node.op == "not" else sign))
                if below is not None:
                    begin, end = _read(found, index, position, sign * found.wanted)
                    count = np.concatenate(([0], np.cumsum(below)))
                    mark |= count[np.maximum(begin, end)] > count[begin]
            mark &= here
            if mark.any():
                reached[index, sign] = mark
    return reached


def _next_link(found: Values, reached: Mapping[tuple[int, int], Bools], link: Link) -> Link | None:
    node = found.nodes[link.index]
    sign = -link.sign if node.op == "not" else link.sign
    for position, child in enumerate(_operands(node)):
        below = reached.get((child, sign))
        if below is None:
            continue
        begin, end = _read(found, link.index, position, link.sign * found.wanted)
        inside = np.flatnonzero(below[begin[link.sample] : end[link.sample]])
        if len(inside):
            return Link(child, int(begin[link.sample] + inside[0]), sign)
    return None


def _at(ends: Mapping[int, Bools], link: Link) -> bool:
    return link.index in ends and bool(ends[link.index][link.sample])


def _operands(node: Node) -> tuple[int, ...]:
    return () if node.op in COMPARISONS else node.children


def _read(found: Values, index: int, position: int, level: float) -> Ranges:
    """Return the samples that a node reads of an operand where its own value is `level` or more."""
    node = found.nodes[index]
    if node.interval is None and node.op not in ("next", "prev"):
        samples = np.arange(len(found.grid), dtype=np.int64)
        return samples, samples + 1
    window = _windows(found, index)
    if node.op not in ("until", "since"):
        return window
    left, right = (found.values[c] for c in node.children)
    if node.op == "since":
        mirrored = _until_ranges(left[::-1], right[::-1], level, _mirror(window))
        return _mirror(mirrored[position])
    return _until_ranges(left, right, level, window)[position]


def _windows(found: Values, index: int) -> Ranges:
    """Return the windows of a temporal operator."""
    node, n = found.nodes[index], len(found.grid)
    samples = np.arange(n, dtype=np.int64)
    if node.op == "next":
        return np.minimum(samples + 1, n), np.minimum(samples + 2, n)
    if node.op == "prev":
        return np.maximum(samples - 1, 0), samples
    interval: Interval = node.interval or (0, None)
    if node.op in PAST:
        return _mirror(index_windows(found.grid.reversed(), interval))
    return index_windows(found.grid, interval)


def _mirror(ranges: Ranges) -> Ranges:
    """Return the ranges as seen backwards in time."""
    begin, end = ranges
    n = len(begin)
    return (n - end)[::-1], (n - begin)[::-1]


def _until_ranges(left: Floats, right: Floats, level: float, window: Ranges) -> tuple[Ranges, Ranges]:
    """Return where each operand of until may decide: the right one as long as the left one has kept up."""
    begin, end = window
    here = np.arange(len(begin), dtype=np.int64)
    below = np.append(np.flatnonzero(left < level), len(left))
    barrier = below[np.searchsorted(below, here)]
    last = np.maximum(begin, np.minimum(end, barrier + 1))
    enough = np.append(np.flatnonzero(right >= level), -1)
    latest = enough[np.searchsorted(enough[:-1], last) - 1]
    latest = np.where(latest >= begin, latest, here)
    return (here, np.maximum(here, latest)), (begin, last)


def _whole_left(found: Values, index: int) -> Ranges:
    """Return all samples at which the left operand of a violated until is needed by some sample of the window."""
    past = found.nodes[index].op == "since"
    _, end = _mirror(_windows(found, index)) if past else _windows(found, index)
    here = np.arange(len(end), dtype=np.int64)
    ranges = here, np.maximum(here, end - 1)
    return _mirror(ranges) if past else ranges


def _union(begin: Ints, end: Ints, n: int) -> Bools:
    """Return the mask of the union of ranges."""
    depth = np.bincount(begin, minlength=n + 1) - np.bincount(end, minlength=n + 1)
    return np.asarray(np.cumsum(depth)[:n] > 0)


def _hitting(begin: Ints, end: Ints, first: int, n: int) -> Bools:
    """Return as few samples as hit every range, `first` among them: a range not hit yet is hit at its end."""
    mask = np.zeros(n, dtype=np.bool_)
    mask[first] = True
    latest = -1
    for low, high in sorted(zip(begin.tolist(), end.tolist(), strict=True), key=lambda r: r[1]):
        if not low <= first < high and not low <= latest:
            latest = high - 1
            mask[latest] = True
    return mask
