"""Enclosures at every sample of a stretch, for any formula: the interval semantics over arrays.

In: the values of settled formulas at some samples. Out: for each wanted formula three columns, its low end, its
high end, and its value if the trace ended here. Windows over known samples are the offline kernels, three
columns at a time; where a window is still open, the tail of the operand is then taken in. One column
stands for all three as long as nothing under it is open.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import Node
from stlspec.compiler.ranges import INF, Range
from stlspec.semantics import windows
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.windows import Grid

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LOW, HIGH, CURRENT = 0, 1, 2


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
) -> dict[int, Floats]:
    """Enclose formulas at every sample of a stretch.

    Not in the paper: it evaluates complete traces only.

    Args:    span: the samples. inputs, others: from `needed`. columns: values of the inputs, (n_samples,) each.
             Past operators over formulas that are not settled see this stretch only.
    Returns: by node (n_samples, 3) with columns low, high and current, or (n_samples, 1) if these are equal.
    """
    found = {index: column[:, None] for index, column in zip(inputs, columns, strict=True)}
    for index in others:
        node = span.plan.nodes[index]
        operands = [found[c] for c in node.children]
        found[index] = _formula(span, node, operands, [span.plan.tails[c] for c in node.children])
    return found


def three(values: Floats) -> Floats:
    """Return the three columns, spelled out; a copy."""
    return np.repeat(values, 3, axis=1) if values.shape[1] == 1 else values.copy()


def _formula(span: Stretch, node: Node, operands: list[Floats], tails: list[Range]) -> Floats:
    op = node.op
    if op == "not":
        values = -operands[0]
        return values if values.shape[1] == 1 else np.ascontiguousarray(values[:, [HIGH, LOW, CURRENT]])
    if op in ("and", "or"):
        extremum = np.minimum if op == "and" else np.maximum
        values = operands[0]
        for operand in operands[1:]:
            values = extremum(values, operand)
        return values
    if op == "next":
        return _next(span, operands[0], tails[0])
    if op == "prev":
        return np.concatenate((np.full((1, operands[0].shape[1]), -INF), operands[0][:-1]))
    assert node.interval is not None
    if op in ("always", "eventually"):
        return _window(span, node, operands[0], tails[0])
    if op == "until":
        return _until(span, node, operands, tails)
    if op == "since":
        columns = max(x.shape[1] for x in operands)
        left, right = (x if x.shape[1] == columns else three(x) for x in operands)
        return windows.since(left, right, span.grid, node.interval)
    past = windows.historically if op == "historically" else windows.once
    return past(operands[0], span.grid, node.interval)


def _next(span: Stretch, values: Floats, tail: Range) -> Floats:
    beyond = [[tail[0] if span.plan.certain else -INF, tail[1], -INF]]
    return np.concatenate((three(values[1:]), beyond))


def open_from(span: Stretch, high: int | None) -> int:
    """Return the first sample whose window, ending `high` ticks ahead, may hold samples to come."""
    if high is None:
        return 0
    return int(np.searchsorted(span.grid.times, span.last - high, side="right"))


def _window(span: Stretch, node: Node, values: Floats, tail: Range) -> Floats:
    assert node.interval is not None
    first = open_from(span, node.interval[1])
    kernel = windows.always if node.op == "always" else windows.eventually
    found = kernel(values, span.grid, node.interval)
    if first == len(found):
        return found
    found = three(found)
    extremum = np.minimum if node.op == "always" else np.maximum
    # The bound that samples to come can only worsen counts possible ones too, the other one certain ones only.
    sides = (LOW, HIGH) if span.plan.certain else (LOW,) if node.op == "always" else (HIGH,)
    for side in sides:
        extremum(found[first:, side], tail[side], out=found[first:, side])
    return found


def _until(span: Stretch, node: Node, operands: list[Floats], tails: list[Range]) -> Floats:
    """Enclose until: the first sample to come in the window is the best of those, as far as one can know."""
    assert node.interval is not None
    low, high = node.interval
    columns = max(x.shape[1] for x in operands)
    left, right = (x if x.shape[1] == columns else three(x) for x in operands)
    found = windows.until(left, right, span.grid, node.interval)
    first = open_from(span, high)
    if first == len(found):
        return found
    found = three(found)
    held = windows.always(left, span.grid, (0, None))[first:]
    late = span.grid.times[first:] > span.last + span.plan.stride - low if span.plan.dense else None
    for side in (LOW, HIGH) if span.plan.certain else (HIGH,):
        branch = np.minimum(held[:, min(side, columns - 1)], tails[1][side])
        if late is not None:
            np.minimum(branch, tails[0][side], out=branch, where=late)
        np.maximum(found[first:, side], branch, out=found[first:, side])
    return found
