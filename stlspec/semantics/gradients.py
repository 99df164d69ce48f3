"""How the robustness at sample 0 changes with every sample of every signal.

In: a compiled spec, a trace or many, a requirement, an algebra. Out: a derivative for each sample of each real
signal. In min/max one predicate at one sample decides the value, the witness, and it alone has a derivative; in
a smooth algebra many samples have one, found by reverse accumulation over the formula DAG.

Where a derivative is not unique: |f| at 0, hypot at (0, 0), `==` and `!=` on their bound give 0; `min` and `max`
of equal operands, that of the first. Where it is infinite, so is the result: sqrt at 0, log at 0, division by 0.
Where there is none, it is nan: the exponent of a negative base. Boolean signals have no derivative.
"""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stlspec.compiler.bundle import BundleData, Requirement
from stlspec.compiler.ir import COMPARISONS, PAST, REAL, Node
from stlspec.errors import UsageError, diagnostic
from stlspec.semantics.algebra import MIN_MAX, Algebra, checked, refusal
from stlspec.semantics.folds import (
    Step,
    all_values,
    facing,
    fold_windows,
    operation_of,
    unfold_until,
    unfold_windows,
)
from stlspec.semantics.layout import arrange
from stlspec.semantics.robustness import evaluate_nodes, needed_nodes
from stlspec.semantics.slopes import operand_slopes, times
from stlspec.semantics.windows import Grid
from stlspec.semantics.witness import decide
from stlspec.traces import Trace, make_trace

Floats = NDArray[np.float64]


def gradient(
    bundle: BundleData,
    signals: Mapping[str, ArrayLike | Sequence[ArrayLike]],
    time: ArrayLike | Sequence[ArrayLike] | None = None,
    requirement: str | None = None,
    algebra: Algebra = MIN_MAX,
    file: str | None = None,
) -> dict[str, Any]:
    """Differentiate the robustness of a requirement at sample 0.

    Not in the paper, whose learner needs values only.

    Args:
        bundle: the compiled spec.
        signals, time, file: as `evaluation.evaluate`.
        requirement: its name; None: the only one there is.
        algebra: `MIN_MAX`: a subgradient at the witness; `log_sum_exp(T)` or another one with slopes.

    Returns: for each real signal that the data has d robustness / d sample, (n_samples,); for many traces
        (n_traces, n_samples), a list of (n_samples,) if they are of unequal length.

    Raises:
        DataError: the signals cannot be used, or an expression has no value.
        UsageError: there is no such requirement, or the algebra has no slopes.
    """
    _check_slopes(checked(algebra))
    root = _named(bundle, requirement).root
    used = {str(node.value) for node in bundle.nodes if node.op in ("signal", "bool")}
    layout = arrange([s.name for s in bundle.signals], signals, time, file)
    names = [s.name for s in bundle.signals if s.type == "real" and s.name in signals]
    found: dict[int, dict[str, Floats]] = {}
    for g in layout.groups:
        trace = make_trace(bundle.time, bundle.signals, g.signals, g.time, required=used, numbers=g.numbers, file=file)
        if trace.numbers is None:
            return trace_gradient(bundle.nodes, root, trace, names, algebra)
        for column, number in enumerate(trace.numbers):
            found[number] = trace_gradient(bundle.nodes, root, _single(trace, column), names, algebra)
    rows = {name: [found[number][name] for number in sorted(found)] for name in names}
    return rows if layout.ragged else {name: np.stack(of_name) for name, of_name in rows.items()}


def trace_gradient(
    nodes: Sequence[Node], root: int, trace: Trace, names: Sequence[str], algebra: Algebra = MIN_MAX
) -> dict[str, Floats]:
    """Differentiate a formula at sample 0 of one trace that was made before.

    Not in the paper, as `gradient`.

    Args:    nodes: the DAG. root: of a formula. names: of real signals of the trace. algebra: as `gradient`.
    Returns: for each name (n_samples,).
    """
    reals = [i for i in needed_nodes(nodes, [root]) if nodes[i].op in REAL]
    values = dict(zip(reals, evaluate_nodes(nodes, reals, trace), strict=True))
    with np.errstate(all="ignore"):
        if algebra.slopes is None:
            cotangents = _of_witness(nodes, root, trace, values)
        else:
            cotangents = _of_formulas(nodes, root, trace, algebra)
        result = {name: np.zeros(trace.n_samples) for name in names}
        for index in reversed(reals):
            node, cotangent = nodes[index], cotangents.get(index)
            if cotangent is not None and node.op == "signal":
                result[str(node.value)] += cotangent
            elif cotangent is not None and node.children:
                operands = [values[c] for c in node.children]
                slopes = operand_slopes(node, operands, values[index], cotangent, trace)
                _hand(cotangents, node.children, slopes)
    return result


def _of_witness(nodes: Sequence[Node], root: int, trace: Trace, values: Mapping[int, Floats]) -> dict[int, Floats]:
    """Return the derivatives of the deciding predicate with respect to its sides, at the deciding sample."""
    decision, found = decide(nodes, root, trace, 0), dict[int, Floats]()
    predicate, sample = int(decision.predicates[0]), int(decision.samples[0])
    if sample >= 0 and nodes[predicate].op in COMPARISONS:
        cotangent = np.zeros(trace.n_samples)
        cotangent[sample] = -1.0 if decision.negated[0] else 1.0
        _hand(found, nodes[predicate].children, _of_distance(nodes[predicate], values, cotangent))
    return found


def _of_formulas(nodes: Sequence[Node], root: int, trace: Trace, algebra: Algebra) -> dict[int, Floats]:
    """Accumulate backwards from the root to the sides of all predicates."""
    values = all_values(algebra, nodes, [root], trace, at=0)
    grid = Grid(trace.ticks, trace.spacing)
    start = np.zeros(trace.n_samples)
    start[0] = 1.0
    cotangents = {root: start}
    for index in sorted(values, reverse=True):
        node, cotangent = nodes[index], cotangents.get(index)
        if cotangent is None or node.op in REAL or not node.children:
            continue
        operands = [values[c] for c in node.children]
        if node.op in COMPARISONS:
            slopes = _of_distance(node, values, cotangent)
        elif node.interval is not None:
            slopes = _of_windows(algebra, node, operands, cotangent, grid)
        else:
            slopes = _of_sample(algebra, node, operands, values[index], cotangent)
        _hand(cotangents, node.children, slopes)
    return cotangents


def _hand(cotangents: dict[int, Floats], children: Sequence[int], slopes: Sequence[Floats]) -> None:
    """Add to the derivatives with respect to some nodes."""
    for child, towards in zip(children, slopes, strict=True):
        before = cotangents.get(child)
        cotangents[child] = towards if before is None else before + towards


def _of_distance(node: Node, values: Mapping[int, Floats], cotangent: Floats) -> list[Floats]:
    """Differentiate the signed distance of a comparison: left - right and the like."""
    if node.op in ("eq", "ne"):
        side = np.sign(values[node.children[0]] - values[node.children[1]])
        # The difference of equal infinities is no number; the distance there is 0, as on any bound.
        side = np.nan_to_num(side, nan=0.0)
        cotangent = cotangent * (side if node.op == "ne" else -side)
    return [-cotangent, cotangent] if node.op in ("lt", "le") else [cotangent, -cotangent]


def _of_sample(
    algebra: Algebra, node: Node, operands: Sequence[Floats], values: Floats, cotangent: Floats
) -> list[Floats]:
    """Differentiate a formula that looks at one sample of its operands only."""
    if node.op == "not":
        return [-cotangent]
    if node.op in ("and", "or"):
        assert algebra.slopes is not None
        slope = algebra.slopes[node.op == "and"]
        return [times(cotangent, slope(operand, values)) for operand in operands]
    found = np.zeros(len(cotangent))
    if node.op == "next":
        found[1:] = cotangent[:-1]
    else:
        found[:-1] = cotangent[1:]
    return [found]


def _of_windows(
    algebra: Algebra, node: Node, operands: Sequence[Floats], cotangent: Floats, grid: Grid
) -> list[Floats]:
    """Differentiate a bounded temporal operator; the past ones are seen backwards in time."""
    assert algebra.slopes is not None
    operands, begin, end = facing(node, operands, grid)
    step = -1 if node.op in PAST else 1
    cotangent = cotangent[::step]
    if len(operands) == 2:
        found = unfold_until(algebra, operands[0], operands[1], begin, end, cotangent)
        return [f[::step] for f in found]
    operation, neutral = operation_of(algebra, node)
    steps: list[Step] = []
    # Only the windows whose value counts are folded again.
    _, tables = fold_windows(operation, neutral, operands[0], begin, np.where(cotangent == 0, begin, end), steps)
    slope = algebra.slopes[operation is algebra.meet]
    return [unfold_windows(slope, tables, steps, cotangent)[::step]]


def _named(bundle: BundleData, name: str | None) -> Requirement:
    known = {r.name: r for r in bundle.requirements}
    if name is None and len(known) == 1:
        return next(iter(known.values()))
    if name in known:
        return known[name]
    close = difflib.get_close_matches(str(name), known, n=1)
    way_out = f"did you mean '{close[0]}'?" if close else f"name one of {', '.join(list(known)[:5]) or 'none'}"
    what = "the spec has several requirements" if name is None else f"there is no requirement '{name}'"
    raise UsageError([diagnostic("D880", what=what, help=way_out)])


def _single(trace: Trace, column: int) -> Trace:
    """Take one trace out of a batch."""
    columns = {name: values[:, column].copy() for name, values in trace.signals.items()}
    return replace(trace, signals=MappingProxyType(columns), numbers=None)


def _check_slopes(algebra: Algebra) -> None:
    min_max = "lattice" in algebra.laws and algebra.embed is None
    plain = algebra.slopes is not None and algebra.embed is None and algebra.negate is np.negative
    if not (min_max or plain):
        raise refusal(f"the algebra '{algebra.name}' has no derivative", "use MIN_MAX, log_sum_exp or give `slopes`")
