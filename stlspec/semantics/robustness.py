"""Robustness of a formula at every sample, node by node over the DAG.

In: the formula DAG, some of its nodes, a trace. Out: the robustness of each of these at every sample. A
predicate exactly on its bound counts as `TIE` if it holds and as -`TIE` if not, the smallest numbers there
are: min, max and negation only select and flip, so the sign of every value is the Boolean verdict, strict
and non-strict comparisons kept apart, and no value is 0. `shown` turns ties into the 0 that they stand for.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import COMPARISONS, REAL, Node, reachable
from stlspec.compiler.ranges import TIE as TIE
from stlspec.semantics import windows
from stlspec.semantics.expressions import expression_values
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
_BATCH = 2**16
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
    return _evaluate(nodes, roots, trace, [])


def evaluate_at(nodes: Sequence[Node], roots: Sequence[int], trace: Trace, at: int) -> Floats:
    """Evaluate formulas at one sample of every trace of a batch.

    Paper: as `evaluate_nodes`. The traces are taken some at a time, in arrays that are used again, so that
    memory does not grow with the batch.

    Args:    nodes, roots, trace: as `evaluate_nodes`. at: a sample.
    Returns: (n_roots, n_traces), ties as `TIE` or -`TIE`.
    Raises:  DataError: a real expression is not a number at some sample.
    """
    result = np.empty((len(roots), trace.n_traces))
    spare: list[Floats] = []
    for first, part in batches(trace):
        if spare and spare[0].shape != part.shape:
            spare = []
        values = _evaluate(nodes, roots, part, spare)
        for row, of_root in zip(result, values, strict=True):
            row[first : first + part.n_traces] = of_root[at]
        spare += {id(v): v for i, v in zip(roots, values, strict=True) if nodes[i].op not in REAL}.values()
    return result


def batches(trace: Trace) -> Iterator[tuple[int, Trace]]:
    """Cut a batch into smaller ones of bounded size; with each the column where it begins."""
    count = -(-trace.n_samples * trace.n_traces // _BATCH)
    width = -(-trace.n_traces // count)
    for first in range(0, trace.n_traces, width):
        yield first, trace.columns(first, first + width)


def _evaluate(nodes: Sequence[Node], roots: Sequence[int], trace: Trace, spare: list[Floats]) -> list[Floats]:
    """Evaluate `roots`; `spare` holds arrays to write to, and takes those that are no longer needed."""
    needed = schedule(nodes, roots)
    uses = [0] * len(nodes)
    for index in chain(roots, *(nodes[i].children for i in needed)):
        uses[index] += 1
    grid = Grid(trace.times, trace.spacing)
    values: dict[int, Floats] = {}
    with np.errstate(all="ignore"):
        for index in needed:
            node = nodes[index]
            operands = [values[c] for c in node.children]
            if node.op in REAL:
                values[index] = expression_values(nodes, index, operands, trace)
            else:
                ending = [c for c in node.children[:2] if uses[c] == 1] if node.op in _IN_PLACE else []
                out = values[ending[0]] if ending else spare.pop() if spare else np.empty(trace.shape)
                values[index] = _formula_values(node, operands, trace, grid, out)
            for child in node.children:
                uses[child] -= 1
                if uses[child] == 0:
                    freed = values.pop(child)
                    if nodes[child].op not in REAL and freed is not values[index]:
                        spare.append(freed)
    return [values[r] if nodes[r].op not in REAL else np.broadcast_to(values[r], trace.shape) for r in roots]


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


def _formula_values(node: Node, operands: list[Floats], trace: Trace, grid: Grid, out: Floats) -> Floats:
    op = node.op
    if op in COMPARISONS:
        compare(op, operands[0], operands[1], out)
    elif op in _TEMPORAL:
        _TEMPORAL[op](*operands, grid, node.interval, out)
    elif op in ("and", "or"):
        extremum = np.minimum if op == "and" else np.maximum
        extremum(operands[0], operands[1], out=out)
        for operand in operands[2:]:
            extremum(out, operand, out=out)
    elif op == "not":
        np.negative(operands[0], out=out)
    elif op == "next":
        out[:-1] = operands[0][1:]
        out[-1] = -np.inf
    elif op == "prev":
        out[1:] = operands[0][:-1]
        out[0] = -np.inf
    elif op == "bool":
        out[...] = np.where(trace.signals[str(node.value)] != 0, np.inf, -np.inf)
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
