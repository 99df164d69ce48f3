"""Algorithm 1: from ranked demonstrations to a reward for every state.

In: a compiled spec and demonstrations with states. Out: a `RewardMap`, small JSON that carries over to
another map of the same size. What a state gets follows from the label of the demonstration that visits it;
every rule is a function of its own here, so that the map can be worked out by hand.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from stlspec.binding import BoundDemonstration
from stlspec.compiler.bundle import BundleData, Requirement
from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.demos import Demonstration
from stlspec.documents import DamageError, State, read_document, read_state
from stlspec.envs.bins import read_bins
from stlspec.envs.model import Environment
from stlspec.errors import DataError, Diagnostic, diagnostic
from stlspec.markup.figures import standalone
from stlspec.markup.grids import Board, board_svg
from stlspec.sampling import OnNan
from stlspec.scores import (
    DemonstrationScore,
    Label,
    RequirementScore,
    evaluate_demonstrations,
    rank_demonstrations,
)
from stlspec.semantics.evaluation import Evaluation, RequirementResult, Verdict
from stlspec.semantics.robustness import evaluate_nodes

SCHEMA = "stlspec.reward/1"
SMALLEST_PENALTY = 0.01
"""What a violation counts at least: next to its bound a robustness is 0, and would penalise nothing."""

_LARGEST_FILE = 64 * 2**20


@dataclass(frozen=True, slots=True)
class RewardMap:
    """R(s): the learner reward.

    meaning_sha256: the spec that ranked the demonstrations. environment: description {"id", "args", "map"} of
    the environment that the states belong to. states, values: of equal length; a state not listed has 0.
    values: in [-1, 1]. doubts: warnings about the demonstrations that it was inferred from; no part of its file.
    """

    meaning_sha256: str
    environment: Mapping[str, Any]
    states: tuple[State, ...]
    values: tuple[float, ...]
    doubts: tuple[Diagnostic, ...] = field(default=(), compare=False, repr=False)

    @property
    def all_zero(self) -> bool:
        """Whether the map says nothing: every state has 0."""
        return not any(self.values)

    def warnings(self) -> tuple[Diagnostic, ...]:
        """Return the doubts, and D864 if the map is 0 everywhere."""
        return (*self.doubts, *((diagnostic("D864", reason=""),) if self.all_zero else ()))

    def _repr_svg_(self) -> str | None:
        """Show the reward on the map in a notebook; None where its states are no cells of a map."""
        board = self.board()
        return None if board is None else standalone(board_svg(board, "The inferred reward on the map"))

    def board(self, path: Sequence[State] = ()) -> Board | None:
        """Return the map with the values on it, and a path if one is given; None where states are no cells."""
        rows = self.environment.get("map")
        if not isinstance(rows, list | tuple) or not rows or len({len(str(row)) for row in rows}) != 1:
            return None
        width = len(str(rows[0]))

        def cell(state: State) -> int:
            row, column = state if isinstance(state, tuple) else divmod(state, width)
            return row * width + column

        values = {cell(state): value for state, value in zip(self.states, self.values, strict=True)}
        inside = not values or 0 <= min(values) <= max(values) < width * len(rows)
        return Board(tuple(map(str, rows)), values, tuple(map(cell, path))) if inside and width else None

    def table(self, environment: Environment) -> tuple[float, ...]:
        """Return R for every state of `environment`, which need not be the one the map was inferred on.

        Paper: section 3.2, "on a map that could be the same as train map or an unseen map of similar size".

        Returns: (n_states,).
        Raises:  DataError D862: the environment lacks one of the states; D858: its bins are others; D863: the bins
                 of the map are damaged.
        """
        _check_bins(self.environment, environment)
        table = [0.0] * environment.size
        for state, value in zip(self.states, self.values, strict=True):
            try:
                table[environment.encode(state)] = value
            except DataError:
                raise _foreign("the reward map", state, environment) from None
        return tuple(table)

    def to_json(self) -> dict[str, Any]:
        """Return the `stlspec.reward/1` document."""
        return {
            "schema": SCHEMA,
            "meaning_sha256": self.meaning_sha256,
            "env": dict(self.environment),
            "states": [list(s) if isinstance(s, tuple) else s for s in self.states],
            "values": list(self.values),
        }


def _check_bins(made: Mapping[str, Any], environment: Environment) -> None:
    """Refuse a map over other bins than the environment's: the same numbers would mean other observations."""
    if made.get("bins") is None:
        return
    try:
        bins = read_bins(made["bins"])
    except (KeyError, TypeError, ValueError, AttributeError):
        raise DataError([diagnostic("D863", file="the reward map", problem="'bins' is damaged")]) from None
    here = environment.bins
    if bins == here:
        return
    ranges = here is not None and bins.counts == here.counts
    now = "numbers its states itself" if here is None else f"is cut into {here.text(ranges=ranges)}"
    help_ = "take a reward map that was inferred in this environment"
    if here is not None and environment.id == made.get("id") and not ranges:
        again = f"infer it again from the demonstrations: --demos DEMO... --bins {here.text()}"
        help_ = f"use the bins of the map: --bins {bins.text()}; or {again}"
    raise DataError([diagnostic("D858", made=bins.text(ranges=ranges), env=environment.id, now=now, help=help_)])


def rising_values(reward: float, length: int) -> list[float]:
    """Let the reward of a demonstration rise along it: r(s_l) = l / L * r_d.

    Paper: section 3.1, the assignment for good demonstrations.

    Args:    reward: r_d. length: L, the number of states.
    Returns: (length,), the last one r_d.
    """
    return [l_ / length * reward for l_ in range(1, length + 1)]


def penalty(weights: Sequence[float], bounded: Sequence[float]) -> float:
    """Say what the violating states of a bad demonstration get.

    Paper: equation (3), bad_reward, made negative by construction: the printed weighted sum is positive for
    most bad demonstrations, since the requirements that hold outweigh the one that fails.

    Args:    weights, bounded: of the violated hard requirements only.
    Returns: minus the sum of w * max(abs(bounded), 0.01); < 0.
    """
    terms = [w * max(abs(b), SMALLEST_PENALTY) for w, b in zip(weights, bounded, strict=True)]
    return -math.fsum(terms)


def demonstration_values(
    states: Sequence[int], label: Label, reward: float, violating: Iterable[int], penalised: float
) -> dict[int, float]:
    """Assign values to the states of one demonstration.

    Paper: Algorithm 1, lines 8 to 11; an incomplete demonstration gets max(r_d, 0) like a good one.

    Args:    states: (n_samples,). label, reward: of the demonstration. violating: samples that violate a hard
             requirement. penalised: what they get.
    Returns: a value for each state visited (good, incomplete) or violating (bad); the larger one where a
             state occurs twice.
    """
    if label == "bad":
        pairs = [(states[sample], penalised) for sample in violating]
    else:
        rising = rising_values(reward if label == "good" else max(reward, 0.0), len(states))
        pairs = list(zip(states, rising, strict=True))
    found: dict[int, float] = {}
    for state, value in pairs:
        found[state] = max(value, found.get(state, -math.inf))
    return found


def learner_reward(ranks: Sequence[int], values: Sequence[Mapping[int, float]]) -> dict[int, float]:
    """Add up the demonstrations, each times its rank, and normalise: R = sum of rank(d_j) * r_j.

    Paper: Algorithm 1, lines 12 and 13.

    Args:    ranks: (n_demonstrations,), 1 = worst. values: what each demonstration gives to states.
    Returns: states with a value other than 0, ascending; the largest absolute value is 1.
    """
    terms: dict[int, list[float]] = {}
    for rank, given in zip(ranks, values, strict=True):
        for state, value in given.items():
            terms.setdefault(state, []).append(rank * value)
    sums = {state: math.fsum(terms[state]) for state in sorted(terms)}
    largest = max(map(abs, sums.values()), default=0.0)
    return {state: value / largest for state, value in sums.items() if value} if largest else {}


@dataclass(frozen=True, slots=True)
class RankedStates:
    """A demonstration as Algorithm 1 sees it: states by number, label, rank, what its states get; its warnings."""

    name: str
    environment: Environment
    states: tuple[int, ...]
    label: Label
    rank: int
    values: Mapping[int, float]
    warnings: tuple[Diagnostic, ...] = ()


def ranked_states(
    bundle: BundleData,
    demonstrations: Iterable[Demonstration],
    environment: Environment | None = None,
    *,
    on_nan: OnNan = "refuse",
    resample: int | None = None,
) -> tuple[RankedStates, ...]:
    """Score demonstrations and give values to their states.

    Paper: Algorithm 1, lines 3 to 12. Arguments and errors as for `infer_reward`; on_nan, resample: as for `score`.
    """
    evaluated = evaluate_demonstrations(bundle, demonstrations, environment, on_nan=on_nan, resample=resample)
    ranking = rank_demonstrations(bundle, evaluated)
    return tuple(
        _ranked(bundle, _with_bins_of(environment, bound), evaluation, score)
        for (bound, evaluation), score in zip(evaluated, ranking.demonstrations, strict=True)
    )


def _with_bins_of(environment: Environment | None, bound: BoundDemonstration) -> BoundDemonstration:
    """Number the states of a demonstration by the bins of `environment`, where it was made in the same one."""
    home = bound.environment
    if environment is None or home is None or home.size or environment.id != home.id:
        return bound
    return replace(bound, environment=environment)


def infer_reward(
    bundle: BundleData,
    demonstrations: Iterable[Demonstration],
    environment: Environment | None = None,
) -> RewardMap:
    """Infer the reward of every state from ranked demonstrations.

    Paper: Algorithm 1.

    Args:    bundle: the compiled spec. demonstrations: with states. environment: where they were made, unless
             they say so themselves.
    Returns: the reward map; `warnings()` tells when it is 0 everywhere.
    Raises:  DataError D861: a demonstration has no states, or no environment that numbers them; D862: the
             demonstrations come from environments of different sizes; D860 and others as for `score`.
    """
    return reward_of(bundle, ranked_states(bundle, demonstrations, environment), environment)


def reward_of(bundle: BundleData, ranked: Sequence[RankedStates], environment: Environment | None = None) -> RewardMap:
    """Combine what the demonstrations give to states into one map.

    Paper: Algorithm 1, line 13. Arguments and errors as for `infer_reward`.
    """
    meaning = meaning_sha256(bundle)
    home = ranked[0].environment if ranked else environment
    if home is None:
        return RewardMap(meaning, MappingProxyType({"id": None, "args": {}, "map": None}), (), ())
    for other in ranked:
        if _shape(other.environment) != _shape(home):
            last = other.environment.decode(max(other.states))
            raise _foreign(f"demonstration '{other.name}'", last, home)
    found = learner_reward([d.rank for d in ranked], [d.values for d in ranked])
    states = tuple(_named(home.decode(state)) for state in found)
    doubts = tuple(warning for d in ranked for warning in d.warnings)
    return RewardMap(meaning, MappingProxyType(home.describe()), states, tuple(found.values()), doubts)


def _shape(environment: Environment) -> tuple[Any, ...]:
    return environment.n_states, environment.n_columns, environment.bins


def _foreign(what: str, state: Any, environment: Environment) -> DataError:
    shown = list(state) if isinstance(state, tuple) else state
    env, states = environment.id, environment.size
    return DataError([diagnostic("D862", state=shown, what=what, env=env, states=states)])


def _named(state: Any) -> State:
    return tuple(state) if isinstance(state, list) else state


def _ranked(
    bundle: BundleData,
    bound: BoundDemonstration,
    evaluation: Evaluation[RequirementResult],
    score: DemonstrationScore,
) -> RankedStates:
    name, file = bound.name, bound.demonstration.file
    if bound.states is None:
        raise DataError([diagnostic("D861", file=file, name=name)])
    if bound.environment is None or not bound.environment.size:
        raise DataError([_numberless(bound)])
    assert score.label is not None
    assert score.reward is not None
    assert score.rank is not None
    failed = [
        (r, weight, score.requirements[r.name])
        for r, weight in zip(bundle.requirements, bundle.weights, strict=True)
        if r.strength == "hard" and evaluation[r.name].verdict is Verdict.VIOLATED
    ]
    violating = sorted({k for r, _, found in failed for k in violating_samples(bundle, r, found)})
    penalised = penalty([weight for _, weight, _ in failed], [found.bounded for _, _, found in failed])
    states = tuple(map(bound.environment.encode, bound.states))
    values = demonstration_values(states, score.label, score.reward, violating, penalised)
    given = MappingProxyType(values)
    return RankedStates(name, bound.environment, states, score.label, score.rank, given, score.warnings)


def _numberless(bound: BoundDemonstration) -> Diagnostic:
    """Say why the states of a demonstration have no numbers."""
    named, file = bound.demonstration.recording.env, bound.demonstration.file
    reason, way = "no environment says which they are", 'name the environment: --env ID, or "env": {"id": ...} in it'
    if named is not None and bound.environment is None:
        shown = str(named.get("id") if isinstance(named, Mapping) else named)[:60]
        reason = f"its environment '{shown}' cannot be made here, and they mean nothing in another one"
        way = 'correct or remove "env" in the demonstration'
    elif bound.environment is not None:
        reason = f"'{bound.environment.id}' does not number its states"
        way = "use an environment with discrete states; `learn --bins 50,50` cuts observations into bins and infers it"
    return diagnostic("D875", file=file, name=bound.name, reason=reason, help=way)


def violating_samples(bundle: BundleData, requirement: Requirement, score: RequirementScore) -> list[int]:
    """Find the samples at which a violated hard requirement is violated.

    Paper: equation (3), s_bad = the states that do not satisfy psi in `always psi`.

    Returns: the samples in the window of `always psi` where psi is false; for any other formula the witness.
    """
    root = bundle.nodes[requirement.root]
    if root.op != "always" or root.interval is None:
        witness = score.result.witness
        return [] if witness is None else [witness.sample]
    trace = score.evaluated.origin.trace
    (values,) = evaluate_nodes(bundle.nodes, root.children, trace)
    low, high = root.interval
    inside = trace.times >= low
    if high is not None:
        inside &= trace.times <= high
    found: list[int] = np.flatnonzero((values < 0) & inside).tolist()
    return found


def load_reward(path: str | Path) -> RewardMap:
    """Read a reward map.

    Not in the paper: a file format.

    Raises:  DataError D863: the file is missing, damaged, or of another kind.
    """
    try:
        return read_reward(read_document(Path(path), SCHEMA, _LARGEST_FILE))
    except DamageError as error:
        raise DataError([diagnostic("D863", file=str(path), problem=str(error))]) from None


def read_reward(document: Mapping[str, Any]) -> RewardMap:
    """Read a reward map from its document.

    Not in the paper: a file format.

    Raises:  DamageError: something in it is missing or of the wrong kind.
    """
    meaning, environment = document.get("meaning_sha256"), document.get("env")
    states, values = document.get("states"), document.get("values")
    if not isinstance(meaning, str) or not isinstance(environment, dict):
        raise DamageError("'meaning_sha256' or 'env' is missing or of the wrong type")
    if not isinstance(states, list) or not isinstance(values, list) or len(states) != len(values):
        raise DamageError("'states' and 'values' must be lists of equal length")
    named = tuple(read_state(state) for state in states)
    if len(set(named)) < len(named):
        raise DamageError("a state occurs twice")
    for value in values:
        if type(value) not in (int, float) or not -1.0 <= value <= 1.0:
            raise DamageError(f"{str(value)[:40]} is not a value in [-1, 1]")
    return RewardMap(meaning, MappingProxyType(environment), named, tuple(map(float, values)))
