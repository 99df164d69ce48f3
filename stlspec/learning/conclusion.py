"""What a run has to say when training is over.

In: the segments and the chosen tour. Out: an `Outcome`: the policy, the log, the counts, and remarks.
"""

from collections.abc import Iterable
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.printing import counted
from stlspec.envs.model import Environment
from stlspec.learning.evidence import Evidence, notes
from stlspec.learning.farming import Farming, describe, find_farming
from stlspec.learning.outcome import Log, Outcome, Training, meets
from stlspec.learning.policy import Policy, greedy_action
from stlspec.learning.route import Route, Stage
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, LIMIT
from stlspec.learning.task import SETTLED, World, lifted, place
from stlspec.learning.tours import CHAIN, Judge, Search, Tour, looks
from stlspec.semantics.evaluation import Evaluation, RequirementResult

Check = tuple[int, int, bool]
"""A look at the greedy path: episodes and steps so far, and whether it meets every requirement."""


def first_lasting_success(checks: Iterable[Check]) -> tuple[int, int] | None:
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
    search: Search,
    tour: Tour,
    judge: Judge,
    evaluation: Evaluation[RequirementResult],
    bundle: BundleData,
    environment: Environment,
    evidence: Evidence,
) -> Outcome:
    """Put together what the run has to say.

    Paper: Algorithms 2 and 3, their last lines.

    Args:    search, tour: what was trained, and what was chosen. judge: judges paths. evaluation: of the spec on
             the path of the tour. evidence: what demonstrations contributed.
    Returns: the outcome, without files.
    """
    world, settings = search.world, search.settings
    success = meets(bundle, evaluation)
    checks = tuple(looks(search, tour, judge))
    policy = make_policy(search, tour, environment)
    farming = _farming(search, tour) if settings.method == "paper" else None
    remarks = notes(evidence, settings.method, settings.mask)
    if world.product.violating[world.product.start]:
        remarks = (*remarks, "the start itself violates a hard requirement, so no policy can meet it")
    if settings.method == "paper":
        remarks = (*remarks, describe(farming, policy.states))
    log = _log(search)
    return Outcome(
        settings=settings,
        success=success,
        states=tuple(world.place(state) for state in tour.path),
        actions=tour.actions,
        goal_order=tuple(world.visits[goal].name for goal in tour.goals),
        stops=stops(world, tour),
        evaluation=evaluation,
        meets_hard=meets(bundle, evaluation, hard_only=True),
        training=_training(search, first_lasting_success(checks) if checks else (0, 0) if success else None),
        policy=policy,
        reward=evidence.reward,
        log=log,
        checks=checks,
        farming=farming,
        warnings=evidence.doubts + (() if settings.method == "plain" else evidence.warnings),
        notes=remarks if success else (*short_of_steps(log, settings), *remarks),
    )


def short_of_steps(log: Log, settings: Settings) -> tuple[str, ...]:
    """Say where no episode got to its goal and the step limit ended some: then the limit may be what is wrong.

    Not in the paper: it has no step limits. Returns: one line for the whole run, or none.
    """
    numbers, limit = log.segments or (1,) * len(log.endings), settings.max_steps
    reached = {number for number, ending in zip(numbers, log.endings, strict=True) if ending == GOAL}
    missed = [row for row in zip(numbers, log.steps, log.endings, strict=True) if row[0] not in reached]
    cut = [number for number, steps, ending in missed if ending == LIMIT and steps >= limit]
    if not cut:
        return ()
    segments, of = len(set(cut)), len(set(numbers))
    goal = "the goal" if of == 1 else f"the goal of {counted(segments, 'segment')} out of {of}"
    ended = "all of them" if len(cut) == len(missed) else f"{len(cut):,} of {len(missed):,}"
    way = f"if the way is longer, `--max-steps {10 * limit}` leaves time for it"
    return (f"no episode of training reached {goal}: {ended} ended at the step limit of {limit:,}; {way}",)


def stops(world: World, tour: Tour) -> tuple[int, ...]:
    """Return the samples at which a tour reaches its goals, as far as it does. Not in the paper: the account."""
    found, sample = [], 0
    for goal in tour.goals:
        while sample < len(tour.path) and not world.is_goal(tour.path[sample], goal):
            sample += 1
        if sample < len(tour.path):
            found.append(sample)
    return tuple(found)


def _training(search: Search, lasting: tuple[int, int] | None) -> Training:
    segments = list(search.segments.values())
    return Training(
        episodes=sum(len(found.steps) for found in segments),
        env_steps=sum(sum(found.steps) for found in segments),
        env_steps_to_success=lasting[1] if lasting else None,
        episodes_to_success=lasting[0] if lasting else None,
        hard_violations=sum(found.violations for found in segments),
        masked=len({pair for found in segments for pair in found.masked}),
        prefilled=segments[0].prefilled if segments else 0,
        seconds=sum(found.seconds for found in segments),
    )


def _farming(search: Search, tour: Tour) -> Farming | None:
    """Look at the last segment of a tour: where one farms, the tour goes no further.

    Returns: the cycle in states of the environment, as the report names them.
    """
    keys = [leg.key for leg in tour.legs if leg.key is not None]
    if not keys:
        return None
    task, found = search.tasks[keys[-1]], search.segments[keys[-1]]
    farming = find_farming(task, found.path, lifted(task, search.potential), search.settings.gamma)
    if farming is None:
        return None
    cycle, to_goal = (
        None if states is None else tuple(place(task, state) for state in states)
        for states in (farming.cycle, farming.to_goal)
    )
    return replace(farming, cycle=cycle or (), to_goal=to_goal)


def make_policy(search: Search, tour: Tour, environment: Environment) -> Policy:
    """Freeze the greedy action of every state, for each leg of a tour.

    Paper: Algorithm 2, "policy from start", for all states; Algorithm 3, the concatenation of policies.
    """
    world = search.world
    named: list[Any] = [environment.decode(state) for state in range(environment.n_states)]
    stages = []
    for leg in tour.legs:
        if leg.key is not None:
            q = search.segments[leg.key].q
            if leg.key[1] == CHAIN:
                first = tour.legs.index(leg) * world.product.n_states
                q = q[first : first + world.product.n_states]
            reached = frozenset(s for s in range(world.product.n_states) if world.is_goal(s, leg.goal))
            name = "the end" if leg.goal == SETTLED else world.visits[leg.goal].name
            stages.append(Stage(name, reached, tuple(map(greedy_action, q)), q))
    rows = [(0.0,) * environment.n_actions] * environment.n_states
    if stages:
        for state in reversed(range(world.product.n_states)):
            rows[world.place(state)] = stages[0].q[state]
    product = world.product
    places = product.places or tuple(range(environment.n_states))
    remembers = stages and (len(stages) > 1 or product.places)
    return Policy(
        MappingProxyType(environment.describe()),
        environment.n_actions,
        tuple(tuple(state) if isinstance(state, list) else state for state in named),
        tuple(map(greedy_action, rows)),
        tuple(rows),
        Route(places, product.start, product.transitions, tuple(stages)) if remembers else None,
    )


def _log(search: Search) -> Log:
    segments = list(search.segments.values())
    return Log(
        tuple(steps for found in segments for steps in found.steps),
        tuple(gained for found in segments for gained in found.returns),
        tuple(ending for found in segments for ending in found.outcomes),
        tuple(number for number, found in enumerate(segments, 1) for _ in found.steps),
    )
