"""A whole run of the learner where transitions are by chance, or known only by taking them.

In: what the user gives to `learn`. Out: an `Outcome` with a satisfaction probability in place of verdicts, and
a directory if one is asked for. Training samples steps, from the table of an environment where there is one,
else from the living environment; only the probability at the end looks at the table as a whole.
"""

import hashlib
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from stlspec.compiler.bundle import BundleData
from stlspec.demos import Demonstration
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.learning import chance, storage
from stlspec.learning.conclusion import short_of_steps
from stlspec.learning.evidence import Evidence, gathered
from stlspec.learning.goals import Condition, find_agenda
from stlspec.learning.lessons import lessons_of
from stlspec.learning.outcome import Log, Outcome, Training
from stlspec.learning.policy import Policy, greedy_action
from stlspec.learning.product import split_hard
from stlspec.learning.qstl import CHUNK
from stlspec.learning.results import publish
from stlspec.learning.runs import Runner, TableRunner, world_of
from stlspec.learning.satisfaction import Satisfaction
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, RUNS, TERMINAL, VIOLATION
from stlspec.learning.tables import tabulate
from stlspec.rewards import RewardMap

_FORMAT = 1

CHECKPOINT_SECONDS = 2.0
"""How often the state of a run is kept."""


@dataclass(frozen=True, slots=True)
class Scene:
    """What a run is about: the problem, who makes runs with a policy, and what demonstrations say."""

    problem: chance.Problem
    runner: Runner
    evidence: Evidence


def learn_from_experience(
    bundle: BundleData,
    environment: Environment,
    demonstrations: Iterable[Demonstration],
    reward: RewardMap | None,
    settings: Settings,
    demo_environment: Environment | None,
    out: str | Path | None,
    progress: Callable[[int, int, int], object] | None,
) -> Outcome:
    """Learn a policy by sampling.

    Paper: Algorithm 2, on FrozenLake and the mountain car.

    Args:    as for `learn`; environment: with outcomes, or living and with bins.
    Returns: the outcome; its `satisfaction` says how likely the policy meets the requirements.
    Raises:  UsageError D866, D868, D869, D870, D876; DataError: a demonstration or the reward cannot be used.
    """
    goal = one_goal(bundle, environment)
    refuse(bundle, environment, settings)
    evidence = gathered(bundle, demonstrations, reward, demo_environment or environment)
    directory = None if out is None else storage.claim(out)
    scene = _scene(bundle, environment, goal, evidence, settings)
    key = fingerprint(bundle, environment, scene.problem, settings)
    sampler, seconds = train(scene.problem, settings, directory, key, progress)
    outcome = conclude(environment, scene, sampler, seconds)
    if directory is None:
        return outcome
    endings = scene.problem.endings or (RUNS,) * scene.problem.n_states
    return publish(outcome, endings, scene.problem.start, environment, bundle, directory)


def refuse(bundle: BundleData, environment: Environment, settings: Settings) -> None:
    """Refuse what this way of learning cannot do.

    Raises:  UsageError D868: a hard requirement has memory; D869: the method is paper; D876: stamps.
    """
    if bundle.time.kind == "stamps":
        raise UsageError([diagnostic("D876", file=bundle.sources[0][0] if bundle.sources else None)])
    if settings.method == "paper":
        reason = "`--method paper` is kept for deterministic tables, where its cycles can be shown"
        raise UsageError([diagnostic("D869", env=environment.id, reason=reason, help="--method shaped or plain")])
    remembering = split_hard(bundle).remembering
    if remembering:
        reason = "where transitions are by chance or between bins, a hard requirement is `always` of a condition"
        raise UsageError([diagnostic("D868", requirement=remembering[0].name, reason=reason)])


def one_goal(bundle: BundleData, environment: Environment) -> tuple[Condition, ...]:
    """Return the conditions of the one goal.

    Raises:  UsageError D866: there is none; D869: there are several.
    """
    wishes = list(dict.fromkeys(wish.conditions for wish in find_agenda(bundle).wishes))
    if not wishes:
        raise UsageError([diagnostic("D866", file=bundle.sources[0][0] if bundle.sources else None)])
    if len(wishes) > 1:
        reason = f"the spec has {len(wishes)} goals, and where transitions are by chance the learner takes one"
        raise UsageError([diagnostic("D869", env=environment.id, reason=reason, help="a spec for each goal")])
    return wishes[0]


def settle_table(bundle: BundleData, environment: Environment, goal: Sequence[Condition]) -> tuple[int, ...]:
    """Say how an episode stands in each state of an environment whose transitions are by chance.

    Paper: Algorithm 2, line 13. Args: goal: the conditions of the one goal. Returns: (n_states,).
    """
    hard = [condition for row in split_hard(bundle).plain for condition in row]
    _, holds = tabulate(bundle, [*goal, *hard], environment)
    return tuple(
        VIOLATION
        if not all(holds[c][state] for c in hard)
        else GOAL
        if all(holds[c][state] for c in goal)
        else TERMINAL
        if state in environment.terminal
        else RUNS
        for state in range(environment.n_states)
    )


def _scene(
    bundle: BundleData, environment: Environment, goal: tuple[Condition, ...], evidence: Evidence, settings: Settings
) -> Scene:
    potentials = tuple(max(0.0, value) for value in evidence.reward.table(environment))
    if environment.outcomes is None:
        assert environment.bins is not None
        runner = world_of(bundle, environment, goal)
        n_states = environment.bins.size
        problem = chance.Problem("goal", n_states, environment.n_actions, potentials, world=runner.world)
        return Scene(problem, runner, evidence)
    assert environment.start is not None
    endings = settle_table(bundle, environment, goal)
    own = environment.payoffs or (0.0,) * environment.n_states
    entered = [chance.pays(endings[s], own[s], settings) for s in range(environment.n_states)]
    branches = []
    for actions in environment.outcomes:
        row = []
        for outcomes in actions:
            total, edges = 0.0, []
            for probability, after in outcomes:
                total += probability
                edges.append((total, after, entered[after], endings[after]))
            row.append((*edges[:-1], (1.0, *edges[-1][1:])))
        branches.append(tuple(row))
    problem = chance.Problem(
        "goal", environment.n_states, environment.n_actions, potentials, tuple(branches), environment.start, endings
    )
    return Scene(problem, TableRunner(bundle, environment, endings), evidence)


def fingerprint(bundle: BundleData, environment: Environment, problem: chance.Problem, settings: Settings) -> str:
    """Hash everything that the course of a run depends on. Not in the paper: see `resume.fingerprint`."""
    spec = (bundle.time, bundle.signals, bundle.requirements, bundle.nodes)
    world = (environment.describe(), environment.outcomes, environment.bins, problem.potentials, problem.branches)
    run = (_FORMAT, CHUNK, settings, spec, world)
    return hashlib.sha256(repr(run).encode()).hexdigest()


def train(
    problem: chance.Problem,
    settings: Settings,
    directory: Path | None,
    key: str,
    progress: Callable[[int, int, int], object] | None,
) -> tuple[chance.Sampler, float]:
    """Train to the end, from the checkpoint of the same run if there is one.

    Paper: Algorithm 2.

    Args:    directory: where the state is kept, None = nowhere. key: fingerprint of the run. progress: see
             `learn`.
    Returns: the sampler, and the seconds spent, all parts of a resumed run.
    """
    sampler = chance.Sampler(problem, settings)
    state = None if directory is None else storage.load_checkpoint(directory, key)
    chunks, spent = (0, 0.0) if state is None or not sampler.restore(state) else (state["chunks"], state["seconds"])
    began = saved = time.perf_counter()
    while chunks * CHUNK < settings.episodes:
        chance.run_chunk(sampler, chunks)
        chunks += 1
        now = time.perf_counter()
        if directory is not None and now - saved >= CHECKPOINT_SECONDS:
            kept = {"chunks": chunks, "seconds": spent + now - began, **sampler.to_state()}
            storage.save_checkpoint(directory, key, kept)
            saved = time.perf_counter()
        if progress is not None:
            progress(len(sampler.steps), settings.episodes, sum(sampler.steps))
    return sampler, spent + time.perf_counter() - began


def conclude(environment: Environment, scene: Scene, sampler: chance.Sampler, seconds: float) -> Outcome:
    """Say how likely the policy meets the requirements, and put together what the run has to say.

    Not in the paper: satisfaction under chance. Returns: the outcome, without files.
    """
    settings, values = sampler.settings, sampler.values()
    actions = [greedy_action(row) for row in values]
    satisfaction = scene.runner.satisfaction(actions, settings)
    shown = scene.runner.run(actions, settings, 0)
    n_states, endings = scene.problem.n_states, scene.problem.endings
    log = Log(tuple(sampler.steps), tuple(sampler.returns), tuple(sampler.outcomes))
    named: list[Any] = [environment.decode(state) for state in range(n_states)]
    policy = Policy(
        MappingProxyType(environment.describe()),
        environment.n_actions,
        tuple(tuple(state) if isinstance(state, list) else state for state in named),
        tuple(actions),
        tuple(map(tuple, values)),
        bins=environment.bins,
    )
    return Outcome(
        settings=settings,
        success=satisfaction.value == 1.0,  # the same where moves are certain: the one run meets all or not
        states=shown.states,
        actions=shown.actions,
        goal_order=(scene.runner.goal_name,),
        stops=(len(shown.actions),) if endings and endings[shown.states[-1]] == GOAL else (),
        evaluation=shown.evaluation,
        meets_hard=satisfaction.meets_hard,
        training=Training(
            len(sampler.steps), sum(sampler.steps), None, None, sampler.violations, sampler.masked, 0, seconds
        ),
        policy=policy,
        reward=scene.evidence.reward,
        log=log,
        checks=(),
        lessons=lessons_of(scene.evidence, environment),
        warnings=scene.evidence.doubts + (() if settings.method == "plain" else scene.evidence.warnings),
        notes=short_of_steps(log, settings)
        + (() if environment.deterministic else _remarks(satisfaction, environment)),
        satisfaction=None if environment.deterministic else satisfaction,
        observations=shown.observations,
    )


def _remarks(found: Satisfaction, environment: Environment) -> tuple[str, ...]:
    """Say how probabilities were found, and of a path that can be drawn, which run it is."""
    drawn = environment.map is not None and environment.n_columns is not None
    if found.method == "exact":
        path = "; the path is one run" if drawn else ""
        return (f"probabilities are exact, by the table of outcomes, within the step limit{path}",)
    path = "; the path is the first of them" if drawn else ""
    return (f"probabilities are those of {found.n} runs of the policy{path}",)
