"""Explanations: why a requirement has its value on a trace, and what would turn the verdict round.

In: a compiled spec and the result of one requirement on one trace. Out: an `Explanation`: the sub-formulas from
the requirement down to the predicate that decides, its operands and signals, where else it is wrong, and a
change that was tried. Everything follows from the result, which holds its own copy of the signals, so the same
result is explained the same way whenever it is asked.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import COMPARISONS, REAL, Node
from stlspec.compiler.notation import formula_texts
from stlspec.compiler.printing import expression_text
from stlspec.compiler.rates import written_unit
from stlspec.errors import UsageError, diagnostic
from stlspec.semantics.chains import Link, Values, bearing_samples, find_chain, values_below
from stlspec.semantics.changes import Change
from stlspec.semantics.evaluation import RequirementResult, Verdict
from stlspec.semantics.flips import Flip, find_flip
from stlspec.semantics.relaxation import signal_nodes
from stlspec.semantics.robustness import evaluate_nodes, shown
from stlspec.traces import Trace, make_trace

Range = tuple[int, int]
"""Samples from the first to the last, both included."""

_LONGEST_LIST = 5


@dataclass(frozen=True, slots=True)
class Step:
    """A sub-formula on the way from the requirement to what decides it.

    text: in the language's notation. name: of the let that it is, if it is one. sample: at which it is taken;
    time: of that sample, in the spec's unit. robustness: its own there; under a negation it has the other sign.
    """

    text: str
    name: str | None
    sample: int
    time: float
    robustness: float


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why a requirement has its value.

    sample: the one that the value is asked for, usually 0. decided_by: a predicate; or an empty window
    ("vacuous"); or a constant. steps: from the requirement to what decides. reason: the predicate's values and
    what is needed of them. operands: the sides of the predicate, text and value. signals: those in the
    predicate, values at the deciding sample. violations: where a violated requirement's deciding predicate is
    wrong, among the samples that matter. flip: a change that turns the verdict round; None if undecided.
    """

    requirement: str
    strength: str
    verdict: Verdict
    robustness: float
    sample: int
    n_samples: int
    unit: str
    decided_by: Literal["predicate", "vacuous", "constant"]
    steps: tuple[Step, ...]
    reason: str
    operands: tuple[tuple[str, float], ...]
    signals: Mapping[str, float | bool]
    violations: tuple[Range, ...]
    flip: Flip | None

    @property
    def n_violating(self) -> int:
        """How many samples `violations` covers."""
        return sum(last - first + 1 for first, last in self.violations)

    def to_json(self) -> dict[str, Any]:
        """Return the explanation as data that JSON can hold; infinities are the texts "inf" and "-inf"."""
        decided = self.decided_by == "predicate"
        last = self.steps[-1]
        return {
            "requirement": self.requirement,
            "verdict": self.verdict.value,
            "robustness": _number(self.robustness),
            "sample": self.sample,
            "decided_by": self.decided_by,
            "reason": self.reason,
            "witness": {"sample": last.sample, "time": last.time} if decided else None,
            "steps": [
                {
                    "text": s.text,
                    "name": s.name,
                    "sample": s.sample,
                    "time": s.time,
                    "robustness": _number(s.robustness),
                }
                for s in self.steps
            ],
            "operands": [{"text": text, "value": _number(value)} for text, value in self.operands],
            "signals": {name: _number(value) for name, value in self.signals.items()},
            "violations": [list(r) for r in self.violations],
            "flip": None if self.flip is None else _flip_json(self.flip),
        }

    def lines(self) -> list[str]:
        """Return the explanation in three to six lines."""
        at = f" at {self._place(self.steps[0])}" if self.sample else ""
        lines = [
            f"{self.requirement} ({self.strength}) is {self.verdict.value}{at}: robustness {_short(self.robustness)}"
        ]
        lines += [f"  {label:<11} {text}" for label, text in self.parts() if text]
        return lines

    def text(self) -> str:
        """Return the lines as one text."""
        return "\n".join(self.lines())

    def parts(self) -> list[tuple[str, str]]:
        """Return what `lines` says below its first line: (what is told, text); the text may be empty."""
        last = self.steps[-1]
        decided = f"{self.reason}, at {self._place(last)}"
        if self.decided_by == "vacuous":
            decided = f"no sample: what `{last.text}` reads at {self._place(last)} lies outside the trace"
        elif self.decided_by == "constant":
            decided = f"no sample: `{last.text}` is constant"
        violating = (
            f"{_ranges_text(self.violations)}: {self.n_violating} of {self.n_samples}" if self.violations else ""
        )
        return [
            ("decided by", decided),
            ("by way of", self._way()),
            ("violating", violating),
            ("to hold" if self.verdict is Verdict.VIOLATED else "to fail", self._flip_text()),
        ]

    def _place(self, step: Step) -> str:
        return f"sample {step.sample}" + ("" if self.unit == "step" else f" ({_short(step.time)} {self.unit})")

    def _way(self) -> str:
        """Return the formulas with their samples, long chains without their middle."""
        words = [f"{s.name or s.text} at {s.sample}" for s in self.steps]
        if len(words) > 4:
            words = [*words[:2], f"… {len(words) - 3} more …", words[-1]]
        return " → ".join(words) if len(words) > 1 else ""

    def _flip_text(self) -> str:
        flip = self.flip
        if flip is None:
            return ""
        if flip.kind in ("single", "sample"):
            return " and ".join(change.text for change in flip.changes)
        if flip.kind == "impossible":
            return "no values of the signals would do"
        if flip.kind == "unknown":
            return "no change of one sample was found that would do"
        if not flip.changes:
            return "no change of one sample would do"
        return f"no change of one sample would do; {_together_text(flip)}"


def explain(bundle: BundleData, requirement: str, result: RequirementResult) -> Explanation:
    """Explain the value of a requirement on one trace.

    Not in the paper: it explains a value.

    Args:    bundle: the compiled spec. requirement: its name. result: what `evaluate` found for it.
    Returns: the explanation; its robustness, verdict and witness are those of the result.
    Raises:  UsageError: the result is that of a batch, or there is no such requirement.
    """
    declared = next((r for r in bundle.requirements if r.name == requirement), None)
    if declared is None:
        known = ", ".join(f"'{r.name}'" for r in bundle.requirements[:5])
        raise UsageError([diagnostic("D880", what=f"there is no requirement '{requirement}'", help=f"one of {known}")])
    if not isinstance(result, RequirementResult):
        what = "a batch of traces has no one explanation"
        raise UsageError([diagnostic("D880", what=what, help="evaluate one trace, and explain its result")])
    origin, witness = result.origin, result.witness
    found = values_below(origin.nodes, origin.root, origin.trace, origin.at)
    chain = find_chain(found, None if witness is None else witness.predicate, -1 if witness is None else witness.sample)
    bearing = bearing_samples(found, chain) if witness is not None else np.zeros(0, dtype=np.bool_)
    undecided = result.verdict is Verdict.UNDECIDED
    operands, signals = _operands(origin.nodes, chain[-1], origin.trace) if witness is not None else ((), {})
    return Explanation(
        requirement=requirement,
        strength=declared.strength,
        verdict=result.verdict,
        robustness=result.robustness,
        sample=origin.at,
        n_samples=origin.trace.n_samples,
        unit=origin.trace.unit,
        decided_by="predicate" if witness is not None else "vacuous" if result.vacuous else "constant",
        steps=_steps(bundle, found, chain, origin.trace),
        reason=result.reason,
        operands=operands,
        signals=MappingProxyType(signals),
        violations=_ranges(bearing) if result.verdict is Verdict.VIOLATED else (),
        flip=None if undecided else find_flip(bundle, found, chain, origin.trace),
    )


def named_values(
    bundle: BundleData, signals: Mapping[str, ArrayLike], time: ArrayLike | None = None
) -> Mapping[str, NDArray[np.float64]]:
    """Return the values of every named sub-formula and expression at every sample.

    Not in the paper: robustness of STL for each `let` that a requirement uses.

    Args:    bundle: the compiled spec. signals, time: one trace, or a batch (n_traces, n_samples), as `evaluate`
             takes them.
    Returns: for each let (n_samples,), or (n_traces, n_samples): the robustness of a formula, ties as 0, or the
             value of a real expression. Not to be written to.
    Raises:  DataError: the signals cannot be used, or an expression has no value.
    """
    roots = list(bundle.names.values())
    required = {name for root in roots for name in signal_nodes(bundle.nodes)[root]}
    trace = make_trace(bundle.time, bundle.signals, signals, time, required=required)
    found: dict[str, NDArray[np.float64]] = {}
    for name, values in zip(bundle.names, evaluate_nodes(bundle.nodes, roots, trace), strict=True):
        real = bundle.nodes[bundle.names[name]].op in REAL
        column = np.array(values if real else shown(values), dtype=np.float64).T
        column.flags.writeable = False
        found[name] = column
    return MappingProxyType(found)


def _steps(bundle: BundleData, found: Values, chain: Sequence[Link], trace: Trace) -> tuple[Step, ...]:
    names = {index: name for name, index in bundle.names.items()}
    predicate = chain[-1].index
    written = written_unit(bundle, predicate)
    units = {} if written is None else {predicate: written}
    texts = formula_texts(found.nodes, found.root, bundle.time, bundle.names, units)
    return tuple(
        Step(
            texts[link.index],
            names.get(link.index),
            link.sample,
            trace.time(link.sample),
            float(shown(found.values[link.index][link.sample])),
        )
        for link in chain
    )


def _operands(
    nodes: Sequence[Node], link: Link, trace: Trace
) -> tuple[tuple[tuple[str, float], ...], dict[str, float | bool]]:
    """Return the sides of the deciding predicate with their values, and the signals in it with theirs."""
    node = nodes[link.index]
    operands: tuple[tuple[str, float], ...] = ()
    if node.op in COMPARISONS:
        values = evaluate_nodes(nodes, node.children, trace)
        operands = tuple(
            (expression_text(nodes, child), float(column[link.sample]))
            for child, column in zip(node.children, values, strict=True)
        )
    signals: dict[str, float | bool] = {}
    for name in sorted(signal_nodes(nodes[: link.index + 1])[link.index]):
        value = float(trace.signals[name][link.sample])
        signals[name] = bool(value) if node.op == "bool" else value
    return operands, signals


def _ranges(mask: NDArray[np.bool_]) -> tuple[Range, ...]:
    """Return the runs of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    return tuple((int(first), int(end) - 1) for first, end in edges.reshape(-1, 2))


def _ranges_text(ranges: Sequence[Range]) -> str:
    words = [str(first) if first == last else f"{first} to {last}" for first, last in ranges[:_LONGEST_LIST]]
    if len(ranges) > _LONGEST_LIST:
        words.append("…")
    return ("sample " if len(ranges) == 1 and ranges[0][0] == ranges[0][1] else "samples ") + ", ".join(words)


def _together_text(flip: Flip) -> str:
    """Say what several changes have in common."""
    first = flip.changes[0]
    samples = np.array([c.sample for c in flip.changes])
    mask = np.zeros(samples.max() + 1, dtype=np.bool_)
    mask[samples] = True
    every = "both" if len(samples) == 2 else f"all {len(samples)}"
    count = f"{every} must change" if flip.least is not None else f"changing {len(samples)} does"
    alike = len({(c.bound, c.strict, c.beyond, c.value > c.before) for c in flip.changes}) == 1
    after = f" to {first.target}" if alike else ""
    return f"{count}: {first.signal} at {_ranges_text(_ranges(mask))}{after}"


def _flip_json(flip: Flip) -> dict[str, Any]:
    return {"kind": flip.kind, "least": flip.least, "changes": [_change_json(change) for change in flip.changes]}


def _change_json(change: Change) -> dict[str, Any]:
    def value(number: float) -> float | bool | str:
        return bool(number) if change.boolean else _number(number)

    return {
        "signal": change.signal,
        "sample": change.sample,
        "before": value(change.before),
        "bound": value(change.bound),
        "strict": change.strict,
        "value": value(change.value),
        "beyond": change.beyond,
        "text": change.text,
    }


def _number(value: float) -> float | str:
    return value if math.isfinite(value) else ("inf" if value > 0 else "-inf")


def _short(value: float) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return f"{value + 0.0:.6g}"
