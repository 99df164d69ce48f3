"""A whole run of the learner: from a spec, an environment and demonstrations to a policy and its files.

In: what the user gives to `learn`. Out: an `Outcome`, and a directory if one is asked for. Training goes in
chunks of episodes; between two of them the greedy path is judged by a fresh evaluation of the spec, which
shares no code with the tables that the learner trains on, and the state may be kept for resuming.
"""

import time
from collections.abc import Callable, Iterable
from pathlib import Path
from types import MappingProxyType
from typing import Any

from stlspec.compiler.bundle import BundleData
from stlspec.demos import Demonstration
from stlspec.envs.model import Environment
from stlspec.learning import resume, storage
from stlspec.learning.evidence import Evidence, gather, notes
from stlspec.learning.farming import describe, find_farming
from stlspec.learning.outcome import Log, Outcome, Training, meets
from stlspec.learning.policy import Policy, greedy_action, greedy_path
from stlspec.learning.qstl import CHUNK, Learner, run_chunk
from stlspec.learning.results import publish
from stlspec.learning.settings import make_settings
from stlspec.learning.task import lifted, make_task, signal_sources
from stlspec.rewards import RewardMap
from stlspec.semantics.evaluation import Evaluation, RequirementResult, evaluate

CHECKPOINT_SECONDS = 1.0
"""How often the state of a run is kept; more rarely where keeping it takes long."""

CHECKPOINT_SHARE = 0.05
"""The largest share of the time that may go into keeping it."""

Progress = Callable[[int, int, int], object]
"""Called between chunks with episodes done, episodes in all, and steps so far."""


def learn(
    bundle: BundleData,
    environment: Environment,
    demonstrations: Iterable[Demonstration] = (),
    reward: RewardMap | None = None,
    *,
    method: str = "shaped",
    episodes: int | None = None,
    seed: int = 0,
    max_steps: int | None = None,
    gamma: float = 0.99,
    alpha: float = 0.1,
    epsilon: float = 0.4,
    step_cost: float = 0.01,
    mask: bool = True,
    demo_environment: Environment | None = None,
    out: str | Path | None = None,
    progress: Progress | None = None,
) -> Outcome:
    """Learn a policy that meets the requirements of a spec.

    Paper: Algorithms 1 and 2.

    Args:    bundle: the compiled spec. environment: where to learn. demonstrations: good or bad; reward: a
             map inferred before, instead. method: "shaped", "plain" or "paper". episodes, max_steps: None =
             by the environment. seed: same seed, same result. gamma, alpha, epsilon: of Q-learning.
             step_cost: per step. mask: never repeat what violated. demo_environment: where demonstrations
             were made that do not say so. out: directory for the results; an interrupted run resumes.
             progress: called between chunks of episodes.
    Returns: the outcome; `success` says whether the greedy path meets every requirement.
    Raises:  UsageError: D866 to D872, D876; DataError: a demonstration or the reward cannot be used.
    """
    settings = make_settings(
        environment, method=method, episodes=episodes, seed=seed, max_steps=max_steps, gamma=gamma,
        alpha=alpha, epsilon=epsilon, step_cost=step_cost, mask=mask,
    )  # fmt: skip
    task = make_task(bundle, environment)
    judge = Judge(bundle, environment)
    judge((task.start,))
    evidence = gather(bundle, task, environment, demonstrations, reward, demo_environment)
    learner = Learner(task, settings, lifted(task, evidence.reward.table(environment)))
    if settings.mask:
        learner.forbid(evidence.violating)
    prefilled = learner.masked
    directory = None if out is None else storage.claim(out)
    key = resume.fingerprint(bundle, environment, learner, evidence.violating)
    position = train(learner, judge, directory, key, progress)
    outcome = conclude(learner, judge, environment, evidence, position, prefilled)
    return outcome if directory is None else publish(outcome, task, environment, bundle, directory)


class Judge:
    """Evaluates the spec afresh on a path of states; remembers paths, since evaluation is pure."""

    def __init__(self, bundle: BundleData, environment: Environment) -> None:
        self.bundle = bundle
        self.environment = environment
        needed = {str(n.value) for n in bundle.nodes if n.op in ("signal", "bool")}
        self._sources = signal_sources(bundle, needed, environment)
        self._known: dict[tuple[int, ...], bool] = {}

    def __call__(self, path: tuple[int, ...]) -> Evaluation[RequirementResult]:
        """Evaluate all requirements on a path, (n_samples,) state numbers."""
        columns = self.environment.signals(set(self._sources.values()), path)
        signals = {name: columns[source] for name, source in self._sources.items()}
        return evaluate(self.bundle, signals, file="the learned path")

    def approves(self, path: tuple[int, ...]) -> bool:
        """Tell whether a path meets every requirement."""
        known = self._known.get(path)
        if known is None:
            known = self._known[path] = meets(self.bundle, self(path))
        return known


def train(
    learner: Learner, judge: Judge, directory: Path | None, key: str, progress: Progress | None
) -> resume.Position:
    """Train to the end, from the checkpoint of the same run if there is one.

    Paper: Algorithm 2, with a check of the greedy path after every chunk of episodes.

    Args:    learner: changed in place. judge: judges greedy paths. directory: of the results, None = keep
             nothing. key: fingerprint of the run. progress: see `learn`; what it raises ends training.
    Returns: all checks, and the seconds spent, those before an interruption included.
    """
    task, settings = learner.task, learner.settings
    state = None if directory is None else storage.load_checkpoint(directory, key)
    position = None if state is None else resume.restore(learner, state)
    chunks, checks, spent = (position.chunks, [*position.checks], position.seconds) if position else (0, [], 0.0)
    began = saved = time.perf_counter()
    pause = CHECKPOINT_SECONDS
    while chunks * CHUNK < settings.episodes:
        run_chunk(learner, chunks)
        chunks += 1
        path, _ = greedy_path(learner.q, task.transitions, learner.endings, task.start, settings.max_steps)
        checks.append((len(learner.steps), learner.env_steps, judge.approves(path)))
        now = time.perf_counter()
        if directory is not None and now - saved >= pause and chunks * CHUNK < settings.episodes:
            position = resume.Position(chunks, tuple(checks), spent + now - began)
            storage.save_checkpoint(directory, key, resume.to_state(learner, position))
            saved = time.perf_counter()
            pause = max(CHECKPOINT_SECONDS, (saved - now) / CHECKPOINT_SHARE)
        if progress is not None:
            progress(len(learner.steps), settings.episodes, learner.env_steps)
    return resume.Position(chunks, tuple(checks), spent + time.perf_counter() - began)


def first_lasting_success(checks: Iterable[resume.Check]) -> tuple[int, int] | None:
    """Find the first check from which on all checks succeed.

    Not in the paper: decision 10, how learning speed is measured.

    Returns: its episodes and steps; None if the last check fails.
    """
    found = None
    for episodes, steps, success in checks:
        if not success:
            found = None
        elif found is None:
            found = (episodes, steps)
    return found


def conclude(
    learner: Learner,
    judge: Judge,
    environment: Environment,
    evidence: Evidence,
    position: resume.Position,
    prefilled: int,
) -> Outcome:
    """Judge the greedy path once more, and put together what the run has to say.

    Paper: Algorithm 2, its last line. Args: as in `learn`. Returns: the outcome, without files.
    """
    task, settings = learner.task, learner.settings
    path, actions = greedy_path(learner.q, task.transitions, learner.endings, task.start, settings.max_steps)
    evaluation = judge(path)
    lasting = first_lasting_success(position.checks)
    training = Training(
        episodes=len(learner.steps),
        env_steps=learner.env_steps,
        env_steps_to_success=lasting[1] if lasting else None,
        episodes_to_success=lasting[0] if lasting else None,
        hard_violations=learner.violations,
        masked=learner.masked,
        prefilled=prefilled,
        seconds=position.seconds,
    )
    policy = make_policy(learner, environment)
    remarks, farming = notes(evidence, settings.method, settings.mask), None
    if settings.method == "paper":
        farming = find_farming(task, path, learner.reward, settings.gamma)
        remarks = (*remarks, describe(farming, policy.states))
    return Outcome(
        settings=settings,
        success=meets(judge.bundle, evaluation),
        states=path,
        actions=actions,
        goal_order=(task.goal_name,),
        evaluation=evaluation,
        meets_hard=meets(judge.bundle, evaluation, hard_only=True),
        training=training,
        policy=policy,
        reward=evidence.reward,
        log=Log(tuple(learner.steps), tuple(learner.returns), tuple(learner.outcomes)),
        checks=position.checks,
        farming=farming,
        warnings=() if settings.method == "plain" else evidence.warnings,
        notes=remarks,
    )


def make_policy(learner: Learner, environment: Environment) -> Policy:
    """Freeze the greedy action of every state. Paper: Algorithm 2, "policy from start", for all states."""
    named: list[Any] = [environment.decode(state) for state in range(environment.n_states)]
    return Policy(
        MappingProxyType(environment.describe()),
        environment.n_actions,
        tuple(tuple(state) if isinstance(state, list) else state for state in named),
        tuple(greedy_action(row) for row in learner.q),
        tuple(map(tuple, learner.q)),
    )
