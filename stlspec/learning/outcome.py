"""What a run of the learner gives back, as data and as the documents that describe it.

In: the counts, tables and verdicts of a finished run. Out: `Outcome`, frozen, and its JSON. States are shown
as files have them, [row, col] on maps. Training time is the only number that two equal runs may differ in.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import number
from stlspec.errors import Diagnostic
from stlspec.learning.farming import Farming
from stlspec.learning.lessons import NO_LESSONS, Lessons
from stlspec.learning.policy import Policy
from stlspec.learning.satisfaction import Satisfaction
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import ENDINGS
from stlspec.learning.storage import RESULT_SCHEMA
from stlspec.markup.figures import standalone
from stlspec.markup.grids import board_svg
from stlspec.rewards import RewardMap
from stlspec.semantics.evaluation import Evaluation, RequirementResult, Verdict


@dataclass(frozen=True, slots=True)
class Log:
    """One entry for each episode: its steps, its return (undiscounted, before shaping), and how it ended.

    segments: the number of the segment that each episode trained, from 1; () = there is one.
    """

    steps: tuple[int, ...]
    returns: tuple[float, ...]
    endings: tuple[int, ...]
    segments: tuple[int, ...] = ()

    def to_csv(self) -> str:
        """Return the text of episodes.csv, episodes from 1; where there are several segments, with their numbers."""
        rows = [
            f"{i},{steps},{number(gained)},{ENDINGS[ending]}"
            for i, (steps, gained, ending) in enumerate(zip(self.steps, self.returns, self.endings, strict=True), 1)
        ]
        head = "episode,steps,return,outcome"
        if max(self.segments, default=1) > 1:
            head = f"{head},segment"
            rows = [f"{row},{segment}" for row, segment in zip(rows, self.segments, strict=True)]
        return "\n".join([head, *rows]) + "\n"


@dataclass(frozen=True, slots=True)
class Training:
    """What training took.

    env_steps: steps in the environment, greedy checks not counted. env_steps_to_success,
    episodes_to_success: up to the first check of the greedy path from which on all checks succeed; None if
    the last one does not. hard_violations: steps that violated. masked: pairs of state and action that the
    mask excludes at the end; prefilled: those of them that bad demonstrations had excluded before the start.
    seconds: wall-clock time, over all parts of a resumed run.
    """

    episodes: int
    env_steps: int
    env_steps_to_success: int | None
    episodes_to_success: int | None
    hard_violations: int
    masked: int
    prefilled: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of `learn`.

    success: whether the greedy path meets every requirement, by a fresh evaluation. states, actions: the
    greedy path, n + 1 state numbers and n actions. goal_order: the goals in the order they are visited in.
    evaluation: all requirements on that path. policy: the greedy policy with its Q table. reward: the map R
    that shaped (or, for the method paper, was) the reward. checks: (episode, env_steps, success) of each
    greedy check. farming: for the method paper, the cycle in which the policy collects reward without
    arriving; None if it does not. lessons: what each demonstration taught. stops: the samples of the path at
    which it reaches one goal after the other. warnings, notes: what the user should know. files: names of the
    files in the output directory. satisfaction: where transitions are by chance, how likely the requirements
    hold; the path is then one run of the policy, success means that the probability is 1 (that all runs met all),
    and meets_hard that the hard ones hold more often than not. observations: of that run, where states are bins.
    """

    settings: Settings
    success: bool
    states: tuple[int, ...]
    actions: tuple[int, ...]
    goal_order: tuple[str, ...]
    evaluation: Evaluation[RequirementResult]
    meets_hard: bool
    training: Training
    policy: Policy
    reward: RewardMap
    log: Log
    checks: tuple[tuple[int, int, bool], ...]
    farming: Farming | None = None
    lessons: Lessons = NO_LESSONS
    stops: tuple[int, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()
    notes: tuple[str, ...] = ()
    files: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    satisfaction: Satisfaction | None = None
    observations: tuple[Any, ...] | None = None

    @property
    def method(self) -> str:
        """The method that trained the policy."""
        return self.settings.method

    @property
    def seed(self) -> int:
        """The seed of the run."""
        return self.settings.seed

    @property
    def path(self) -> tuple[Any, ...]:
        """The greedy path as files have it: [row, col] on maps, observations where they are binned, else numbers."""
        if self.observations is not None:
            return self.observations
        return tuple(self.policy.states[s] for s in self.states)

    def _repr_svg_(self) -> str | None:
        """Show the greedy path and the reward on the map in a notebook; None where states are no cells."""
        board = replace(self.reward, environment=self.policy.environment).board(self.path)
        return None if board is None else standalone(board_svg(board, "The reward, and the path that was learned"))

    def to_json(self) -> dict[str, Any]:
        """Return the `stlspec.learn/1` document; `files` are relative to the output directory.

        A run of the method paper also has "farming": the cycle and both returns, or null.
        """
        training = self.training
        farming = {"farming": self._farming()} if self.method == "paper" else {}
        return {
            "schema": RESULT_SCHEMA,
            "method": self.method,
            "seed": self.seed,
            "success": self.success,
            "policy": {
                "states": [_listed(s) for s in self.path],
                "actions": list(self.actions),
                "goal_order": list(self.goal_order),
            },
            "requirements": self._requirements(),
            "satisfaction_probability": None if self.satisfaction is None else self.satisfaction.to_json(),
            "training": {
                "episodes": training.episodes,
                "env_steps": training.env_steps,
                "env_steps_to_success": training.env_steps_to_success,
                "episodes_to_success": training.episodes_to_success,
                "hard_violations": training.hard_violations,
                "seconds": training.seconds,
            },
            **farming,
            "files": dict(self.files),
        }

    def _requirements(self) -> dict[str, Any]:
        """Say what each requirement is worth on the path, or under chance how likely it holds: no verdict."""
        if self.satisfaction is not None:
            return {
                name: {"robustness": None, "verdict": None, "probability": number(probability)}
                for name, probability in self.satisfaction.alone.items()
            }
        return {
            name: {"robustness": number(result.robustness), "verdict": result.verdict.value}
            for name, result in self.evaluation.items()
        }

    def _farming(self) -> dict[str, Any] | None:
        found = self.farming
        if found is None:
            return None
        named = self.policy.states
        return {
            "cycle": [_listed(named[s]) for s in found.cycle],
            "return_cycle": number(found.return_cycle),
            "to_goal": None if found.to_goal is None else [_listed(named[s]) for s in found.to_goal],
            "return_goal": None if found.return_goal is None else number(found.return_goal),
        }


def meets(bundle: BundleData, evaluation: Evaluation[RequirementResult], *, hard_only: bool = False) -> bool:
    """Tell whether all requirements, or all hard ones, are satisfied. Not in the paper: the success test."""
    return all(
        evaluation[r.name].verdict is Verdict.SATISFIED
        for r in bundle.requirements
        if r.strength == "hard" or not hard_only
    )


def _listed(state: Any) -> Any:
    return list(state) if isinstance(state, tuple) else state
