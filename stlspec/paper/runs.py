"""Many runs of the learner, each as one row of figures.

In: cases, methods, seeds. Out: `Row`s, small enough to be kept as JSON, since outcomes with their tables and logs
are not. Runs go to several processes; what comes back does not depend on how many.
"""

import pickle
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from stlspec.learning import Outcome, learn
from stlspec.learning.many import dumps
from stlspec.learning.segments import pool_of
from stlspec.learning.shaping import GOAL
from stlspec.paper.cases import Case
from stlspec.semantics.evaluation import Verdict

GROUPS = 60
"""Into so many groups of episodes a learning curve is cut; they grow, since most is learned in the first ones."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run to be made.

    group, method: where its row belongs. case: the task. home: the case whose demonstrations are used, where it is
    another one. kinds: of demonstrations that are used, () = all; none: use no demonstration. options: of `learn`.
    """

    group: str
    method: str
    case: Case
    seed: int
    home: Case | None = None
    kinds: tuple[str, ...] = ()
    none: bool = False
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Row:
    """What came out of one run.

    success: whether the greedy path meets every requirement; hard, reached: the hard ones, the requirement `reach`.
    probability: under chance how likely it meets all, None otherwise. path: its number of steps. late: steps more
    than T_goal, None without it. env_steps: of training; to_success: up to the first check from which on all
    succeed, None if there is none; episodes_to_success: the same in episodes. violations: of hard requirements in
    training. prefilled: pairs that bad demonstrations forbid. farming: whether the policy circles for reward.
    goals: share of training episodes that end at the goal. curve: mean steps per episode, (n_groups,).
    """

    seed: int
    success: bool
    hard: bool
    reached: bool
    probability: float | None
    path: int
    late: float | None
    episodes: int
    env_steps: int
    to_success: int | None
    episodes_to_success: int | None
    violations: int
    prefilled: int
    farming: bool
    goals: float
    seconds: float
    curve: tuple[float, ...]

    @property
    def mean_steps(self) -> float:
        """Steps per training episode, on average."""
        return self.env_steps / self.episodes


def groups(episodes: int) -> list[tuple[int, int]]:
    """Cut episodes into groups that grow geometrically: (first, end) of each, numbered from 0.

    Not in the paper: its figure 4 has a point for each episode.
    """
    edges = sorted({0, episodes, *np.geomspace(1, episodes, GROUPS).astype(int).tolist()})
    return list(pairwise(edges))


def row_of(outcome: Outcome, case: Case) -> Row:
    """Take the figures of an outcome."""
    training, log, due = outcome.training, outcome.log, case.params.get("T_goal")
    steps = np.asarray(log.steps, dtype=np.float64)
    n_segments = max(log.segments, default=1)
    chance = outcome.satisfaction
    return Row(
        seed=outcome.seed,
        success=outcome.success,
        hard=outcome.meets_hard,
        reached=outcome.evaluation["reach"].verdict is Verdict.SATISFIED,
        probability=None if chance is None else chance.value,
        path=len(outcome.actions),
        late=None if due is None else len(outcome.actions) - due,
        episodes=training.episodes,
        env_steps=training.env_steps,
        to_success=training.env_steps_to_success,
        episodes_to_success=training.episodes_to_success,
        violations=training.hard_violations,
        prefilled=training.prefilled,
        farming=outcome.farming is not None,
        goals=sum(ending == GOAL for ending in log.endings) / len(log.endings),
        seconds=training.seconds,
        # episodes of several segments follow each other, so they make no single curve
        curve=() if n_segments > 1 else tuple(float(steps[a:b].mean()) for a, b in groups(len(steps))),
    )


def make_run(run: Run) -> Row:
    """Make one run."""
    home = run.home or run.case
    demonstrations = () if run.none else home.demonstrations(*run.kinds)
    outcome = learn(
        run.case.bundle(),
        run.case.environment(),
        demonstrations,
        seed=run.seed,
        demo_environment=home.environment(),
        **run.options,
    )
    return row_of(outcome, run.case)


Rows = dict[str, dict[str, list[Row]]]
"""For each group and method the rows of its seeds."""


def make_runs(
    runs: Sequence[Run],
    jobs: int = 1,
    done: Callable[[int, int], object] | None = None,
    make: Callable[[Run], Row] = make_run,
) -> Rows:
    """Make all runs.

    Args:    jobs: processes. done: called with the number of runs done, and of all. make: makes one; a function
             of a module, since processes look it up there.
    Returns: their rows by group and method, in the order of the runs.
    """
    if jobs == 1:
        return _gathered(runs, map(make, runs), done)
    with pool_of(jobs) as pool:
        return _gathered(runs, pool.map(_made, [dumps((make, run)) for run in runs]), done)


def _made(data: bytes) -> Row:
    make, run = pickle.loads(data)  # noqa: S301 - written by our own parent
    row: Row = make(run)
    return row


def _gathered(runs: Sequence[Run], rows: Iterable[Row], done: Callable[[int, int], object] | None) -> Rows:
    found: Rows = {}
    for number, (run, row) in enumerate(zip(runs, rows, strict=True), 1):
        found.setdefault(run.group, {}).setdefault(run.method, []).append(row)
        if done is not None:
            done(number, len(runs))
    return found
