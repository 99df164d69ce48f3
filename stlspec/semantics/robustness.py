"""Robustness of a formula at every sample, node by node over the DAG.

In: the formula DAG, some of its nodes, a trace. Out: the robustness of each of these at every sample. A
predicate exactly on its bound counts as `TIE` if it holds and as -`TIE` if not, the smallest numbers there
are: min, max and negation only select and flip, so the sign of every value is the Boolean verdict, strict
and non-strict comparisons kept apart, and no value is 0. `shown` turns ties into the 0 that they stand for.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import COMPARISONS, REAL, Node, reachable
from stlspec.compiler.ranges import TIE as TIE
from stlspec.semantics import windows
from stlspec.semantics.expressions import expression_values
from stlspec.semantics.spans import Span, needed_spans, read_span
from stlspec.semantics.windows import Grid
from stlspec.traces import Trace

Floats = NDArray[np.float64]

_TEMPORAL: dict[str, Callable[..., Floats]] = {
    "always": windows.always,
    "eventually": windows.eventually,
    "until": windows.until,
    "historically": windows.historically,
    "once": windows.once,
    "since": windows.since,
}
# Of a batch this many numbers of a signal are evaluated at a time.
_BATCH = 2**18
_IN_PLACE = frozenset({"and", "or", "not"})
"""Operators that may write over an operand that nothing else needs."""
_HOLDS_ON_BOUND = frozenset({"ge", "le", "eq"})


def evaluate_nodes(nodes: Sequence[Node], roots: Sequence[int], trace: Trace) -> list[Floats]:
    """Evaluate nodes of the DAG at every sample.

    Paper: robustness of STL, extended by past operators, next and prev.

    Args:    nodes: the DAG, children first. roots: indices of the wanted nodes, formulas or real
             expressions. trace: every signal that the roots use.
    Returns: for each root its values, of the shape of a signal; not to be written to. In formulas a tie is
             `TIE` or -`TIE`: see `shown`.
    Raises:  DataError: a real expression is not a number at some sample.
    """
    order, whole = schedule(nodes, roots), (0, trace.n_samples)
    return _evaluate(_Plan(nodes, roots, order, [whole] * len(nodes)), trace, [])


def evaluate_at(nodes: Sequence[Node], roots: Sequence[int], trace: Trace, at: int) -> Floats:
    """Evaluate formulas at one sample of every trace of a batch.

    Paper: as `evaluate_nodes`. Only the samples that the wanted one depends on are evaluated. The traces are taken
    some at a time, in arrays that are used again, so that memory does not grow with the batch.

    Args:    nodes, roots, trace: as `evaluate_nodes`. at: a sample.
    Returns: (n_roots, n_traces), ties as `TIE` or -`TIE`.
    Raises:  DataError: a real expression is not a number at some sample, needed or not.
    """
    order = schedule(nodes, roots)
    spans = needed_spans(nodes, order, roots, Grid(trace.ticks, trace.spacing), at)
    plan = _Plan(nodes, roots, order, spans)
    result = np.empty((len(roots), trace.n_traces))
    spare: list[Floats] = []
    for first, part in batches(trace, plan.end):
        if spare and spare[0].shape[1] != part.n_traces:
            spare = []
        values = _evaluate(plan, part, spare)
        for row, root, of_root in zip(result, roots, values, strict=True):
            row[first : first + part.n_traces] = of_root[at - spans[root][0]]
        spare += {id(v): v for i, v in zip(roots, map(_whole, values), strict=True) if nodes[i].op not in REAL}.values()
    return result


def batches(trace: Trace, n_samples: int | None = None) -> Iterator[tuple[int, Trace]]:
    """Cut a batch, or its first samples, into smaller ones of bounded size; with each the column where it begins."""
    n_samples = trace.n_samples if n_samples is None else n_samples
    count = -(-n_samples * trace.n_traces // _BATCH)
    width = -(-trace.n_traces // count)
    for first in range(0, trace.n_traces, width):
        yield first, trace.columns(first, first + width, n_samples)


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """What to evaluate: the nodes below some roots, children first, and the samples of each that are wanted."""

    nodes: Sequence[Node]
    roots: Sequence[int]
    order: Sequence[int]
    spans: Sequence[Span]

    @property
    def end(self) -> int:
        """No sample from here on is wanted of any node."""
        return max((self.spans[i][1] for i in self.order), default=1)

    @property
    def longest(self) -> int:
        """How many samples are wanted of a formula, at most."""
        spans = (self.spans[i] for i in self.order if self.nodes[i].op not in REAL)
        return max((end - first for first, end in spans), default=1)


def _evaluate(plan: _Plan, trace: Trace, spare: list[Floats]) -> list[Floats]:
    """Evaluate the roots; `spare` holds arrays to write to, and takes those that are no longer needed."""
    nodes, spans = plan.nodes, plan.spans
    uses = [0] * len(nodes)
    for index in chain(plan.roots, *(nodes[i].children for i in plan.order)):
        uses[index] += 1
    grid, shape = Grid(trace.ticks, trace.spacing), (plan.longest, *trace.shape[1:])
    values: dict[int, Floats] = {}
    with np.errstate(all="ignore"):
        for index in plan.order:
            node, (first, end) = nodes[index], spans[index]
            reads = read_span(node, spans[index], grid)
            operands = [_cut(values[c], spans[c], reads) for c in node.children]
            if node.op in REAL:
                found = expression_values(nodes, index, operands, trace)
                values[index] = found if node.children else _cut(found, (0, trace.n_samples), spans[index])
            else:
                pairs = zip(operands[:2], node.children, strict=False) if node.op in _IN_PLACE else ()
                ending = (operand for operand, child in pairs if uses[child] == 1)
                out = next(ending, None)
                out = (spare.pop() if spare else np.empty(shape))[: end - first] if out is None else out
                values[index] = formula_values(node, operands, trace, reads, out)
            for child in node.children:
                uses[child] -= 1
                if uses[child] == 0:
                    freed = _whole(values.pop(child))
                    if nodes[child].op not in REAL and freed is not _whole(values[index]):
                        spare.append(freed)
    return [values[r] if nodes[r].op not in REAL else np.broadcast_to(values[r], trace.shape) for r in plan.roots]


def _cut(values: Floats, own: Span, wanted: Span) -> Floats:
    """Return the wanted samples of those that there are; constants have none."""
    return values if values.ndim == 0 else values[wanted[0] - own[0] : wanted[1] - own[0]]


def _whole(values: Floats) -> Floats:
    """Return the array that the values of a formula were written to, some of its rows or all."""
    return values if values.base is None else np.asarray(values.base)


def needed_nodes(nodes: Sequence[Node], roots: Sequence[int]) -> list[int]:
    """Return the indices of the nodes that `roots` need, children first."""
    wanted = set(roots)
    for index in range(max(roots, default=-1), -1, -1):
        if index in wanted:
            wanted.update(nodes[index].children)
    return sorted(wanted)


def schedule(nodes: Sequence[Node], roots: Sequence[int]) -> list[int]:
    """Return the nodes that `roots` need, children first, the roots over until and since before the others.

    Their scans take more memory for a while than anything else, so they run while few results are kept yet.
    """
    scans = [False] * len(nodes)
    for index in needed_nodes(nodes, roots):
        node = nodes[index]
        scans[index] = node.op in ("until", "since") or any(scans[c] for c in node.children)
    _, order = reachable(nodes, sorted(roots, key=lambda root: not scans[root]))
    return list(order)


def shown(values: Floats) -> Floats:
    """Return a copy of robustness values with ties as the 0 that they stand for, never -0."""
    result = np.array(values, dtype=np.float64)
    result[np.abs(result) <= TIE] = 0.0
    return result


def formula_values(node: Node, operands: Sequence[Floats], trace: Trace, reads: Span, out: Floats) -> Floats:
    """Write a formula's values to `out` and return it, given those of its operands at the samples that it reads.

    Paper: as `evaluate_nodes`.
    """
    op, samples = node.op, slice(*reads)
    if op in COMPARISONS:
        compare(op, operands[0], operands[1], out)
    elif op in _TEMPORAL:
        _TEMPORAL[op](*operands, Grid(trace.ticks[samples], trace.spacing), node.interval, out)
    elif op in ("and", "or"):
        extremum = np.minimum if op == "and" else np.maximum
        extremum(operands[0], operands[1], out=out)
        for operand in operands[2:]:
            extremum(out, operand, out=out)
    elif op == "not":
        np.negative(operands[0], out=out)
    elif op == "next":
        windows.shift(operands[0], 1, -np.inf, out)
    elif op == "prev":
        windows.shift(operands[0][::-1], 1, -np.inf, out[::-1])
    elif op == "bool":
        out[...] = np.where(trace.signals[str(node.value)][samples] != 0, np.inf, -np.inf)
    else:
        out[...] = np.inf if op == "true" else -np.inf
    return out


def compare(op: str, left: Floats, right: Floats, out: Floats) -> None:
    """Write the robustness of a predicate: the distance to its bound, negative where it does not hold.

    Paper: robustness of the predicate f(x) >= c.

    Args:    op: a comparison. left, right: its operands. out: where to write; ties as `TIE` or -`TIE`.
    """
    if op in ("lt", "le"):
        np.subtract(right, left, out=out)
    else:
        np.subtract(left, right, out=out)
    if op in ("eq", "ne"):
        np.absolute(out, out=out)
    if op == "eq":
        np.negative(out, out=out)
    # Equal infinities are on the bound too; their difference is no number.
    tied = np.equal(left, right)
    if tied.any():
        out[np.broadcast_to(tied, out.shape)] = TIE if op in _HOLDS_ON_BOUND else -TIE
