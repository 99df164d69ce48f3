"""Runs of a policy where transitions are by chance: one to show, and how likely they meet the requirements.

In: a table of outcomes, or a living environment. Out: `Run` and `Satisfaction`. What a run is worth is decided
by a fresh evaluation of the spec; only what ends an episode is watched online, by the spec's own monitor.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from stlspec.compiler.bundle import BundleData, Requirement
from stlspec.compiler.ir import Node
from stlspec.envs.live import bare, readers_of, sample_of
from stlspec.envs.model import Environment
from stlspec.learning.chance import Step, World
from stlspec.learning.goals import Condition, condition_name, find_agenda
from stlspec.learning.memory import FutureInPastError, make_machine
from stlspec.learning.satisfaction import RUNS_OF_THE_POLICY, Satisfaction, exact, from_runs
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, RUNS, TERMINAL, VIOLATION
from stlspec.learning.tables import signal_sources, tabulate
from stlspec.semantics.evaluation import Evaluation, RequirementResult, Verdict, evaluate
from stlspec.semantics.online.monitor import make_monitor

RUNS_OF_A_WORLD = 200
"""How many runs of a living environment a probability is estimated from."""

_GOAL = "\n"
"""What the goal is called among the requirements of a monitor: no requirement can have this name."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run of a policy: states and actions by number, raw observations where states are bins."""

    states: tuple[int, ...]
    actions: tuple[int, ...]
    evaluation: Evaluation[RequirementResult]
    observations: tuple[Any, ...] | None = None

    @property
    def held(self) -> dict[str, bool]:
        """For each requirement whether it holds."""
        return {name: found.verdict is Verdict.SATISFIED for name, found in self.evaluation.items()}


class Runner(Protocol):
    """Makes runs with a policy. goal_name: what the goal is called."""

    goal_name: str

    def run(self, actions: Sequence[int], settings: Settings, number: int) -> Run:
        """Make run `number` of a policy, (n_states,); the same number and seed give the same run."""

    def satisfaction(self, actions: Sequence[int], settings: Settings) -> Satisfaction:
        """Say how likely the policy meets the requirements."""


def _random(settings: Settings, number: int) -> np.random.Generator:
    return np.random.default_rng([settings.seed, number, 2])


class TableRunner:
    """Makes runs on a table of outcomes."""

    def __init__(self, bundle: BundleData, environment: Environment, endings: Sequence[int]) -> None:
        self.bundle = bundle
        self.environment = environment
        self.endings = endings
        self.goal_name = _goal_name(bundle)
        self._sources = signal_sources(
            bundle, {str(n.value) for n in bundle.nodes if n.op in ("signal", "bool")}, environment
        )

    def run(self, actions: Sequence[int], settings: Settings, number: int) -> Run:
        """See `Runner.run`."""
        environment, random = self.environment, _random(settings, number)
        assert environment.outcomes is not None
        assert environment.start is not None
        states, taken = [environment.start], list[int]()
        while self.endings[states[-1]] == RUNS and len(taken) < settings.max_steps:
            taken.append(actions[states[-1]])
            branches = environment.outcomes[states[-1]][taken[-1]]
            states.append(_drawn(branches, random.random()))
        columns = environment.signals(set(self._sources.values()), states)
        signals = {name: columns[source] for name, source in self._sources.items()}
        return Run(tuple(states), tuple(taken), evaluate(self.bundle, signals, file="the learned path"))

    def satisfaction(self, actions: Sequence[int], settings: Settings) -> Satisfaction:
        """See `Runner.satisfaction`: exact, unless the requirements take too much memory."""
        environment, bundle = self.environment, self.bundle
        assert environment.outcomes is not None
        assert environment.start is not None
        found = None
        try:
            machine = make_machine(bundle.nodes, [r.root for r in bundle.requirements], bundle.time)
        except FutureInPastError:
            machine = None
        letters = [] if machine is None else [Condition(node) for node in machine.sources]
        if machine is not None and _are_tables(bundle, letters):
            _, holds = tabulate(bundle, letters, environment)
            rows = list(zip(*(holds[letter] for letter in letters), strict=True)) or [()] * environment.n_states
            arguments = (environment.outcomes, actions, self.endings, environment.start, settings.max_steps)
            found = exact(bundle, machine, rows, *arguments)
        if found is not None:
            return found
        return from_runs(bundle, [self.run(actions, settings, k).held for k in range(RUNS_OF_THE_POLICY)])


def _drawn(branches: Sequence[tuple[float, int]], uniform: float) -> int:
    """Return the next state that a number in [0, 1) stands for."""
    for probability, after in branches:
        uniform -= probability
        if uniform < 0:
            return after
    return branches[-1][1]


def _are_tables(bundle: BundleData, letters: Sequence[Condition]) -> bool:
    """Tell whether conditions look at the present state only: delta, rate and now are no tables over states."""
    stack, seen = [letter.node for letter in letters], set[int]()
    while stack:
        node = bundle.nodes[stack.pop()]
        if node.op in ("delta", "rate", "now"):
            return False
        stack.extend(child for child in node.children if child not in seen)
        seen.update(node.children)
    return True


def _goal_name(bundle: BundleData) -> str:
    return condition_name(bundle, find_agenda(bundle).wishes[0].conditions)


def watching(bundle: BundleData, goal: Sequence[Condition]) -> BundleData:
    """Return a spec of the hard requirements and of `eventually` the goal, for a monitor.

    Paper: Algorithm 2, line 13. Not in the paper: the spec's own monitor says when an episode ends.
    """
    nodes = [*bundle.nodes]

    def add(node: Node) -> int:
        nodes.append(node)
        return len(nodes) - 1

    wanted = [add(Node("not", (c.node,))) if c.negated else c.node for c in goal]
    both = add(Node("and", tuple(wanted))) if len(wanted) > 1 else wanted[0]
    root = add(Node("eventually", (both,), interval=(0, None)))
    hard = [r for r in bundle.requirements if r.strength == "hard"]
    return replace(bundle, nodes=tuple(nodes), requirements=(*hard, Requirement(_GOAL, "soft", root)))


class WorldRunner:
    """Steps a living environment, and makes runs in it. One at a time: it has one environment."""

    def __init__(self, bundle: BundleData, environment: Environment, goal: Sequence[Condition]) -> None:
        self.bundle = bundle
        self.environment = environment
        self.goal_name = _goal_name(bundle)
        self._watched = watching(bundle, goal)
        self._readers = readers_of(bundle, environment.signal_names, environment.id)
        self._late = any((s.source or "").startswith("action") for s in bundle.signals if s.name in self._readers)
        self._live = bare(environment)
        assert environment.bins is not None
        self._number = environment.bins.numberer()
        self._first: tuple[Any, Any] | None = None
        self.world = World(self._reset, self._step)
        self.trail: list[tuple[Any, Any, Any]] | None = None

    def _reset(self, seed: int | None) -> Step:
        observation, info = self._live.reset(seed=seed)
        listed = plain(observation)
        self._monitor = make_monitor(self._watched)
        if self.trail is not None:
            self.trail = [(listed, None, info)]
        # a signal of the action takes the first action at sample 0, which is not known before the first step
        self._first = (listed, info) if self._late else None
        ending = RUNS if self._late else self._look(listed, None, info)
        return Step(self._number(listed), 0.0, ending)

    def _step(self, action: int) -> Step:
        observation, reward, terminated, truncated, info = self._live.step(action)
        listed = plain(observation)
        if self.trail is not None:
            self.trail.append((listed, action, info))
        ending = RUNS
        if self._first is not None:
            ending = self._look(self._first[0], action, self._first[1])
            self._first = None
        if ending == RUNS:
            ending = self._look(listed, action, info)
        if ending == RUNS and terminated:
            ending = TERMINAL
        return Step(self._number(listed), float(reward), ending, bool(truncated))

    def _look(self, observation: Any, action: Any, info: Any) -> int:
        standing = self._monitor.update(sample_of(self._readers, observation, action, info, self.environment.id))
        reached = standing[_GOAL].verdict is Verdict.SATISFIED
        if len(standing) > 1 and any(found.verdict is Verdict.VIOLATED for found in standing.values()):
            return VIOLATION
        return GOAL if reached else RUNS

    def run(self, actions: Sequence[int], settings: Settings, number: int) -> Run:
        """See `Runner.run`: from a start that the environment draws."""
        self.trail = []
        here = self._reset(int(_random(settings, number).integers(2**31)))
        states, taken = [here.state], list[int]()
        while here.ending == RUNS and not here.cut and len(taken) < settings.max_steps:
            taken.append(actions[states[-1]])
            here = self._step(taken[-1])
            states.append(here.state)
        trail, self.trail = self.trail, None
        columns: dict[str, list[Any]] = {name: [] for name in self._readers}
        for k, (observation, action, info) in enumerate(trail):
            led = trail[1][1] if k == 0 and len(trail) > 1 else action
            for name, value in sample_of(self._readers, observation, led, info, self.environment.id).items():
                columns[name].append(value)
        found = evaluate(self.bundle, columns, file="the learned path")
        return Run(tuple(states), tuple(taken), found, tuple(observation for observation, _, _ in trail))

    def satisfaction(self, actions: Sequence[int], settings: Settings) -> Satisfaction:
        """See `Runner.satisfaction`: from runs."""
        return from_runs(self.bundle, [self.run(actions, settings, k).held for k in range(RUNS_OF_A_WORLD)])


def world_of(bundle: BundleData, environment: Environment, goal: Sequence[Condition]) -> WorldRunner:
    """Make the living environment that `environment` describes, and watch it."""
    return WorldRunner(bundle, environment, goal)


def plain(observation: Any) -> list[Any]:
    """Return an observation as a list of plain numbers."""
    listed = observation.tolist() if isinstance(observation, np.ndarray | np.generic) else observation
    return listed if isinstance(listed, list) else [listed]
