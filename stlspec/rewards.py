"""Algorithm 1: from ranked demonstrations to a reward for every state.

In: a compiled spec and demonstrations with states. Out: a `RewardMap`, small JSON that carries over to another
map of the same size. What a state gets follows from the label of the demonstration that visits it; every rule
is a function of its own here, so that the map can be worked out by hand.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from stlspec.compiler.bundle import BundleData, Requirement
from stlspec.demos import BoundDemonstration, Demonstration
from stlspec.envs.model import Environment
from stlspec.errors import DataError, Diagnostic, diagnostic
from stlspec.scores import (
    DemonstrationScore,
    Label,
    RequirementScore,
    evaluate_demonstrations,
    rank_demonstrations,
)
from stlspec.semantics.evaluation import Evaluation, Verdict

SCHEMA = "stlspec.reward/1"
SMALLEST_PENALTY = 0.01
"""What a violation counts at least: next to its bound a robustness is 0, and would penalise nothing."""

_LARGEST_FILE = 64 * 2**20

State = int | tuple[int, int]
"""A state as files have it: its number, or (row, col) on maps."""


@dataclass(frozen=True, slots=True)
class RewardMap:
    """R(s): the learner reward.

    meaning_sha256: the spec that ranked the demonstrations. environment: description {"id", "args", "map"} of
    the environment that the states belong to. states, values: of equal length; a state not listed has 0.
    values: in [-1, 1].
    """

    meaning_sha256: str
    environment: Mapping[str, Any]
    states: tuple[State, ...]
    values: tuple[float, ...]

    @property
    def all_zero(self) -> bool:
        """Whether the map says nothing: every state has 0."""
        return not any(self.values)

    def warnings(self) -> tuple[Diagnostic, ...]:
        """Return D864 if the map is 0 everywhere."""
        return (diagnostic("D864", reason=""),) if self.all_zero else ()

    def table(self, environment: Environment) -> tuple[float, ...]:
        """Return R for every state of `environment`, which need not be the one the map was inferred on.

        Paper: section 3.2, "on a map that could be the same as train map or an unseen map of similar size".

        Returns: (n_states,).
        Raises:  DataError D862: the environment lacks one of the states.
        """
        table = [0.0] * environment.n_states
        for state, value in zip(self.states, self.values, strict=True):
            try:
                table[environment.encode(state)] = value
            except DataError:
                what, shown = "the reward map", list(state) if isinstance(state, tuple) else state
                fields = {"env": environment.id, "states": environment.n_states}
                raise DataError([diagnostic("D862", state=shown, what=what, **fields)]) from None
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
