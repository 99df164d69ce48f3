"""Enclosures at every sample of a stretch, for any formula: the interval semantics over arrays.

In: the values of settled formulas at some samples. Out: for each wanted formula three columns, its low end, its
high end, and its value if the trace ended here. Windows over known samples are the offline kernels; where a
window is still open, the tail of the operand is then taken in. Columns that are equal are one array, and what is
computed of one array is computed once.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import Interval, Node
from stlspec.compiler.ranges import INF, Range
from stlspec.semantics import windows
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.windows import Grid

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LOW, HIGH = 0, 1

Columns = tuple[Floats, Floats, Floats]
"""low, high and current of a formula, (n_samples,) each; not to be written to."""


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """Which samples: their times in ticks, strictly increasing, the last one the newest."""

    grid: Grid
    plan: Plan

    @property
    def last(self) -> int:
        """Time of the newest sample."""
        return int(self.grid.times[-1])


def needed(plan: Plan, roots: Sequence[int]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return what enclosures of `roots` take: the settled formulas to be known, and the others, children first.

    Not in the paper: it serves `enclosures`.
    """
    inputs: set[int] = set()
    others: set[int] = set()
    stack = list(roots)
    while stack:
        index = stack.pop()
        if plan.settled[index]:
            inputs.add(index)
        elif index not in others:
            others.add(index)
            stack += plan.nodes[index].children
    return tuple(sorted(inputs)), tuple(sorted(others))


def stretch(plan: Plan, times: Ints) -> Stretch:
    """Name the samples at `times`; evenly spaced ones have the faster kernels."""
    spacing = None
    if plan.base.kind != "stamps" and int(times[-1]) - int(times[0]) == (len(times) - 1) * plan.stride:
        spacing = plan.stride
    return Stretch(Grid(times, spacing if len(times) > 1 else 1), plan)


def enclosures(
    span: Stretch, inputs: Sequence[int], others: Sequence[int], columns: Sequence[Floats]
) -> dict[int, Columns]:
    """Enclose formulas at every sample of a stretch.

    Not in the paper: it evaluates complete traces only.

    Args:    span: the samples. inputs, others: from `needed`. columns: values of the inputs, (n_samples,) each.
             Past operators over formulas that are not settled see this stretch only.
    Returns: by node low, high and current.
    """
    found = {index: (column, column, column) for index, column in zip(inputs, columns, strict=True)}
    for index in others:
        node = span.plan.nodes[index]
        operands = [found[c] for c in node.children]
        found[index] = _formula(span, node, operands, [span.plan.tails[c] for c in node.children])
    return found


def three(columns: Columns, first: int = 0) -> Floats:
    """Return the columns side by side from a sample on, (n_samples, 3)."""
    return np.stack([column[first:] for column in columns], axis=1)


def _each(operands: Sequence[Columns], compute: Callable[..., Floats]) -> Columns:
    """Compute each column from those of the operands, equal ones once."""
    made: dict[tuple[int, ...], Floats] = {}
    found = []
    for columns in zip(*operands, strict=True):
        key = tuple(id(column) for column in columns)
        if key not in made:
            made[key] = compute(*columns)
        found.append(made[key])
    return found[0], found[1], found[2]


def _formula(span: Stretch, node: Node, operands: list[Columns], tails: list[Range]) -> Columns:
    op = node.op
    if op == "not":
        low, high, current = _each(operands, np.negative)
        return high, low, current
    if op in ("and", "or"):
        extremum = np.minimum if op == "and" else np.maximum
        values = operands[0]
        for operand in operands[1:]:
            values = _each([values, operand], extremum)
        return values
    if op == "next":
        return _next(span, operands[0], tails[0])
    if op == "prev":
        return _each(operands, lambda values: np.concatenate(([-INF], values[:-1])))
    interval = node.interval
    assert interval is not None
    if op in ("always", "eventually"):
        return _window(span, node, operands[0], tails[0])
    if op == "until":
        return _until(span, interval, operands, tails)
    if op == "since":
        return _each(operands, lambda left, right: windows.since(left, right, span.grid, interval))
    past = windows.historically if op == "historically" else windows.once
    return _each(operands, lambda values: past(values, span.grid, interval))


def _next(span: Stretch, columns: Columns, tail: Range) -> Columns:
    beyond = (tail[0] if span.plan.certain else -INF, tail[1], -INF)
    low, high, current = (np.append(values[1:], x) for values, x in zip(columns, beyond, strict=True))
    return low, high, current


def open_from(span: Stretch, high: int | None) -> int:
    """Return the first sample whose window, ending `high` ticks ahead, may hold samples to come."""
    if high is None:
        return 0
    return int(np.searchsorted(span.grid.times, span.last - high, side="right"))


def _window(span: Stretch, node: Node, columns: Columns, tail: Range) -> Columns:
    interval = node.interval
    assert interval is not None
    first, always = open_from(span, interval[1]), node.op == "always"
    kernel, extremum = (windows.always, np.minimum) if always else (windows.eventually, np.maximum)
    made: dict[int, Floats] = {}

    def known(values: Floats) -> Floats:
        if id(values) not in made:
            made[id(values)] = kernel(values, span.grid, interval)
        return made[id(values)]

    def with_tail(values: Floats, bound: float) -> Floats:
        if bound != (-INF if always else INF):
            found = known(values).copy()
            extremum(found[first:], bound, out=found[first:])
            return found
        # Nothing is known of the open ones: windows of the others are all that is slid over.
        found = np.full(len(values), bound)
        if first:
            found[:first] = (
                known(values)[:first] if id(values) in made else kernel(values, span.grid, interval, found[:first])
            )
        return found

    low, high, current = columns
    current = known(current)
    if first == len(current):
        return known(low), known(high), current
    # The bound that samples to come can only worsen counts possible ones too, the other one certain ones only.
    certain = span.plan.certain
    return (
        with_tail(low, tail[LOW]) if always or certain else known(low),
        with_tail(high, tail[HIGH]) if not always or certain else known(high),
        current,
    )


def _until(span: Stretch, interval: Interval, operands: list[Columns], tails: list[Range]) -> Columns:
    """Enclose until: the first sample to come in the window is the best of those, as far as one can know."""
    low, high = interval
    found = _each(operands, lambda left, right: windows.until(left, right, span.grid, interval))
    first = open_from(span, high)
    if first == len(found[LOW]):
        return found
    late = span.grid.times[first:] > span.last + span.plan.stride - low if span.plan.dense else None
    held = _each(operands[:1], lambda left: windows.always(left, span.grid, (0, None)))

    def with_branch(side: int) -> Floats:
        branch = np.minimum(held[side][first:], tails[1][side])
        if late is not None:
            np.minimum(branch, tails[0][side], out=branch, where=late)
        result = found[side].copy()
        np.maximum(result[first:], branch, out=result[first:])
        return result

    return with_branch(LOW) if span.plan.certain else found[LOW], with_branch(HIGH), found[2]
