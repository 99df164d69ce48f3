"""How likely a policy meets the requirements where transitions are by chance.

In: a policy, and a table of outcomes or runs that were made with it. Out: `Satisfaction`. With a table the
probability is exact: the distribution over states, and over what is left of each requirement, goes forward
sample by sample, so that time bounds, ends and memory count as in any other evaluation. Without one it is the
share of the runs, with Wilson's interval.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import number
from stlspec.envs.model import Outcomes
from stlspec.learning.memory import Machine, MachineState, at_end, first_state, read
from stlspec.learning.shaping import RUNS

RUNS_OF_THE_POLICY = 1000
"""How many runs a probability is estimated from where it is not exact."""

MOST_WORK = 5_000_000
"""The largest number of pairs of state and memory, over all samples, that the exact way may visit."""

ODDS = 0.5
"""Hard requirements count as met by a policy if all of them hold with a higher probability: more often than not."""

_Z = 1.959963984540054


@dataclass(frozen=True, slots=True)
class Satisfaction:
    """The probability that all requirements hold, and of each alone.

    value: of all of them. low, high: the interval of 95 % of Wilson; equal to value where it is exact. n: runs,
    None where it is exact. hard: of all hard ones. alone: of each requirement.
    """

    value: float
    low: float
    high: float
    method: Literal["exact", "rollouts"]
    n: int | None
    hard: float
    alone: Mapping[str, float]

    @property
    def meets_hard(self) -> bool:
        """Whether the hard requirements hold more often than not: by chance, hardly a policy always meets them."""
        return self.hard > ODDS

    def to_json(self) -> dict[str, Any]:
        """Return the part of the `stlspec.learn/1` document."""
        return {
            "value": number(self.value),
            "low": number(self.low),
            "high": number(self.high),
            "method": self.method,
            "n": self.n,
            "hard": number(self.hard),
            "meets_hard": self.meets_hard,
        }


def wilson(successes: int, n: int) -> tuple[float, float]:
    """Return Wilson's score interval of 95 % for a probability.

    Not in the paper: Wilson (1927).

    Args:    successes: from 0 to n. n: >= 1.
    Returns: low and high, in [0, 1].
    """
    share, z2 = successes / n, _Z * _Z
    middle = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = _Z / (1 + z2 / n) * math.sqrt(share * (1 - share) / n + z2 / (4 * n * n))
    low, high = max(0.0, middle - half), min(1.0, middle + half)
    return (0.0 if successes == 0 else low), (1.0 if successes == n else high)


def from_runs(bundle: BundleData, runs: Sequence[Mapping[str, bool]]) -> Satisfaction:
    """Estimate the probability from runs. Not in the paper: it has no chance.

    Args:    runs: for each run whether each requirement holds; at least one.
    """
    hard = [r.name for r in bundle.requirements if r.strength == "hard"]
    n, met = len(runs), sum(all(run.values()) for run in runs)
    low, high = wilson(met, n)
    alone = {r.name: sum(run[r.name] for run in runs) / n for r in bundle.requirements}
    return Satisfaction(met / n, low, high, "rollouts", n, sum(all(run[h] for h in hard) for run in runs) / n, alone)


def exact(
    bundle: BundleData,
    machine: Machine,
    holds: Sequence[Sequence[bool]],
    outcomes: Outcomes,
    actions: Sequence[int],
    endings: Sequence[int],
    start: int,
    max_steps: int,
) -> Satisfaction | None:
    """Work out the probability on a table, within the step limit.

    Not in the paper: dynamic programming over states, time, and what is left of the requirements.

    Args:    machine: for the roots of all requirements, in their order. holds: (n_states, n_letters).
             outcomes: of the environment. actions: (n_states,), of the policy. endings: (n_states,), where an
             episode ends. start: the first state. max_steps: the step limit.
    Returns: the probabilities; None if that takes more than `MOST_WORK`.
    """
    first = read(machine, first_state(machine), holds[start])
    now: dict[tuple[int, MachineState], float] = {(start, first): 1.0}
    over: dict[tuple[bool, ...], list[float]] = {}
    known: dict[tuple[MachineState, int], MachineState] = {}
    work = 0
    for step in range(max_steps + 1):
        later: dict[tuple[int, MachineState], float] = {}
        work += len(now)
        if work > MOST_WORK:
            return None
        for (state, memory), mass in now.items():
            if endings[state] != RUNS or step == max_steps:
                over.setdefault(tuple(at_end(machine, r) for r in memory[0]), []).append(mass)
                continue
            for probability, after in outcomes[state][actions[state]]:
                key = (memory, after)
                if key not in known:
                    known[key] = read(machine, memory, holds[after])
                place = (after, known[key])
                later[place] = later.get(place, 0.0) + mass * probability
        now = later
    return _summed(bundle, {held: math.fsum(masses) for held, masses in over.items()})


def _summed(bundle: BundleData, over: Mapping[tuple[bool, ...], float]) -> Satisfaction:
    """Add up the masses of the runs, by which requirements they meet."""
    whole = math.fsum(over.values())
    strong = [i for i, r in enumerate(bundle.requirements) if r.strength == "hard"]

    def share(wanted: Sequence[int]) -> float:
        return min(1.0, math.fsum(m for held, m in over.items() if all(held[i] for i in wanted)) / whole)

    value = share(range(len(bundle.requirements)))
    alone = {r.name: share([i]) for i, r in enumerate(bundle.requirements)}
    return Satisfaction(value, value, value, "exact", None, share(strong), alone)
