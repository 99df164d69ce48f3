"""What there is to learn: goals and hard requirements as tables over the states that the learner tells apart.

In: a compiled spec and an environment. Out: a `World`, all that holds for a whole run, and from it one `Task`
for each segment of Algorithm 3: from a state to a goal. A *learner state* is a state of the environment together
with what the hard requirements remember of the way there; without memory it is the environment's own state.
Training sees nothing but the numbers of these states; `Task.places` and `lifted` lead from one numbering to
the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from stlspec.compiler.bundle import BundleData
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.learning.goals import find_agenda
from stlspec.learning.memory import samples_of
from stlspec.learning.orders import Visit, check_orders, make_visits, together
from stlspec.learning.product import Product, make_product, split_hard
from stlspec.learning.shaping import AVOIDED, GOAL, RUNS, TERMINAL, VIOLATION
from stlspec.learning.tables import deterministic_transitions, tabulate

SETTLED = -1
"""The number of the goal that is no goal: to end where every hard requirement holds if the run ends."""

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Task:
    """Tables over learner states, row = number of the state.

    goal_name: what the goal is called in the spec. start: the state that episodes begin in.
    transitions: (n_states, n_actions), the next states. endings: (n_states,), how an episode stands in each
    state: it violates a hard requirement, else is a goal, else is terminal in the environment, else breaks what
    a soft requirement keeps up, else runs on.
    robustness: (n_states, n_hard), of the condition that each hard requirement demands always.
    places: (n_states,), the state of the environment in each; () = they are the environment's own states.
    stream: what tells the random numbers of this task from those of other tasks of one run.
    payoffs: (n_states,), what entering each state pays besides the base reward; () = nothing.
    """

    goal_name: str
    n_states: int
    n_actions: int
    start: int
    transitions: tuple[tuple[int, ...], ...]
    endings: tuple[int, ...]
    robustness: tuple[tuple[float, ...], ...]
    places: tuple[int, ...] = ()
    stream: tuple[int, ...] = ()
    payoffs: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Watch:
    """What a soft requirement keeps up, over the states of the environment.

    keeps: whether each state keeps it up. until: the states after which it is over, all False = never.
    """

    keeps: tuple[bool, ...]
    until: tuple[bool, ...]


@dataclass(frozen=True, slots=True)
class World:
    """All that the segments of a run share.

    visits: the goals. watches: what soft requirements keep up. terminal: where the environment itself ends.
    """

    product: Product
    visits: tuple[Visit, ...]
    watches: tuple[Watch, ...]
    terminal: frozenset[int]
    n_actions: int

    def place(self, state: int) -> int:
        """Return the state of the environment that a learner state is in."""
        return self.product.places[state] if self.product.places else state

    def is_goal(self, state: int, goal: int) -> bool:
        """Tell whether a learner state reaches a goal, or with `SETTLED` may be the last of a run."""
        product = self.product
        if product.violating[state]:
            return False
        if goal == SETTLED:
            return not product.settled or product.settled[state]
        visit = self.visits[goal]
        early = bool(product.clock) and product.clock[state] < visit.earliest
        return visit.holds[self.place(state)] and not early


def make_world(bundle: BundleData, environment: Environment, longest: int, *, memory: bool = True) -> World:
    """Find goals and learner states.

    Paper: the tests in Algorithm 2, line 13 ("s' in Goals or rho < 0 for any hard phi"), and the set Goals of
    Algorithm 3.

    Args:    bundle: the compiled spec. environment: with deterministic transitions over numbered states.
             longest: steps of an episode. memory: whether hard requirements may have memory.
    Returns: the world.
    Raises:  UsageError D866, D867: no goal, or too many orders of goals; D868, D878: a hard requirement cannot
             be watched; D869: transitions are not known to be deterministic; D870: a signal is not offered;
             D876: the spec measures stamps.
    """
    file = bundle.sources[0][0] if bundle.sources else None
    if bundle.time.kind == "stamps":
        raise UsageError([diagnostic("D876", file=file)])
    transitions = deterministic_transitions(environment)
    agenda = find_agenda(bundle)
    if not agenda.wishes:
        raise UsageError([diagnostic("D866", file=file)])
    conditions = [c for wish in agenda.wishes for c in wish.conditions]
    conditions += [c for guard in agenda.guards for c in (*guard.keep, *guard.until)]
    _, holds = tabulate(bundle, conditions, environment)
    visits = make_visits(bundle, agenda, holds)
    check_orders(visits)
    remembering = split_hard(bundle).remembering
    if remembering and not memory:
        reason = "`--method paper` takes only `always` of a condition on the present sample"
        raise UsageError([diagnostic("D868", requirement=remembering[0].name, reason=reason)])
    earliest = max(samples_of((visit.earliest, None), bundle.time)[0] for visit in visits)
    product = make_product(bundle, environment, transitions, longest=longest * (len(visits) + 1), earliest=earliest)
    nowhere = (False,) * environment.n_states
    watches = dict.fromkeys(
        Watch(together(holds, guard.keep), together(holds, guard.until) if guard.until else nowhere)
        for guard in agenda.guards
        if not guard.hard
    )
    in_samples = tuple(_in_samples(visit, samples_of((visit.earliest, None), bundle.time)[0]) for visit in visits)
    return World(product, in_samples, tuple(watches), environment.terminal, environment.n_actions)


def _in_samples(visit: Visit, earliest: int) -> Visit:
    return Visit(visit.name, visit.holds, earliest, visit.requirements, visit.before)


def segment(world: World, start: int, goal: int, watches: Sequence[int] = (), stream: tuple[int, ...] = ()) -> Task:
    """Make the tables of one segment: from a learner state to a goal.

    Paper: Algorithm 3, lines 4 and 6: Q_stl(..., g_i, g_{i+1}).

    Args:    start: a learner state. goal: the number of a goal, or `SETTLED`. watches: numbers of those that
             are still to be kept up. stream: see `Task`.
    """
    product = world.product
    endings = []
    for state in range(product.n_states):
        place = world.place(state)
        if product.violating[state]:
            endings.append(VIOLATION)
        elif world.is_goal(state, goal):
            endings.append(GOAL)
        elif place in world.terminal:
            endings.append(TERMINAL)
        else:
            kept = all(world.watches[w].keeps[place] or world.watches[w].until[place] for w in watches)
            endings.append(RUNS if kept else AVOIDED)
    return Task(
        "the end" if goal == SETTLED else world.visits[goal].name,
        product.n_states,
        world.n_actions,
        start,
        product.transitions,
        tuple(endings),
        product.robustness,
        product.places,
        stream,
    )


def open_watches(world: World, path: Sequence[int]) -> tuple[int, ...]:
    """Return the watches that a path of learner states has neither broken nor brought to their end."""
    places = [world.place(state) for state in path]
    found = []
    for number, watch in enumerate(world.watches):
        if all(watch.keeps[place] and not watch.until[place] for place in places):
            found.append(number)
    return tuple(found)


def lifted(task: Task, values: Sequence[Value]) -> tuple[Value, ...]:
    """Carry a table over the environment's states, such as a reward map, to learner states.

    Not in the paper: it bridges the two numberings.

    Args:    values: one for each state of the environment.
    Returns: (n_states,) of the task.
    """
    return tuple(values[place] for place in task.places) if task.places else tuple(values)


def place(task: Task, state: int) -> int:
    """Return the state of the environment that a learner state is in. Not in the paper: see `lifted`."""
    return task.places[state] if task.places else state


def followed(task: Task, states: Sequence[int]) -> tuple[int | None, ...]:
    """Find the learner states that a recording passes through.

    Not in the paper: a bad demonstration masks a step of the learner, memory included.

    Args:    states: of the environment, (n_samples,).
    Returns: (n_samples,); None from the first sample on that the learner could not have reached: the
             recording begins elsewhere, jumps, or goes on after an end.
    """
    if not task.places:
        return tuple(states)
    found: list[int | None] = []
    state = task.start if states and states[0] == task.places[task.start] else None
    for sample, here in enumerate(states):
        if sample and state is not None:
            ahead = task.transitions[state] if task.endings[state] != VIOLATION else ()
            state = next((after for after in ahead if task.places[after] == here), None)
        found.append(state)
    return tuple(found)
