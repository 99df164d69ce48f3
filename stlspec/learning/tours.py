"""Algorithm 3: paths through several goals, put together from segments.

In: a `World`, a trainer, a judge. Out: a `Search`: all segments, and the best `Tour`. Tours grow goal by goal,
all orders side by side; the segments that they need next are trained together, each once, whichever orders it
serves. Every tour that arrives somewhere is judged whole, also one that has not visited every goal: a goal may
have been passed on the way, or be wanted by no more than one side of an `or`.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import fsum
from pathlib import Path

from stlspec.compiler.bundle import BundleData
from stlspec.learning.orders import next_goals
from stlspec.learning.segments import Job, Segment, Trainer, shared_mask
from stlspec.learning.settings import Settings
from stlspec.learning.task import SETTLED, Task, World, lifted, open_watches, segment
from stlspec.scores import bounded_robustness
from stlspec.semantics.evaluation import Evaluation, RequirementResult, Verdict

CHAIN = -2
"""In a key in place of a goal: a whole order of goals trained as one, see `chains`."""

Key = tuple[int, int, tuple[int, ...]]
"""A segment: the learner state it starts from, the goal, and the watches to keep up; or a chain: the state, `CHAIN`,
and its goals and watches."""

Judge = Callable[[tuple[int, ...]], "Judgement"]
"""Judges a path of learner states."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """What the spec says about a whole path; larger is better.

    meets_hard, meets_all: whether it meets the requirements. wanted: the sum of the bounded robustness of the
    soft requirements.
    """

    meets_hard: bool
    meets_all: bool
    wanted: float


def judgement(bundle: BundleData, evaluation: Evaluation[RequirementResult]) -> Judgement:
    """Judge an evaluated path.

    Paper: Algorithm 3, its last line: the policy that maximises the robustness of all soft requirements, each
    bounded here, and infinite ones too, so that the sum means something.
    """
    satisfied = {r.name: evaluation[r.name].verdict is Verdict.SATISFIED for r in bundle.requirements}
    soft = [r for r in bundle.requirements if r.strength == "soft"]
    hard = all(satisfied[r.name] for r in bundle.requirements if r.strength == "hard")
    values = [bounded_robustness(evaluation[r.name].robustness, r.bound, r.scale) for r in soft]
    finite = [max(-1e100, min(1e100, value)) for value in values]
    return Judgement(hard, all(satisfied.values()), fsum(finite))


@dataclass(frozen=True, slots=True)
class Leg:
    """One goal of a tour, and the segment that led there; None = the tour stood on it already."""

    goal: int
    key: Key | None


@dataclass(frozen=True, slots=True)
class Tour:
    """A path of learner states through goals. arrived: whether it reached the last of its goals."""

    legs: tuple[Leg, ...]
    path: tuple[int, ...]
    actions: tuple[int, ...]
    arrived: bool = True

    @property
    def goals(self) -> tuple[int, ...]:
        """The goals in the order of the tour."""
        return tuple(leg.goal for leg in self.legs if leg.goal != SETTLED)


@dataclass
class Search:
    """The segments trained so far, in the order of training, with the tours they make.

    potential: (n_states,) of the environment, of a run with one goal. guide: the potential of a segment, by the state
    of the environment it starts from and the states of its goal; None = `potential` for all, as in Algorithm 3.
    """

    world: World
    settings: Settings
    potential: tuple[float, ...]
    forbidden: set[tuple[int, int]]
    fingerprint: Callable[[Task, Settings, Sequence[float], Sequence[tuple[int, int]]], str]
    directory: Path | None
    guide: Callable[[int, Sequence[bool]], tuple[float, ...]] | None = None
    segments: dict[Key, Segment] = field(default_factory=dict)
    tasks: dict[Key, Task] = field(default_factory=dict)
    candidates: list[Tour] = field(default_factory=list)

    def job(self, key: Key) -> Job:
        """Return the job that trains a segment."""
        start, goal, watches = key
        alone = len(self.world.visits) == 1 and not self.segments and start == self.world.product.start
        stream = () if alone else (1 + start, 1 + goal, len(watches))
        task = self.tasks[key] = segment(self.world, start, goal, watches, stream)
        guided = self.potential
        if self.guide is not None and goal != SETTLED and len(self.world.visits) > 1:
            guided = self.guide(self.world.place(start), self.world.visits[goal].holds)
        potential, forbidden = lifted(task, guided), tuple(sorted(self.forbidden))
        name = self.fingerprint(task, self.settings, potential, forbidden)
        return Job(task, self.settings, potential, forbidden, self.directory, name)

    def train(self, keys: Sequence[Key], trainer: Trainer) -> None:
        """Train the segments that are missing; what they learn about hard requirements serves all later ones."""
        missing = [key for key in dict.fromkeys(keys) if key not in self.segments]
        found = trainer([self.job(key) for key in missing])
        self.segments.update(zip(missing, found, strict=True))
        for key, trained in zip(missing, found, strict=True):
            self.forbidden |= shared_mask(self.tasks[key], [trained], self.world.product.violating)


def find_tours(search: Search, trainer: Trainer, *, watched: bool) -> None:
    """Train what all orders of the goals need, and collect the tours.

    Paper: Algorithm 3, lines 1 to 8; what shapes a segment is said in `guidance`.

    Args:    search: grows. trainer: trains segments. watched: whether segments keep up what soft requirements
             ask for; one that does not arrive that way is trained once more without.
    """
    world = search.world
    front = [Tour((), (world.product.start,), ())]
    for _ in world.visits:
        wanted = [(tour, goal) for tour in front for goal in next_goals(world.visits, tour.goals)]
        search.train([k for tour, goal in wanted for k in [_key(world, tour, goal, watched)] if k], trainer)
        lost = [k for tour, goal in wanted for k in [_key(world, tour, goal, watched)] if k and k[2]]
        search.train([(k[0], k[1], ()) for k in lost if not search.segments[k].reached], trainer)
        front = [extended(search, tour, goal, watched) for tour, goal in wanted]
        search.candidates += front
        front = [tour for tour in front if tour.arrived]
    settle(search, trainer)


def _key(world: World, tour: Tour, goal: int, watched: bool) -> Key | None:
    """Return the segment that leads a tour to a goal; None if it is there already."""
    if world.is_goal(tour.path[-1], goal):
        return None
    return tour.path[-1], goal, open_watches(world, tour.path) if watched else ()


def extended(search: Search, tour: Tour, goal: int, watched: bool) -> Tour:
    """Lead a tour on to a goal, as far as the segment goes. Paper: Algorithm 3, line 6."""
    key = _key(search.world, tour, goal, watched)
    if key is None:
        return Tour((*tour.legs, Leg(goal, None)), tour.path, tour.actions)
    if key[2] and not search.segments[key].reached:
        key = key[0], key[1], ()
    found = search.segments[key]
    return Tour((*tour.legs, Leg(goal, key)), tour.path + found.path[1:], tour.actions + found.actions, found.reached)


def settle(search: Search, trainer: Trainer) -> None:
    """Let tours that end while a hard requirement still waits for something go on until it has come.

    Not in the paper: its hard requirements wait for nothing.
    """
    world = search.world
    waiting = [t for t in search.candidates if t.arrived and not world.is_goal(t.path[-1], SETTLED)]
    if not world.product.settled or not any(world.product.settled):
        return
    waiting = [t for t in waiting if not world.product.violating[t.path[-1]]]
    search.train([(tour.path[-1], SETTLED, ()) for tour in waiting], trainer)
    search.candidates += [extended(search, tour, SETTLED, watched=False) for tour in waiting]


def best_tour(search: Search, judge: Judge) -> tuple[Tour, Judgement]:
    """Choose among the tours.

    Paper: Algorithm 3, its last line. One that meets the hard requirements is better than one that does not,
    then one that meets all; then the larger sum of bounded soft robustness, then fewer steps, then more goals,
    then the order in which they were found.
    """
    judged = [(tour, judge(tour.path)) for tour in search.candidates]
    return max(judged, key=merit)


def merit(judged: tuple[Tour, Judgement]) -> tuple[bool, bool, float, int, int]:
    """Return what tours are compared by, larger is better: see `best_tour`."""
    tour, found = judged
    return found.meets_hard, found.meets_all, round(found.wanted, 12), -len(tour.path), len(tour.goals)


def looks(search: Search, tour: Tour, judge: Judge) -> Iterator[tuple[int, int, bool]]:
    """Yield, for each look at a greedy path during training, whether the tour was a success by then.

    Paper: not in it; decision 10 for tours. Segments count in the order of training; a tour is a success once
    all its segments are trained or being trained, and the whole path meets every requirement.

    Returns: episodes and steps so far, and whether the whole path meets every requirement.
    """
    keys = list(search.segments)
    last = max((keys.index(leg.key) for leg in tour.legs if leg.key is not None), default=-1)
    whole = judge(tour.path).meets_all
    episodes = steps = 0
    for number, key in enumerate(keys):
        found = search.segments[key]
        known: dict[tuple[int, ...], bool] = {found.path: whole}
        for so_far, taken, path in found.looks:
            success = number > last and whole
            if number == last:
                if path not in known:
                    known[path] = _meets(search, tour, key, path, judge)
                success = known[path]
            yield episodes + so_far, steps + taken, success
        episodes, steps = episodes + len(found.steps), steps + sum(found.steps)


def _meets(search: Search, tour: Tour, changed: Key, path: tuple[int, ...], judge: Judge) -> bool:
    """Judge a tour with another path in one of its segments; the next segment must begin where it ends."""
    ends = [leg.key for leg in tour.legs if leg.key is not None][-1] == changed
    if not path or (path[-1] != search.segments[changed].path[-1] and not ends):
        return False
    whole: tuple[int, ...] = (search.world.product.start,)
    for key in dict.fromkeys(leg.key for leg in tour.legs if leg.key is not None):
        whole += path[1:] if key == changed else search.segments[key].path[1:]
    return judge(whole).meets_all
