"""Windows and until in any algebra, for a whole signal at once, and the way back for gradients.

In: values at every sample, the windows as ranges of samples, an associative operation. Out: the fold of every
window. Nothing but associativity is used: a window is cut into disjoint pieces whose lengths are powers of 2,
one for each binary digit of its length, so a fold takes about 2 log2(width) passes and no loop over samples.
Until needs distributivity to do better than to look at every pair of samples; here it looks at every pair.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import COMPARISONS, PAST, REAL, Node
from stlspec.compiler.passes import optimised
from stlspec.semantics.algebra import Algebra, Operation, embedded
from stlspec.semantics.expressions import expression_values
from stlspec.semantics.robustness import TIE, compare, evaluate_nodes, needed_nodes, shown
from stlspec.semantics.slopes import times
from stlspec.semantics.windows import Grid, index_windows
from stlspec.traces import Trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_PAIRS = 2**20
"""Of the pairs of samples that until looks at, this many are held at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One step of a fold: at `rows` the result so far, `before`, and the piece at `places` gave `after`."""

    rows: Ints
    places: Ints
    before: Floats
    after: Floats


def fold_windows(
    operation: Operation, neutral: float, values: Floats, begin: Ints, end: Ints, steps: list[Step] | None = None
) -> tuple[Floats, list[Floats]]:
    """Fold values[begin[i]:end[i]] for every i.

    Paper: robustness of always and eventually over an abstract ⊗ and ⊕.

    Args:    operation: associative. neutral: its neutral element, the fold of no values. values: (n_samples,)
             or (n_samples, n_traces). begin, end: (n_samples,). steps: takes what `unfold_windows` needs.
    Returns: the folds, of the shape of `values`; the folds of 1, 2, 4, ... values from every sample on.
    """
    lengths, places = end - begin, begin.copy()
    result: Floats = np.full(values.shape, neutral, dtype=values.dtype)
    tables = [values]
    for digit in range(int(lengths.max()).bit_length()):
        size = 1 << digit
        if digit:
            half = tables[-1]
            tables.append(operation(half[: -(size // 2)], half[size // 2 :]))
        rows = np.flatnonzero(lengths & size)
        before = result[rows]
        after = operation(before, tables[-1][places[rows]])
        result[rows] = after
        if steps is not None:
            steps.append(Step(rows, places[rows], before, after))
        places[rows] += size
    return result, tables


def unfold_windows(slope: Operation, tables: Sequence[Floats], steps: Sequence[Step], cotangent: Floats) -> Floats:
    """Bring the derivatives with respect to folds back to the values that were folded.

    Not in the paper: reverse accumulation through `fold_windows`.

    Args:    slope: d result / d operand as a function of (operand, result). tables, steps: of `fold_windows`.
             cotangent: d goal / d fold, (n_samples,).
    Returns: d goal / d value, (n_samples,).
    """
    cotangent = cotangent.copy()
    below = [np.zeros(len(table)) for table in tables]
    for digit in range(len(steps) - 1, -1, -1):
        step, table = steps[digit], tables[digit]
        towards = cotangent[step.rows]
        np.add.at(below[digit], step.places, times(towards, slope(table[step.places], step.after)))
        cotangent[step.rows] = times(towards, slope(step.before, step.after))
    for digit in range(len(steps) - 1, 0, -1):
        half, whole, shift = tables[digit - 1], tables[digit], 1 << (digit - 1)
        below[digit - 1][:-shift] += times(below[digit], slope(half[:-shift], whole))
        below[digit - 1][shift:] += times(below[digit], slope(half[shift:], whole))
    return below[0]


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Until over some samples: all pairs of such a sample (axis 0) and one from it on (axis 1).

    rows: the samples. columns: of the pairs, the second samples; past the end where a window ends earlier.
    lasting: ⊗ of left on [first, second). met: right ⊗ lasting, ⊥ outside the window. result: ⊕ over axis 1.
    """

    rows: Ints
    columns: Ints
    lasting: Floats
    met: Floats
    result: Floats


def until_pairs(algebra: Algebra, left: Floats, right: Floats, begin: Ints, end: Ints, rows: Ints) -> Iterator[Pairs]:
    """Evaluate until at some samples, in parts of bounded size.

    Paper: robustness of until over abstract ⊕ and ⊗.

    Args:    left, right: (n_samples,) or (n_samples, n_traces). begin, end: windows of t'. rows: the samples.
    Yields:  the pairs of some of the rows, all rows in turn.
    """
    n, first = len(left), 0
    per_pair = left[0].size
    # One more sample than there is, which changes no fold, stands for all beyond the end.
    left = np.concatenate([left, np.full((1, *left.shape[1:]), algebra.top)])
    right = np.concatenate([right, np.full((1, *right.shape[1:]), algebra.bottom)])
    while first < len(rows):
        widths = np.maximum.accumulate(end[rows[first:]] - rows[first:])
        sizes = widths * np.arange(1, len(widths) + 1) * per_pair
        part = rows[first : first + max(1, int(np.searchsorted(sizes, _PAIRS)))]
        first += len(part)
        width = max(1, int((end[part] - part).max()))
        columns = part[:, None] + np.arange(width)
        columns = np.where(columns < end[part][:, None], columns, n)
        inside = (columns >= begin[part][:, None]) & (columns < n)
        lasting = _lasting(algebra, left[columns])
        met = np.where(_spread(inside, left), algebra.meet(right[columns], lasting), algebra.bottom)
        yield Pairs(part, columns, lasting, met, _reduced(algebra.join, met))


def unfold_until(
    algebra: Algebra, left: Floats, right: Floats, begin: Ints, end: Ints, cotangent: Floats
) -> tuple[Floats, Floats]:
    """Bring the derivative with respect to until back to its operands.

    Not in the paper: reverse accumulation through `until_pairs`.

    Args:    algebra: with slopes. left, right, begin, end: as `until_pairs`. cotangent: d goal / d until,
             (n_samples,).
    Returns: d goal / d left and d goal / d right, (n_samples,) each.
    """
    assert algebra.slopes is not None
    of_join, of_meet = algebra.slopes
    n = len(left)
    to_left, to_right = np.zeros(n + 1), np.zeros(n + 1)
    left, right = np.append(left, algebra.top), np.append(right, algebra.bottom)
    for pairs in until_pairs(algebra, left[:n], right[:n], begin, end, np.flatnonzero(cotangent)):
        p, q, lasting, met = left[pairs.columns], right[pairs.columns], pairs.lasting, pairs.met
        towards = times(cotangent[pairs.rows][:, None], of_join(met, pairs.result[:, None]))
        np.add.at(to_right, pairs.columns, times(towards, of_meet(q, met)))
        onward = algebra.meet(lasting, p)
        of_lasting = _accumulated(times(towards, of_meet(lasting, met)), of_meet(lasting, onward))
        # What lasts up to the next place is made of what lasts up to this one and of left here.
        np.add.at(to_left, pairs.columns[:, :-1], times(of_lasting[:, 1:], of_meet(p, onward)[:, :-1]))
    return to_left[:n], to_right[:n]


def _accumulated(own: Floats, slope: Floats) -> Floats:
    """Return y with y[:, k] = own[:, k] + slope[:, k] * y[:, k + 1], by doubling."""
    total, slope, span = own.copy(), slope.copy(), 1
    while span < total.shape[1]:
        total[:, :-span] += times(total[:, span:], slope[:, :-span])
        slope[:, :-span] = slope[:, :-span] * slope[:, span:]
        span *= 2
    return total


def _spread(mask: Bools, like: Floats) -> Bools:
    """Give a mask of pairs the axis of the traces, if there is one."""
    return mask if like.ndim == 1 else mask.reshape(*mask.shape, 1)


def _lasting(algebra: Algebra, values: Floats) -> Floats:
    """Fold along axis 1 what stands before each place, by doubling."""
    result: Floats = np.full(values.shape, algebra.top)
    result[:, 1:] = values[:, :-1]
    span = 1
    while span < result.shape[1]:
        result[:, span:] = algebra.meet(result[:, :-span], result[:, span:])
        span *= 2
    return result


def _reduced(operation: Operation, values: Floats) -> Floats:
    """Fold along axis 1, neighbours first."""
    while values.shape[1] > 1:
        even = values.shape[1] // 2 * 2
        folded = operation(values[:, 0:even:2], values[:, 1:even:2])
        values = np.concatenate([folded, values[:, even:]], axis=1) if even < values.shape[1] else folded
    return values[:, 0]


def evaluate_in(algebra: Algebra, nodes: Sequence[Node], roots: Sequence[int], trace: Trace) -> list[Floats]:
    """Evaluate formulas at every sample in any algebra.

    Paper: Definition 5, quantitative semantics over (⊕, ⊗, ⊤, ⊥). Lattices take the kernels of `windows`; in
    others windows cost about 2 log2(width) operations a sample, until as many as its window has samples.

    Args:    algebra: any. nodes: the DAG. roots: of formulas. trace: every signal that the roots use.
    Returns: for each root (n_samples,), for a batch (n_samples, n_traces); not to be written to, and without
             the tie of `robustness`.
    Raises:  DataError: a real expression is not a number at some sample.
    """
    nodes, roots = optimised(nodes, roots, algebra.laws, trace.spacing)
    if is_lattice(algebra):
        return [lattice_elements(algebra, values) for values in evaluate_nodes(nodes, roots, trace)]
    values = all_values(algebra, nodes, roots, trace)
    return [values[r] for r in roots]


def evaluate_in_at(algebra: Algebra, nodes: Sequence[Node], roots: Sequence[int], trace: Trace, at: int) -> Floats:
    """Evaluate formulas at one sample; else as `evaluate_in`.

    Paper: as `evaluate_in`. An until is evaluated only at the samples that the wanted one depends on.

    Returns: (n_roots,), for a batch (n_roots, n_traces).
    """
    if is_lattice(algebra):
        return np.array([values[at] for values in evaluate_in(algebra, nodes, roots, trace)])
    nodes, roots = optimised(nodes, roots, algebra.laws, trace.spacing)
    values = all_values(algebra, nodes, roots, trace, at)
    return np.array([values[r][at] for r in roots])


def is_lattice(algebra: Algebra) -> bool:
    """Tell whether the kernels of min and max serve an algebra; not in the paper."""
    return "lattice" in algebra.laws


def lattice_elements(algebra: Algebra, values: Floats) -> Floats:
    """Turn robustness in min/max into that of another lattice, ties into the 0 that they stand for.

    Not in the paper. The embedding of a lattice passes through max, min and negation, so it may come last.

    Args:    algebra: a lattice. values: as `robustness.evaluate_nodes` returns them.
    Returns: the same shape; `values` itself where nothing changes.
    """
    if algebra.embed is not None:
        return shown(embedded(algebra, values))
    return shown(values) if (np.abs(values) <= TIE).any() else values


def all_values(
    algebra: Algebra, nodes: Sequence[Node], roots: Sequence[int], trace: Trace, at: int | None = None
) -> dict[int, Floats]:
    """Evaluate all nodes below some roots by the general kernels.

    Paper: as `evaluate_in`.

    Args:    algebra, nodes, roots, trace: as `evaluate_in`. at: the only sample that is wanted of the roots.
    Returns: for each node the values; those of until are ⊥ where what is wanted does not depend on them.
    """
    grid = Grid(trace.ticks, trace.spacing)
    wanted = {} if at is None else wanted_samples(nodes, roots, grid, at)
    values: dict[int, Floats] = {}
    with np.errstate(all="ignore"):
        for index in needed_nodes(nodes, roots):
            node = nodes[index]
            operands = [values[c] for c in node.children]
            if node.op in REAL:
                values[index] = np.broadcast_to(expression_values(nodes, index, operands, trace), trace.shape)
            elif node.op in COMPARISONS:
                distances = np.empty(trace.shape)
                compare(node.op, operands[0], operands[1], distances)
                values[index] = embedded(algebra, shown(distances))
            elif node.interval is not None:
                values[index] = _temporal(algebra, node, operands, grid, wanted.get(index))
            else:
                values[index] = _of_sample(algebra, node, operands, trace)
    return values


def _of_sample(algebra: Algebra, node: Node, operands: Sequence[Floats], trace: Trace) -> Floats:
    """Evaluate a formula that looks at one sample of its operands only."""
    op = node.op
    if op == "not":
        return np.asarray(algebra.negate(operands[0]))
    if op in ("and", "or"):
        return reduce(algebra.meet if op == "and" else algebra.join, operands)
    values = np.full(trace.shape, algebra.top if op == "true" else algebra.bottom)
    if op == "bool":
        values[trace.signals[str(node.value)] != 0] = algebra.top
    elif op == "next":
        values[:-1] = operands[0][1:]
    elif op == "prev":
        values[1:] = operands[0][:-1]
    return values


def _temporal(algebra: Algebra, node: Node, operands: Sequence[Floats], grid: Grid, wanted: Bools | None) -> Floats:
    """Evaluate a bounded temporal operator; the past ones are seen backwards in time."""
    step = -1 if node.op in PAST else 1
    operands, begin, end = facing(node, operands, grid)
    if len(operands) == 1:
        values, _ = fold_windows(*operation_of(algebra, node), operands[0], begin, end)
    else:
        rows = np.arange(len(begin)) if wanted is None else np.flatnonzero(wanted[::step])
        values = np.full(operands[0].shape, algebra.bottom)
        for pairs in until_pairs(algebra, operands[0], operands[1], begin, end, rows):
            values[pairs.rows] = pairs.result
    return values[::step]


def wanted_samples(nodes: Sequence[Node], roots: Sequence[int], grid: Grid, at: int) -> dict[int, Bools]:
    """Find the samples of each formula that the roots depend on at one sample; not in the paper.

    Returns: for each formula below the roots a mask, (n_samples,).
    """
    n = len(grid)
    wanted = {root: np.arange(n) == at for root in roots}
    for index in reversed(needed_nodes(nodes, roots)):
        node = nodes[index]
        if node.op in REAL or node.op in COMPARISONS:
            continue
        step = -1 if node.op in PAST else 1
        mask = wanted[index][::step]
        if node.interval is not None:
            _, begin, end = facing(node, (), grid)
            rows = np.flatnonzero(mask)
            mask = _union(rows if len(node.children) == 2 else begin[rows], end[rows], n)
        elif node.op in ("next", "prev"):
            mask = np.concatenate([[False], mask[:-1]])
        for child in node.children:
            wanted[child] = mask[::step] | wanted.get(child, np.zeros(n, dtype=np.bool_))
    return wanted


def _union(begin: Ints, end: Ints, n: int) -> Bools:
    """Return the mask of all ranges [begin, end), (n,)."""
    opened, closed = np.bincount(begin, minlength=n + 1), np.bincount(end, minlength=n + 1)
    return np.asarray(np.cumsum(opened - closed)[:n] > 0)


def operation_of(algebra: Algebra, node: Node) -> tuple[Operation, float]:
    """Return what a unary temporal operator folds with, and its neutral element."""
    if node.op in ("always", "historically"):
        return algebra.meet, algebra.top
    return algebra.join, algebra.bottom


def facing(node: Node, operands: Sequence[Floats], grid: Grid) -> tuple[list[Floats], Ints, Ints]:
    """Return operands and windows of a temporal operator as seen in the direction in which it looks."""
    assert node.interval is not None
    if node.op in PAST:
        return [o[::-1] for o in operands], *index_windows(grid.reversed(), node.interval)
    return list(operands), *index_windows(grid, node.interval)
