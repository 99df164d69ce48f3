"""How well each demonstration meets each requirement, and how the demonstrations rank.

In: a compiled spec and demonstrations. Out: a `Ranking`: label, reward r_d and rank of every demonstration,
robustness, verdict and witness of every requirement. Labels go by verdicts, never by the sign of a
robustness; a robustness is bounded before it is weighed, so that no requirement drowns the others.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Literal

from stlspec.binding import BoundDemonstration, bind
from stlspec.compiler.bundle import Bounding, BundleData, Requirement
from stlspec.compiler.bundle_file import number
from stlspec.compiler.printing import number_text
from stlspec.demos import Demonstration
from stlspec.envs.model import Environment
from stlspec.errors import DataError, Diagnostic, diagnostic
from stlspec.lang.units import STEP
from stlspec.markup.elements import element, short
from stlspec.markup.elements import number as shown
from stlspec.markup.figures import notebook
from stlspec.markup.tables import ScoreRow, score_table
from stlspec.sampling import OnNan
from stlspec.semantics.ending import End, evaluate_ending
from stlspec.semantics.evaluation import Evaluation, RequirementResult, Verdict, Witness
from stlspec.semantics.streaming import Outcome

Label = Literal["good", "incomplete", "bad"]
LABELS: tuple[Label, ...] = ("bad", "incomplete", "good")
"""The labels, worst first."""

SAME_REWARD = 1e-9
"""Rewards of one label that differ by no more than this from the group's first share a rank."""

LARGEST_TERM = 1e100
"""A bounded robustness beyond this is refused like an infinite one: sums of such terms could overflow."""


_KEYS = ("label", "reward", "rank")
"""What is said of a demonstration as a whole."""


@dataclass(frozen=True, slots=True)
class Settled:
    """What is kept of a `RequirementResult` when its trace is let go; the fields are as there."""

    robustness: float
    verdict: Verdict
    vacuous: bool
    witness: Witness | None
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class RequirementScore:
    """How one demonstration meets one requirement.

    bounded: the robustness after `bounded_robustness`; 0 if vacuous. result: the evaluation behind it, or what is
    kept of it. reason: why and when it fails, in words; "" if it holds.
    """

    bounded: float
    result: RequirementResult | Settled
    reason: str

    @property
    def evaluated(self) -> RequirementResult:
        """The evaluation with its trace, for explanations and pictures."""
        assert isinstance(self.result, RequirementResult), "scores of `many` keep no traces"
        return self.result

    def to_json(self) -> dict[str, Any]:
        """Return its part of the `stlspec.score/1` document."""
        result = self.result
        witness = result.witness
        interval = {} if result.low is None or result.high is None else {"low": result.low, "high": result.high}
        return {
            "robustness": number(result.robustness),
            **{key: number(value) for key, value in interval.items()},
            "bounded": self.bounded,
            "verdict": result.verdict.value,
            "vacuous": result.vacuous,
            "witness": None if witness is None else {"sample": witness.sample, "time": witness.time},
        }

    def settled(self) -> "RequirementScore":
        """Return the score without the trace."""
        r = self.result
        kept = Settled(r.robustness, r.verdict, r.vacuous, r.witness, r.low, r.high)
        return RequirementScore(self.bounded, kept, self.reason)


@dataclass(frozen=True, slots=True)
class DemonstrationScore:
    """How one demonstration meets all requirements.

    label, reward (r_d) and rank (1 = worst) are None where a verdict is undecided, or where the evaluation
    was not asked for at sample 0. warnings: what is doubtful about the demonstration itself.
    """

    name: str
    label: Label | None
    reward: float | None
    rank: int | None
    requirements: Mapping[str, RequirementScore]
    warnings: tuple[Diagnostic, ...] = ()

    def _repr_html_(self) -> str:
        """Show the robustness of each requirement over time in a notebook, of the first twenty."""
        head = element("p", element("b", short(self.name)), f" {self.label or ''}")
        return notebook(head, *(x.evaluated.chart(name) for name, x in list(self.requirements.items())[:20]))

    def to_json(self) -> dict[str, Any]:
        """Return its part of the `stlspec.score/1` document."""
        requirements = {name: x.to_json() for name, x in self.requirements.items()}
        whole = dict(zip(_KEYS, (self.label, self.reward, self.rank), strict=True))
        return {"name": self.name, **whole, "requirements": requirements}

    def row(self, href: str | None = None) -> ScoreRow:
        """Return its row in a table of scores. Args: href: where its name leads."""
        cells = [(x.result.verdict.value, value_text(x.result)) for x in self.requirements.values()]
        return ScoreRow(self.rank, self.name, self.label, self.reward, cells, href)


@dataclass(frozen=True, slots=True)
class Ranking:
    """The scores of all demonstrations, in the order in which they were given.

    requirements: name, strength, weight (softmax) and raw weight of each. at: the sample asked about, None =
    the demonstrations as a whole.
    """

    requirements: tuple[tuple[str, str, float, int], ...]
    demonstrations: tuple[DemonstrationScore, ...]
    at: int | None = None

    def best_first(self) -> list[int]:
        """Return the indices of the demonstrations, best first; equal ones in the order they were given in."""
        return sorted(range(len(self.demonstrations)), key=lambda k: -(self.demonstrations[k].rank or 0))

    def _repr_html_(self) -> str:
        """Show the ranking in a notebook, best first, of the first two hundred."""
        order = self.best_first()
        more = f", {len(order) - 200} more left out" if len(order) > 200 else ""
        rows = [self.demonstrations[k].row() for k in order[:200]]
        return notebook(score_table(f"Best first; rank 1 is the worst{more}", self.requirements, rows))

    def to_json(self) -> dict[str, Any]:
        """Return the `stlspec.score/1` document."""
        keys = ("name", "strength", "weight", "raw_weight")
        return {
            "schema": "stlspec.score/1",
            "requirements": [dict(zip(keys, row, strict=True)) for row in self.requirements],
            "demonstrations": [self._demonstration(d) for d in self.demonstrations],
        }

    def _demonstration(self, score: DemonstrationScore) -> dict[str, Any]:
        document = score.to_json()
        return {key: value for key, value in document.items() if self.at is None or key not in _KEYS}


def bounded_robustness(robustness: float, bound: Bounding, scale: float) -> float:
    """Bring a robustness to a scale on which it can be added to others.

    Paper: section 3.1, "bounded to specific ranges ... such as using tanh or piece-wise linear functions".

    Args:    robustness: in the unit of its signals. bound: "tanh", "linear" (clipped to [-1, 1]) or "none".
             scale: the robustness that counts as 1 before bounding, same unit, > 0.
    Returns: no unit; in [-1, 1] unless bound is "none".
    """
    ratio = robustness / scale
    if bound == "tanh":
        return math.tanh(ratio)
    return max(-1.0, min(1.0, ratio)) if bound == "linear" else ratio


def demonstration_reward(weights: Sequence[float], bounded: Sequence[float]) -> float:
    """Weigh the robustness of a demonstration: r_d = sum of w(phi_i) * rob_i.

    Paper: equation (2), total_demo_rob.

    Args:    weights: (n_requirements,), softmax of the raw weights. bounded: (n_requirements,).
    Returns: r_d, no unit.
    """
    return math.fsum(w * b for w, b in zip(weights, bounded, strict=True))


def demonstration_label(hard: Iterable[Verdict], soft: Iterable[Verdict]) -> Label | None:
    """Call a demonstration good, incomplete or bad.

    Paper: Definitions 3 and 4, read by verdict; `incomplete` stands in its experiments.

    Args:    hard, soft: the verdicts of the requirements.
    Returns: "bad" if a hard one is violated, "incomplete" if a soft one is, else "good"; None if a verdict is
             undecided.
    """
    hard, soft = list(hard), list(soft)
    if Verdict.UNDECIDED in hard or Verdict.UNDECIDED in soft:
        return None
    if Verdict.VIOLATED in hard:
        return "bad"
    return "incomplete" if Verdict.VIOLATED in soft else "good"


def ranks(labels: Sequence[Label | None], rewards: Sequence[float]) -> list[int | None]:
    """Rank demonstrations densely, 1 = worst: by label, then by reward.

    Paper: Algorithm 1, line 12, with the labels first, so that a good demonstration outranks a bad one.

    Args:    labels, rewards: (n_demonstrations,); those without a label get no rank.
    Returns: the ranks; within a label a new one begins where the reward exceeds the group's first by > 1e-9.
    """
    keys = sorted((LABELS.index(x), rewards[i], i) for i, x in enumerate(labels) if x is not None)
    found: list[int | None] = [None] * len(labels)
    rank, group, first = 0, -1, -math.inf
    for label, reward, index in keys:
        if label != group or reward - first > SAME_REWARD:
            rank, group, first = rank + 1, label, reward
        found[index] = rank
    return found


def evaluate_demonstrations(
    bundle: BundleData,
    demonstrations: Iterable[Demonstration],
    environment: Environment | None = None,
    *,
    end: End = "clip",
    at: int = 0,
    on_nan: OnNan = "refuse",
    resample: int | None = None,
) -> list[tuple[BoundDemonstration, Evaluation[RequirementResult]]]:
    """Find the signals of each demonstration, and evaluate all requirements over them.

    Paper: Algorithm 1, lines 4 to 6 (rob_i^j). Arguments as for `score`.
    """
    evaluated = []
    for demonstration in demonstrations:
        bound = bind(bundle, demonstration, environment, on_nan, resample)
        file = demonstration.file or demonstration.name
        result = evaluate_ending(bundle, bound.signals, bound.time, end=end, at=at, file=file)
        evaluated.append((bound, result))
    return evaluated


def score(
    bundle: BundleData,
    demonstrations: Iterable[Demonstration],
    environment: Environment | None = None,
    *,
    end: End = "clip",
    at: int | None = None,
    on_nan: OnNan = "refuse",
    resample: int | None = None,
) -> Ranking:
    """Score and rank demonstrations.

    Paper: Algorithm 1, lines 3 to 7 and 12.

    Args:    bundle: the compiled spec. demonstrations: as `load_demonstrations` gives them.
             environment: computes missing signals from states, for demonstrations that name none.
             end: "clip" or "strict". at: ask about this sample instead of the whole; negative
             counts from the end. on_nan: "refuse", "hold" or "drop". resample: a period in nanoseconds.
    Returns: the ranking, in the order of the demonstrations.
    Raises:  DataError: signals are missing or unusable; D860: an infinite robustness under `bound none`.
    """
    evaluated = evaluate_demonstrations(
        bundle, demonstrations, environment, end=end, at=at or 0, on_nan=on_nan, resample=resample
    )
    return rank_demonstrations(bundle, evaluated, at=at)


def rank_demonstrations(
    bundle: BundleData,
    evaluated: Sequence[tuple[BoundDemonstration, Evaluation[RequirementResult]]],
    *,
    at: int | None = None,
) -> Ranking:
    """Bound, weigh, label and rank what `evaluate_demonstrations` found.

    Paper: Algorithm 1, lines 6, 7 and 12; equation (2). Arguments and errors as for `score`.
    """
    return ranked(bundle, [score_demonstration(bundle, bound, result, at) for bound, result in evaluated], at)


def score_demonstration(
    bundle: BundleData, bound: BoundDemonstration, result: Evaluation[RequirementResult], at: int | None = None
) -> DemonstrationScore:
    """Bound, weigh and label what was found of one demonstration; its rank, which needs the others, stays None.

    Paper: Algorithm 1, lines 6 and 7; equation (2). Arguments and errors as for `score`.
    """
    row = {
        r.name: _requirement_score(r, bound.name, result[r.name], failure(r.name, result[r.name]))
        for r in bundle.requirements
    }
    return replace(_whole(bundle, bound.name, row, at), warnings=bound.warnings)


def score_outcomes(bundle: BundleData, name: str, outcomes: Mapping[str, Outcome]) -> DemonstrationScore:
    """Bound, weigh and label what a stream found of one demonstration; else as `score_demonstration`.

    Paper: Algorithm 1, lines 6 and 7; equation (2).
    """
    unit, row = bundle.time.unit, {}
    for r in bundle.requirements:
        found = outcomes[r.name]
        kept = Settled(found.robustness, found.verdict, found.vacuous, found.witness, None, None)
        reason = _failed(r.name, found.verdict, found.witness, found.reason, unit)
        row[r.name] = _requirement_score(r, name, kept, reason)
    return _whole(bundle, name, row)


def _whole(
    bundle: BundleData, name: str, row: Mapping[str, RequirementScore], at: int | None = None
) -> DemonstrationScore:
    label = None if at is not None else _label(bundle, row)
    reward = demonstration_reward(bundle.weights, [x.bounded for x in row.values()])
    return DemonstrationScore(name, label, None if label is None else reward, None, MappingProxyType(dict(row)))


def ranked(bundle: BundleData, scores: Sequence[DemonstrationScore], at: int | None = None) -> Ranking:
    """Rank scored demonstrations.

    Paper: Algorithm 1, line 12. Arguments as for `score`.
    """
    found = ranks([s.label for s in scores], [s.reward or 0.0 for s in scores])
    demonstrations = tuple(replace(s, rank=rank) for s, rank in zip(scores, found, strict=True))
    requirements = tuple(
        (r.name, r.strength, weight, raw)
        for r, weight, raw in zip(bundle.requirements, bundle.weights, bundle.raw_weights, strict=True)
    )
    return Ranking(requirements, demonstrations, at)


def _label(bundle: BundleData, scores: Mapping[str, RequirementScore]) -> Label | None:
    verdicts = [(r.strength, scores[r.name].result.verdict) for r in bundle.requirements]
    return demonstration_label(
        (v for strength, v in verdicts if strength == "hard"),
        (v for strength, v in verdicts if strength == "soft"),
    )


def _requirement_score(
    requirement: Requirement, demonstration: str, result: RequirementResult | Settled, reason: str
) -> RequirementScore:
    """Bound one robustness; a vacuous requirement says nothing about the demonstration, and counts 0."""
    if result.vacuous:
        return RequirementScore(0.0, result, reason)
    bounded = bounded_robustness(result.robustness, requirement.bound, requirement.scale)
    if abs(bounded) > LARGEST_TERM:
        value = number(result.robustness)
        raise DataError([diagnostic("D860", file=demonstration, requirement=requirement.name, value=value)])
    return RequirementScore(bounded, result, reason)


def value_text(result: RequirementResult | Settled) -> str:
    """Write a robustness for a table: as an enclosure where it is one, and with ∅ where no sample decided."""
    value = shown(result.robustness)
    if result.low is not None and result.high is not None and result.low != result.high:
        value = f"[{shown(result.low)}, {shown(result.high)}]"
    return value + (" ∅" if result.vacuous else "")


def moment(result: RequirementResult) -> str:
    """Name the sample that decides a result, with its time where time is not counted in samples."""
    return _moment(result.witness, result.origin.trace.unit)


def _moment(witness: Witness | None, unit: str) -> str:
    if witness is None:
        return ""
    return f"sample {witness.sample}" + (f" ({number_text(witness.time)} {unit})" if unit != STEP else "")


def failure(name: str, result: RequirementResult) -> str:
    """Say why and when a requirement fails, such as "avoid fails at sample 3: d_obs = 0, needs >= 1".

    Not in the paper: the report. Returns: one line; "" if the requirement does not fail.
    """
    if result.verdict is not Verdict.VIOLATED:
        return ""
    return _failed(name, result.verdict, result.witness, result.reason, result.origin.trace.unit)


def _failed(name: str, verdict: Verdict, witness: Witness | None, reason: str, unit: str) -> str:
    if verdict is not Verdict.VIOLATED:
        return ""
    at = "" if witness is None else f" at {_moment(witness, unit)}"
    return f"{name} fails{at}: {reason}"
