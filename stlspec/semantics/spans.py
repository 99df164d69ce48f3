"""Spans: which samples of each node are needed for one sample of the roots.

In: the DAG, the wanted sample, the times. Out: for every node a range of samples. What an operator reads of its
operands is one range that begins or ends at the samples where it is itself needed, so one walk from the roots to
the leaves finds all ranges, and evaluation leaves out the rest.
"""

from collections.abc import Sequence

import numpy as np

from stlspec.compiler.ir import FUTURE, PAST, Node
from stlspec.compiler.passes import PARTIAL
from stlspec.semantics.windows import Grid

Span = tuple[int, int]
"""A range of samples: the first and the end, exclusive; never empty."""


def needed_spans(nodes: Sequence[Node], order: Sequence[int], roots: Sequence[int], grid: Grid, at: int) -> list[Span]:
    """Find the samples of each node that the roots depend on at one sample.

    Not in the paper: it saves work. A real expression that may have no value is needed everywhere, since its first
    sample without one is reported.

    Args:    nodes: the DAG. order: the nodes below the roots, children first. roots: of formulas. grid: the times.
             at: a sample.
    Returns: for each node a range that holds all needed samples; (0, 0) for those not below the roots.
    """
    n = len(grid)
    spans: list[Span] = [(0, 0)] * len(nodes)
    for root in roots:
        spans[root] = at, at + 1
    for index in reversed(order):
        node = nodes[index]
        if node.op in PARTIAL:
            spans[index] = 0, n
        reads = read_span(node, spans[index], grid)
        for child in node.children:
            spans[child] = _hull(spans[child], reads)
    return spans


def read_span(node: Node, span: Span, grid: Grid) -> Span:
    """Return which samples of its operands a node reads for a range of its own; not in the paper.

    Args:    node: any. span: its samples. grid: the times.
    Returns: a range that holds `span`: as it is for operators that do not look into past or future.
    """
    first, end = span
    if node.op in FUTURE:
        return first, _reach(node, end, grid)
    if node.op in PAST:
        n = len(grid)
        return n - _reach(node, n - first, grid.reversed()), end
    return span


def _reach(node: Node, end: int, grid: Grid) -> int:
    """Return how far an operator reads that is needed before `end`, as seen in the direction in which it looks."""
    n = len(grid)
    if node.interval is None:
        return min(end + 1, n)
    _, high = node.interval
    if high is None:
        return n
    if grid.spacing is not None:
        return min(end + high // grid.spacing, n)
    times = grid.times
    # Clipped to the length of the trace, which changes no window, so that the sum fits into int64.
    high = min(high, int(times[-1]) - int(times[0]))
    return int(np.searchsorted(times, times[end - 1] + high, "right"))


def _hull(one: Span, other: Span) -> Span:
    return other if one == (0, 0) else (min(one[0], other[0]), max(one[1], other[1]))
