"""A whole run of the learner: from a spec, an environment and demonstrations to a policy and its files.

In: what the user gives to `learn`. Out: an `Outcome`, and a directory if one is asked for. Algorithm 3 trains
segments (`segments`), puts tours together (`tours`), and has them judged here, by a fresh evaluation of the
spec, which shares no code with the tables that the learner trains on.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from stlspec.compiler.bundle import BundleData
from stlspec.demos import Demonstration
from stlspec.envs.live import with_bins as binned
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.learning import resume, storage
from stlspec.learning.chains import find_chains
from stlspec.learning.conclusion import conclude
from stlspec.learning.evidence import Evidence, gather
from stlspec.learning.experience import learn_from_experience
from stlspec.learning.guidance import segment_reward, ways_of
from stlspec.learning.lessons import lessons_of
from stlspec.learning.outcome import Outcome
from stlspec.learning.promises import AT_HOME, ELSEWHERE, promised
from stlspec.learning.results import marks, publish
from stlspec.learning.segments import Trainer, trainer
from stlspec.learning.settings import make_settings, needed_steps
from stlspec.learning.tables import signal_sources
from stlspec.learning.task import SETTLED, World, make_world, segment
from stlspec.learning.tours import Judgement, Search, Tour, best_tour, find_tours, judgement
from stlspec.rewards import RewardMap
from stlspec.semantics.evaluation import Evaluation, RequirementResult, Verdict, evaluate

MOST_JOBS = 256

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
    mask: bool | None = None,
    base: str = "spec",
    bins: Sequence[int] | None = None,
    jobs: int = 1,
    demo_environment: Environment | None = None,
    out: str | Path | None = None,
    progress: Progress | None = None,
) -> Outcome:
    """Learn a policy that meets the requirements of a spec.

    Paper: Algorithms 1 to 3.

    Args:    bundle: the compiled spec. environment: where to learn. demonstrations: good or bad; reward: a
             map inferred before, instead. method: "shaped", "plain" or "paper". episodes, max_steps: None = see
             `default_episodes`, `default_max_steps`; with several goals max_steps bounds the way to each.
             seed: same seed, same result. gamma, alpha, epsilon: of Q-learning. step_cost: per step. mask: never
             repeat what violated; None = where transitions are known to be deterministic. base: "spec", or
             "env" = the environment's own reward. bins: into how many to cut each entry of an observation,
             where states have no numbers. jobs: processes, for segments that can be trained at the same time;
             the result does not depend on it. demo_environment: where demonstrations were made that do not say
             so. out: directory for the results; an interrupted run resumes. progress: called between chunks of
             episodes.
    Returns: the outcome; `success` says whether the greedy path meets every requirement.
    Raises:  UsageError: D866 to D872, D876, D878, D879; DataError: a demonstration or the reward cannot be used.
    """
    environment, demonstrations = with_rewards(with_numbers(environment, bins), base), tuple(demonstrations)
    settings = make_settings(
        environment, method=method, episodes=episodes, seed=seed, max_steps=max_steps, gamma=gamma,
        alpha=alpha, epsilon=epsilon, step_cost=step_cost, mask=mask, base=base,
        needed=needed_steps(bundle, demonstrations),
    )  # fmt: skip
    if environment.bins is not None or environment.outcomes is not None:
        home = with_numbers(demo_environment, bins) if demo_environment is not None else environment
        return learn_from_experience(bundle, environment, demonstrations, reward, settings, home, out, progress)
    world = make_world(bundle, environment, settings.max_steps, memory=settings.method != "paper")
    judge = Judge(bundle, environment, world)
    judge.evaluate((world.product.start,))
    whole = segment(world, world.product.start, SETTLED)
    evidence = gather(bundle, whole, environment, demonstrations, reward, demo_environment)
    directory = None if out is None else storage.claim(out)
    search = Search(
        world,
        settings,
        potential_of(evidence, environment, settings.method),
        set(evidence.violating) if settings.mask else set(),
        partial(resume.fingerprint, bundle, environment),
        directory,
        guide_of(evidence, environment, settings.method),
    )
    with trainer(count_processes(jobs), progress and _Counter(search, progress)) as trained:
        tour = search_tours(search, trained, judge)
    outcome = conclude(search, tour, judge, judge.evaluate(tour.path), bundle, environment, evidence)
    outcome = replace(outcome, lessons=lessons_of(evidence, environment, whole, judge.broken))
    if directory is None:
        return outcome
    return publish(outcome, marks(world), world.place(world.product.start), environment, bundle, directory)


def with_numbers(environment: Environment, bins: Sequence[int] | None) -> Environment:
    """Number the states of an environment that does not do so itself.

    Paper: section 4, the mountain car in bins.

    Raises:  UsageError D869, D871: there are no bins where there should be, or some where there is nothing to cut.
    """
    if environment.n_states == 0 and environment.table is None and environment.bins is None:
        return binned(environment, bins)
    if bins is not None and environment.bins is None:
        allowed = f"left out: '{environment.id}' numbers its states itself"
        raise UsageError([diagnostic("D871", option="--bins", value=",".join(map(str, bins))[:40], allowed=allowed)])
    return environment


def with_rewards(environment: Environment, base: str) -> Environment:
    """Let an environment with a table of moves be sampled where its own reward is the base.

    Not in the paper: decision 7. The loop over a table of moves knows the spec's reward only.

    Raises:  UsageError D871: it pays for nothing.
    """
    if base != "env" or environment.transitions is None:
        return environment
    if not any(environment.payoffs):
        allowed = f"spec here: '{environment.id}' has no reward of its own"
        raise UsageError([diagnostic("D871", option="--base", value=base, allowed=allowed)])
    return replace(environment, outcomes=tuple(tuple(((1.0, s),) for s in row) for row in environment.transitions))


def potential_of(evidence: Evidence, environment: Environment, method: str) -> tuple[float, ...]:
    """Return what training is to make of the reward map: its potential, or for the method paper R itself.

    Paper: section 3.2. Not in the paper: how far a potential is trusted, see `promised`.

    Returns: (n_states,) of the environment.
    """
    reward = evidence.reward.table(environment)
    return reward if method == "paper" else promised(reward, AT_HOME if evidence.at_home else ELSEWHERE)


def guide_of(
    evidence: Evidence, environment: Environment, method: str
) -> Callable[[int, Sequence[bool]], tuple[float, ...]] | None:
    """Return what makes the potential of a segment, see `guidance`; None for the method paper or a given map.

    Paper: Algorithm 3 has one R for all. Returns: a function of the start and the goal of a segment.
    """
    if method == "paper" or evidence.given:
        return None
    ways, least = ways_of(evidence.ranked, environment), AT_HOME if evidence.at_home else ELSEWHERE
    return lambda start, goal: promised(segment_reward(ways, start, goal), least)


class _Counter:
    """Turns the progress of one segment into that of the run, as far as it is known by now."""

    def __init__(self, search: Search, progress: Progress) -> None:
        self.search = search
        self.progress = progress

    def __call__(self, number: int, episodes: int, steps: int) -> None:
        done = list(self.search.segments.values())
        before = len(done) + number
        taken = sum(sum(found.steps) for found in done) + steps
        each = self.search.settings.episodes
        self.progress(before * each + episodes, max(len(self.search.tasks), before + 1) * each, taken)


def count_processes(jobs: int) -> int:
    """Check the number of processes.

    Raises:  UsageError D871: it is not a whole number from 1 to 256.
    """
    if isinstance(jobs, bool) or not isinstance(jobs, int) or not 1 <= jobs <= MOST_JOBS:
        allowed = f"a whole number from 1 to {MOST_JOBS}"
        raise UsageError([diagnostic("D871", option="--jobs", value=str(jobs)[:40], allowed=allowed)])
    return jobs


def search_tours(search: Search, trained: Trainer, judge: "Judge") -> Tour:
    """Find the best tour, trying harder where the first search meets not every requirement.

    Paper: Algorithm 3. Segments first keep up what soft requirements ask for on the way (`always`, `until`);
    then, since one soft requirement may stand against another, they head straight for their goals; last, orders
    of goals that can be reached in several states are trained as wholes.
    """
    find_tours(search, trained, watched=True)
    tour, found = best_tour(search, judge)
    if search.world.watches and not found.meets_all:
        find_tours(search, trained, watched=False)
        tour, found = best_tour(search, judge)
    if search.settings.method != "paper" and not found.meets_all:
        find_chains(search, trained, judge)
        tour, found = best_tour(search, judge)
    return tour


class Judge:
    """Evaluates the spec afresh on a path of learner states; remembers paths, since evaluation is pure."""

    def __init__(self, bundle: BundleData, environment: Environment, world: World) -> None:
        self.bundle = bundle
        self.environment = environment
        self.world = world
        needed = {str(n.value) for n in bundle.nodes if n.op in ("signal", "bool")}
        self._sources = signal_sources(bundle, needed, environment)
        self._known: dict[tuple[int, ...], Judgement] = {}

    def evaluate(self, path: tuple[int, ...]) -> Evaluation[RequirementResult]:
        """Evaluate all requirements on a path, (n_samples,) learner states."""
        return self._evaluate([self.world.place(state) for state in path])

    def broken(self, places: Sequence[int]) -> tuple[str, ...]:
        """Name the hard requirements that a path violates, (n_samples,) states of the environment."""
        evaluation = self._evaluate(places)
        hard = [r.name for r in self.bundle.requirements if r.strength == "hard"]
        return tuple(name for name in hard if evaluation[name].verdict is Verdict.VIOLATED)

    def _evaluate(self, places: Sequence[int]) -> Evaluation[RequirementResult]:
        columns = self.environment.signals(set(self._sources.values()), places)
        signals = {name: columns[source] for name, source in self._sources.items()}
        return evaluate(self.bundle, signals, file="the learned path")

    def __call__(self, path: tuple[int, ...]) -> Judgement:
        """Judge a path."""
        known = self._known.get(path)
        if known is None:
            known = self._known[path] = judgement(self.bundle, self.evaluate(path))
        return known
