"""Whole orders of goals trained as one, for goals that can be reached in several states.

In: a `Search` whose tours, put together from segments, meet not every requirement. Out: more tours. A segment
heads for the nearest state of its goal, whatever comes after it; where a goal is a region, or hard requirements
remember how it was reached, the best way on may begin in another one. A *chain* learns the way through all goals
of an order at once: its states are (stage, learner state), and only the last goal ends an episode.
"""

from collections.abc import Sequence
from dataclasses import replace

from stlspec.learning.segments import Job, Segment, Trainer
from stlspec.learning.shaping import AVOIDED, GOAL, RUNS, TERMINAL, VIOLATION
from stlspec.learning.task import SETTLED, Task, World, open_watches
from stlspec.learning.tours import CHAIN, Judge, Key, Leg, Search, Tour, merit

MOST_CHAINS = 12
"""Orders that are tried, those first whose segments did best."""

ALPHA = 1.0
"""The learning rate of chains: moves are deterministic, so a step can be believed at once."""

_GUIDANCE = 0.1

_AT_ONCE = 2
"""Chains that are trained before their tours are judged; not the number of processes, which changes no result."""

_MOST_STATES = 400_000


def find_chains(search: Search, trainer: Trainer, judge: Judge) -> None:
    """Train the most promising orders as wholes, and collect their tours.

    Not in the paper: Algorithm 3 takes a goal as one state. Chains first keep up what soft requirements ask for on
    the way, then head straight for their goals; the first that meet everything end the search.

    Args:    search: of tours; grows. trainer: trains chains. judge: judges tours.
    """
    world = search.world
    orders = [order for order in promising(search, judge) if len(order) * world.product.n_states <= _MOST_STATES]
    if not any(_several(world, goal) for order in orders for goal in order):
        return
    watched = open_watches(world, (world.product.start,))
    wanted = [(order, watches) for watches in dict.fromkeys((watched, ())) for order in orders]
    for first in range(0, len(wanted), _AT_ONCE):
        batch = wanted[first : first + _AT_ONCE]
        keys: list[Key] = [(world.product.start, CHAIN, (*order, *_marked(watches))) for order, watches in batch]
        jobs = [chain_job(search, key, *order) for key, order in zip(keys, batch, strict=True)]
        for key, (order, _), job, found in zip(keys, batch, jobs, trainer(jobs), strict=True):
            search.tasks[key] = job.task
            trained = search.segments[key] = in_learner_states(found, world.product.n_states)
            legs = tuple(Leg(goal, key) for goal in order)
            search.candidates.append(Tour(legs, trained.path, trained.actions, trained.reached))
        if any(judge(tour.path).meets_all for tour in search.candidates[-len(batch) :]):
            return


def _marked(watches: Sequence[int]) -> tuple[int, ...]:
    """Number watches below every goal, so that a key tells them from goals."""
    return tuple(-2 - watch for watch in watches)


def promising(search: Search, judge: Judge) -> list[tuple[int, ...]]:
    """Return the orders worth training as wholes: of two goals or more, the best tours first."""
    tours = sorted(search.candidates, key=lambda tour: merit((tour, judge(tour.path))), reverse=True)
    ends = (SETTLED,) if search.world.product.settled else ()
    orders = dict.fromkeys((*tour.goals, *ends) for tour in tours)
    return [order for order in orders if len(order) > 1][:MOST_CHAINS]


def _several(world: World, goal: int) -> bool:
    found = (s for s in range(world.product.n_states) if world.is_goal(s, goal))
    return next(found, None) is not None and next(found, None) is not None


def chain_job(search: Search, key: Key, order: Sequence[int], watches: Sequence[int]) -> Job:
    """Return the job that trains an order as a whole.

    Not in the paper: see `find_chains`. Values start at a little more than any way can pay, most along the
    demonstrations: what was never tried looks better than what was, so that the first way through all goals is not
    walked for ever when another, far off, is shorter.
    """
    world, stages = search.world, len(order)
    stream = (1 + key[0], 0, *(1 + goal for goal in order), len(watches))
    task = chain_task(world, order, watches, stream)
    size = world.product.n_states
    guide = [1 + _GUIDANCE * max(0.0, search.potential[world.place(s)]) for s in range(size)]
    potential = guide * stages
    forbidden = tuple((k * size + s, a) for k in range(stages) for s, a in sorted(search.forbidden))
    limit = search.settings.max_steps * stages
    settings = replace(search.settings, method="plain", max_steps=limit, alpha=ALPHA)
    name = search.fingerprint(task, settings, potential, forbidden)
    return Job(task, settings, tuple(potential), forbidden, search.directory, name, hopeful=True)


def chain_task(world: World, order: Sequence[int], watches: Sequence[int], stream: tuple[int, ...] = ()) -> Task:
    """Make the tables of a chain: state = stage * n_states + learner state.

    Args:    order: goals. watches: what to keep up, each until a goal of the order brings it to its end.
    Returns: the task; it ends at the last goal.
    """
    product = world.product
    size, stages = product.n_states, len(order)
    goals = [[world.is_goal(s, goal) for s in range(size)] for goal in order]

    def at(stage: int, state: int) -> int:
        while stage + 1 < stages and goals[stage][state]:
            stage += 1
        return stage * size + state

    endings = []
    for stage in range(stages):
        lasting = [w for w in watches if not any(_over(world, w, goal) for goal in order[:stage])]
        endings += [_ending(world, s, stage + 1 == stages and goals[stage][s], lasting) for s in range(size)]
    return Task(
        " then ".join("the end" if goal == SETTLED else world.visits[goal].name for goal in order),
        stages * size,
        world.n_actions,
        at(0, product.start),
        tuple(tuple(at(k, after) for after in row) for k in range(stages) for row in product.transitions),
        tuple(endings),
        product.robustness * stages,
        tuple(world.place(s) for s in range(size)) * stages,
        stream,
    )


def _over(world: World, watch: int, goal: int) -> bool:
    """Tell whether reaching a goal brings a watch to its end."""
    if goal == SETTLED:
        return False
    until = world.watches[watch].until
    return all(over for over, held in zip(until, world.visits[goal].holds, strict=True) if held)


def _ending(world: World, state: int, final: bool, watches: Sequence[int]) -> int:
    place = world.place(state)
    if world.product.violating[state]:
        return VIOLATION
    if final:
        return GOAL
    if place in world.terminal:
        return TERMINAL
    kept = all(world.watches[w].keeps[place] or world.watches[w].until[place] for w in watches)
    return RUNS if kept else AVOIDED


def in_learner_states(segment: Segment, size: int) -> Segment:
    """Translate the paths of a chain to learner states; Q tables stay as they are, one stage after the other."""
    looks = tuple((episodes, steps, tuple(s % size for s in path)) for episodes, steps, path in segment.looks)
    return replace(segment, path=tuple(s % size for s in segment.path), looks=looks)
