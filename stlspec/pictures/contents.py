"""What a picture of a demonstration shows, as data.

In: a demonstration's scores and their explanations. Out: a `Picture`: for each signal its values, where a
requirement that decides by it is violated, and the witnesses; for each requirement its robustness over time.
Nothing here draws, so what is to be seen can be tested as numbers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import COMPARISONS
from stlspec.scores import DemonstrationScore
from stlspec.semantics.evaluation import Verdict
from stlspec.semantics.explain import Explanation
from stlspec.semantics.relaxation import signal_nodes
from stlspec.traces import Trace

Floats = NDArray[np.float64]
Span = tuple[float, float]
"""From and to, on the time axis."""

LARGEST_PANELS = 20
"""No more signals, and no more requirements, are drawn than this."""

_STRETCHES = 600
_MOST_SPANS = 400


@dataclass(frozen=True, slots=True)
class Mark:
    """A witness: the sample that decides a requirement."""

    requirement: str
    time: float
    value: float
    verdict: Verdict


@dataclass(frozen=True, slots=True, eq=False)
class SignalPanel:
    """A signal over time.

    values: (n_samples,); Booleans are 1 and 0. bounds: what predicates compare the plain signal with.
    shaded: where a requirement that decides by this signal is violated, with the requirement's name.
    """

    name: str
    unit: str | None
    boolean: bool
    values: Floats
    bounds: tuple[float, ...]
    shaded: tuple[tuple[str, Span], ...]
    marks: tuple[Mark, ...]


@dataclass(frozen=True, slots=True, eq=False)
class RobustnessPanel:
    """The robustness of a requirement at every sample, (n_samples,); mark: at the sample that is reported."""

    name: str
    strength: str
    values: Floats
    mark: Mark
    vacuous: bool


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """What a picture of a demonstration shows; times: (n_samples,), in `unit`. left_out: panels beyond the most."""

    title: str
    subtitle: str
    label: str | None
    times: Floats
    unit: str
    signals: tuple[SignalPanel, ...]
    requirements: tuple[RobustnessPanel, ...]
    left_out: int = 0


def picture_of(bundle: BundleData, score: DemonstrationScore, explanations: Mapping[str, Explanation]) -> Picture:
    """Collect what a picture of one demonstration shows.

    Not in the paper: its figures show rewards; this one shows why a demonstration has its score.

    Args:    bundle: the compiled spec. score: of the demonstration. explanations: of each requirement.
    Returns: the picture as data.
    """
    results = {name: found.evaluated for name, found in score.requirements.items()}
    if not results:
        return Picture(plain(score.name), "no requirements", score.label, np.zeros(0), bundle.time.unit, (), ())
    trace = next(iter(results.values())).origin.trace
    times = np.array([trace.time(k) for k in range(trace.n_samples)])
    names = _order(bundle, explanations)
    signals = tuple(_signal_panel(bundle, name, trace, times, explanations) for name in names[:LARGEST_PANELS])
    panels = tuple(
        RobustnessPanel(
            name, explanations[name].strength, result.signal,
            Mark(name, float(times[result.origin.at]), result.robustness, result.verdict), result.vacuous,
        )
        for name, result in list(results.items())[:LARGEST_PANELS]
    )  # fmt: skip
    left_out = max(0, len(names) - LARGEST_PANELS) + max(0, len(results) - LARGEST_PANELS)
    return Picture(plain(score.name), _subtitle(score), score.label, times, trace.unit, signals, panels, left_out)


def plain(text: str) -> str:
    """Return a name on one line, neither too long nor with characters that cannot be drawn."""
    text = "".join(c if c.isprintable() else " " for c in text)
    return text if len(text) <= 60 else f"…{text[-59:]}"


def _subtitle(score: DemonstrationScore) -> str:
    if score.label is None or score.reward is None:
        return ""
    return f"{score.label}, reward {score.reward:.3g}, rank {score.rank}"


def _order(bundle: BundleData, explanations: Mapping[str, Explanation]) -> list[str]:
    """Return the signals that the requirements use, as declared; if there are too many, those of violations first."""
    used = signal_nodes(bundle.nodes)
    names = [s.name for s in bundle.signals if any(s.name in used[r.root] for r in bundle.requirements)]
    if len(names) <= LARGEST_PANELS:
        return names
    violating = {name for e in explanations.values() if e.verdict is Verdict.VIOLATED for name in e.signals}
    return sorted(names, key=lambda name: name not in violating)


def _signal_panel(
    bundle: BundleData, name: str, trace: Trace, times: Floats, explanations: Mapping[str, Explanation]
) -> SignalPanel:
    declared = next(s for s in bundle.signals if s.name == name)
    deciding = [e for e in explanations.values() if name in e.signals]
    shaded = [(e.requirement, span) for e in deciding for span in shaded_spans(e, times)]
    marks = [
        Mark(e.requirement, e.steps[-1].time, float(e.signals[name]), e.verdict)
        for e in deciding
        if e.decided_by == "predicate"
    ]
    return SignalPanel(
        name,
        declared.unit,
        declared.type == "bool",
        trace.signals[name],
        _bounds(bundle, name),
        tuple(shaded),
        tuple(marks),
    )


def shaded_spans(explanation: Explanation, times: Floats) -> list[Span]:
    """Return the violating samples as spans of time: each sample reaches half-way to its neighbours."""
    if not explanation.violations:
        return []
    edges = sample_edges(times)
    return [(float(edges[first]), float(edges[last + 1])) for first, last in explanation.violations]


def sample_edges(times: Floats) -> Floats:
    """Return the (n_samples + 1,) borders between samples; the outer ones are as far off as the inner ones."""
    if len(times) == 1:
        return np.array([times[0] - 0.5, times[0] + 0.5])
    middle = (times[1:] + times[:-1]) / 2
    return np.concatenate(([2 * times[0] - middle[0]], middle, [2 * times[-1] - middle[-1]]))


def _bounds(bundle: BundleData, name: str) -> tuple[float, ...]:
    """Return the numbers that the plain signal is compared with, few enough to be drawn."""
    found: set[float] = set()
    for node in bundle.nodes:
        sides = [bundle.nodes[c] for c in node.children] if node.op in COMPARISONS else []
        constants = [float(s.value or 0.0) for s in sides if s.op == "const"]
        if constants and any(s.op == "signal" and s.value == name for s in sides):
            found.update(c for c in constants if np.isfinite(c))
    return tuple(sorted(found)) if len(found) <= 6 else ()


def thinned(times: Floats, values: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the middle, the least and the greatest value of each of `_STRETCHES` stretches of samples."""
    starts = np.unique(np.linspace(0, len(times), _STRETCHES, endpoint=False).astype(np.int64))
    ends = np.append(starts[1:], len(times)) - 1
    return (times[starts] + times[ends]) / 2, np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)


def joined(spans: Sequence[Span]) -> list[Span]:
    """Join spans that overlap or touch; if many are left, those with the smallest gaps too."""
    found: list[Span] = []
    for first, last in sorted(spans):
        if found and first <= found[-1][1]:
            found[-1] = found[-1][0], max(found[-1][1], last)
        else:
            found.append((first, last))
    if len(found) <= _MOST_SPANS:
        return found
    gaps = np.array([b[0] - a[1] for a, b in pairwise(found)])
    kept = np.sort(np.argsort(gaps, kind="stable")[len(gaps) - _MOST_SPANS + 1 :])
    firsts, lasts = [0, *(kept + 1).tolist()], [*kept.tolist(), len(found) - 1]
    return [(found[i][0], found[j][1]) for i, j in zip(firsts, lasts, strict=True)]
