"""Evaluate a compiled spec on recorded signals.

In: a `BundleData`, signals, time stamps. Out: an immutable `Evaluation`, a mapping from the names of the
requirements to results. The values of all samples are computed at once; witnesses are looked for when they
are first asked for, from the result's own copy of the signals, so that the answer cannot change.
"""

import operator
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Any, Generic, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stlspec.compiler.bundle import BundleData, TimeBase
from stlspec.compiler.ir import Node
from stlspec.compiler.passes import optimised
from stlspec.compiler.printing import number_text
from stlspec.compiler.rates import written_unit
from stlspec.errors import DataError, UsageError, diagnostic
from stlspec.markup.charts import robustness_svg
from stlspec.markup.elements import Markup
from stlspec.markup.figures import standalone
from stlspec.semantics.algebra import MIN_MAX, Algebra, checked
from stlspec.semantics.folds import evaluate_in, evaluate_in_at, is_lattice, lattice_elements
from stlspec.semantics.layout import arrange
from stlspec.semantics.memory import keep_freed_memory
from stlspec.semantics.reach import bounded_reach
from stlspec.semantics.reasons import CONSTANT, VACUOUS, reason_text
from stlspec.semantics.robustness import batches, evaluate_at, evaluate_nodes
from stlspec.semantics.witness import Decision, decide
from stlspec.traces import Trace, make_trace

Floats = NDArray[np.float64]
End = Literal["clip", "strict"]
"""What `end` may be; other texts are refused when a call is made."""
Result = TypeVar("Result", covariant=True)


class Verdict(StrEnum):
    """Whether a requirement holds; undecided only where the trace may go on."""

    SATISFIED = "satisfied"
    VIOLATED = "violated"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Witness:
    """The sample of the predicate that decides a verdict.

    time: of the sample, in the spec's unit. predicate: index of its node. reason: its values in one line.
    """

    sample: int
    time: float
    predicate: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Origin:
    """What a result was computed from: a requirement's root, the trace or batch, the reported sample."""

    nodes: tuple[Node, ...]
    root: int
    trace: Trace
    at: int
    algebra: Algebra = MIN_MAX
    bundle: BundleData | None = None

    def decisions(self) -> list[Decision]:
        """Look for what decides the value; a batch in parts of bounded size."""
        parts = [self.trace] if self.trace.numbers is None else [p for _, p in batches(self.trace)]
        return [decide(self.nodes, self.root, part, self.at) for part in parts]

    def signal(self) -> Floats:
        """Return the robustness of a batch at every sample, ties as 0, (n_traces, n_samples)."""
        signal = np.empty((self.trace.n_traces, self.trace.n_samples))
        for first, part in batches(self.trace):
            (values,) = evaluate_in(self.algebra, self.nodes, [self.root], part)
            signal[first : first + part.n_traces] = values.T
        return _frozen(signal)


def _frozen(values: NDArray[Any]) -> NDArray[Any]:
    values.flags.writeable = False
    return values


@dataclass(frozen=True, eq=False)
class RequirementResult:
    """One requirement on one trace: its robustness and verdict at the reported sample.

    values: the robustness at every sample in min/max, whatever the algebra, ties told apart as
    `robustness.TIE` says. low, high: enclose the robustness over every way the trace can go on, where that was
    asked for (`ending.evaluate_ending`), else None.
    """

    robustness: float
    verdict: Verdict
    origin: Origin = field(repr=False)
    values: Floats = field(repr=False)
    low: float | None = None
    high: float | None = None

    @cached_property
    def signal(self) -> Floats:
        """Robustness at every sample in the algebra that was asked for, (n_samples,)."""
        origin = self.origin
        if is_lattice(origin.algebra):
            return _frozen(lattice_elements(origin.algebra, self.values))
        return _frozen(evaluate_in(origin.algebra, origin.nodes, [origin.root], origin.trace)[0])

    @cached_property
    def witness(self) -> Witness | None:
        """The deciding sample; None if the value comes from no predicate."""
        decision, origin = self._decision, self.origin
        sample, predicate = int(decision.samples[0]), int(decision.predicates[0])
        if sample < 0:
            return None
        written = None if origin.bundle is None else written_unit(origin.bundle, predicate)
        reason = reason_text(origin.nodes, predicate, bool(decision.negated[0]), origin.trace, sample, written)
        return Witness(sample, origin.trace.time(sample), predicate, reason)

    @cached_property
    def vacuous(self) -> bool:
        """Whether the value comes from an empty window or from beyond an end of the trace."""
        return bool(np.isinf(self.values[self.origin.at])) and bool(self._decision.vacuous[0])

    def _repr_svg_(self) -> str:
        """Show the robustness over time in a notebook."""
        return standalone(self.chart("robustness"))

    def chart(self, name: str) -> Markup:
        """Draw the robustness over time under a name, as `markup.charts.robustness_svg` does."""
        trace = self.origin.trace
        times = np.array([trace.time(k) for k in range(trace.n_samples)])
        unit = "" if trace.unit == "step" else trace.unit
        at, verdict = float(times[self.origin.at]), self.verdict.value
        return robustness_svg(name, times, self.signal, verdict, at, self.robustness, unit, self.vacuous)

    @property
    def reason(self) -> str:
        """Why the requirement has its value, in one line."""
        if self.witness is not None:
            return self.witness.reason
        return VACUOUS if self.vacuous else CONSTANT

    @cached_property
    def _decision(self) -> Decision:
        return self.origin.decisions()[0]


@dataclass(frozen=True, eq=False)
class BatchResult:
    """One requirement on many traces.

    robustness: (n_traces,). satisfied: bool, (n_traces,). origins: one for each group of traces with common
    times. ragged: the traces came as a list of unequal lengths.
    """

    robustness: Floats
    satisfied: NDArray[np.bool_]
    origins: tuple[Origin, ...] = field(repr=False)
    ragged: bool = field(default=False, repr=False)

    @cached_property
    def signal(self) -> Floats | list[Floats]:
        """Robustness at every sample, (n_traces, n_samples); a list of (n_samples,) for ragged input."""
        signals = [origin.signal() for origin in self.origins]
        if len(signals) == 1 and not self.ragged:
            return signals[0]
        rows: dict[int, Floats] = {}
        for origin, signal in zip(self.origins, signals, strict=True):
            rows.update(zip(origin.trace.numbers or (), signal, strict=True))
        ordered = [rows[number] for number in range(len(rows))]
        return ordered if self.ragged else _frozen(np.stack(ordered))

    @cached_property
    def witness_sample(self) -> NDArray[np.int64]:
        """The deciding sample of each trace, (n_traces,); -1 if the value comes from no predicate."""
        return self._scattered([d.samples for d in self._decisions])

    @cached_property
    def vacuous(self) -> NDArray[np.bool_]:
        """Whether each trace's value comes from an empty window or from beyond an end, (n_traces,)."""
        return self._scattered([d.vacuous for d in self._decisions])

    @cached_property
    def _decisions(self) -> list[Decision]:
        return [decision for origin in self.origins for decision in origin.decisions()]

    def _scattered(self, pieces: Sequence[NDArray[Any]]) -> NDArray[Any]:
        return _frozen(_in_order([origin.trace for origin in self.origins], np.concatenate(pieces)))


class Evaluation(Mapping[str, Result], Generic[Result]):
    """The results of all requirements by name, in the order of the spec; immutable."""

    __slots__ = ("_results",)

    def __init__(self, results: Mapping[str, Result]) -> None:
        self._results = dict(results)

    def __getitem__(self, name: str) -> Result:
        return self._results[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._results)

    def __len__(self) -> int:
        return len(self._results)

    def __repr__(self) -> str:
        return f"Evaluation({self._results!r})"


def evaluate(
    bundle: BundleData,
    signals: Mapping[str, ArrayLike | Sequence[ArrayLike]],
    time: ArrayLike | Sequence[ArrayLike] | None = None,
    end: str = "clip",
    at: int = 0,
    file: str | None = None,
    algebra: Algebra = MIN_MAX,
) -> Evaluation[Any]:
    """Evaluate all requirements on one trace or on many.

    Paper: robustness of STL; the verdict is the Boolean semantics.

    Args:
        bundle: the compiled spec.
        signals: for each signal (n_samples,) values for one trace; (n_traces, n_samples), or a list of
            n_traces sequences of unequal length, for many.
        time: time stamps in the spec's unit, (n_samples,), or one sequence for each trace.
        end: "clip" reads a trace as a complete episode; "strict" refuses one shorter than a horizon.
        at: the sample whose value is reported; negative counts from the end.
        file: where the data come from, for messages.
        algebra: what `robustness` and `signal` are computed in; verdicts, witnesses and `vacuous` are those of
            min/max in every algebra.

    Returns: a `RequirementResult` for each requirement; for many traces a `BatchResult`.

    Raises:
        DataError: the signals cannot be used, an expression has no value, or a trace is too short.
        UsageError: `end`, `at` or `algebra` is not possible.
    """
    _check_end(end)
    checked(algebra)
    keep_freed_memory()
    used = {str(node.value) for node in bundle.nodes if node.op in ("signal", "bool")}
    layout = arrange([s.name for s in bundle.signals], signals, time, file)
    traces = [
        make_trace(bundle.time, bundle.signals, g.signals, g.time, required=used, numbers=g.numbers, file=file)
        for g in layout.groups
    ]
    if traces and traces[0].numbers is None:
        return evaluate_trace(bundle, traces[0], end, at, algebra)
    return _evaluate_batch(bundle, traces, layout.ragged, end, at, algebra)


def evaluate_trace(
    bundle: BundleData, trace: Trace, end: str = "clip", at: int = 0, algebra: Algebra = MIN_MAX
) -> Evaluation[RequirementResult]:
    """Evaluate all requirements on one trace that was made before; else as `evaluate`."""
    _check_end(end)
    checked(algebra)
    keep_freed_memory()
    sample = _sample(trace, at)
    if end == "strict":
        check_length(bundle, _remaining(trace, sample), trace.file)
    roots = [r.root for r in bundle.requirements]
    exact = evaluate_nodes(*optimised(bundle.nodes, roots, MIN_MAX.laws, trace.spacing), trace)
    robustness = (
        lattice_elements(algebra, np.array([values[sample] for values in exact]))
        if is_lattice(algebra)
        else evaluate_in_at(algebra, bundle.nodes, roots, trace, sample)
    )
    results = {}
    for r, values, value in zip(bundle.requirements, exact, robustness, strict=True):
        verdict = Verdict.SATISFIED if values[sample] > 0 else Verdict.VIOLATED
        origin = Origin(bundle.nodes, r.root, trace, sample, algebra, bundle)
        results[r.name] = RequirementResult(float(value), verdict, origin, _frozen(values))
    return Evaluation(results)


def _evaluate_batch(
    bundle: BundleData, traces: Sequence[Trace], ragged: bool, end: str, at: int, algebra: Algebra
) -> Evaluation[BatchResult]:
    samples = [_sample(trace, at) for trace in traces]
    if end == "strict":
        for trace, sample in zip(traces, samples, strict=True):
            check_length(bundle, _remaining(trace, sample), trace.file)
    roots = [r.root for r in bundle.requirements]
    pairs = list(zip(traces, samples, strict=True))
    exact = _gathered(
        traces, [evaluate_at(*optimised(bundle.nodes, roots, MIN_MAX.laws, t.spacing), t, s) for t, s in pairs]
    )
    robustness = (
        lattice_elements(algebra, exact)
        if is_lattice(algebra)
        else _gathered(traces, [_at(algebra, bundle.nodes, roots, t, s) for t, s in pairs])
    )
    results = {}
    for number, requirement in enumerate(bundle.requirements):
        origins = tuple(Origin(bundle.nodes, requirement.root, t, s, algebra, bundle) for t, s in pairs)
        satisfied = _frozen(exact[number] > 0)
        results[requirement.name] = BatchResult(_frozen(robustness[number].copy()), satisfied, origins, ragged)
    return Evaluation(results)


def _at(algebra: Algebra, nodes: Sequence[Node], roots: Sequence[int], trace: Trace, sample: int) -> Floats:
    """Evaluate a batch at one sample in an algebra that is no lattice, (n_roots, n_traces)."""
    return np.concatenate([evaluate_in_at(algebra, nodes, roots, p, sample) for _, p in batches(trace)], axis=1)


def _gathered(traces: Sequence[Trace], parts: Sequence[Floats]) -> Floats:
    """Join (n_roots, n_traces) of each group of traces, in the order of the traces."""
    return _in_order(traces, np.concatenate(parts, axis=1))


def _in_order(traces: Sequence[Trace], values: NDArray[Any]) -> NDArray[Any]:
    """Bring values, one for each trace along the last axis, into the order of the traces' numbers."""
    numbers = [number for trace in traces for number in trace.numbers or ()]
    return values[..., np.argsort(numbers)]


def _sample(trace: Trace, at: int) -> int:
    n = trace.n_samples
    try:
        at = operator.index(at)
    except TypeError:
        raise UsageError([diagnostic("D880", what=f"at={at!r}"[:40], help=f"use {-n} to {n - 1}")]) from None
    if not -n <= at < n:
        what = f"there is no sample {at}: the trace has {n}"
        raise UsageError([diagnostic("D880", what=what, help=f"use {-n} to {n - 1}")])
    return at % n


def _check_end(end: str) -> None:
    if end not in ("clip", "strict"):
        raise UsageError([diagnostic("D880", what=f"end={end!r}", help="use clip or strict")])


def _remaining(trace: Trace, sample: int) -> int:
    return int(trace.ticks[-1]) - int(trace.ticks[sample])


def check_length(bundle: BundleData, length: int, file: str | None) -> None:
    """Refuse a trace that ends before the horizon of a requirement.

    Not in the paper: it evaluates complete episodes only.

    Args:   length: ticks from the reported sample to the last one.
    Raises: DataError D809.
    """
    reach = bounded_reach(bundle.nodes, bundle.time)
    errors = [
        diagnostic(
            "D809",
            file=file,
            requirement=r.name,
            length=_duration(length, bundle.time),
            horizon=_duration(reach[r.root], bundle.time),
        )
        for r in bundle.requirements
        if reach[r.root] > length
    ]
    if errors:
        raise DataError(errors)


def _duration(ticks: int, base: TimeBase) -> str:
    count = number_text(ticks / base.ticks_per_unit)
    plural = "s" if base.unit == "step" and ticks != 1 else ""
    return f"{count} {base.unit}{plural}"
