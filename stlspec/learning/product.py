"""The states that the learner tells apart: those of an environment, times what hard requirements remember.

In: a compiled spec, an environment, its transitions. Out: a `Product`. A hard requirement of the form `always
p`, p about the present sample, remembers nothing: it forbids states. One that can be lost only by the run's
ending, `eventually p`, is a goal and nothing else. Any other becomes a machine (`memory`) that runs beside the
environment; together they are explored from the start, so that only states that can be reached are counted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

from stlspec.compiler.bundle import BundleData, Requirement
from stlspec.compiler.ir import Node
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.learning.goals import Condition, momentary
from stlspec.learning.memory import (
    FutureInPastError,
    Machine,
    MachineState,
    at_end,
    first_state,
    make_machine,
    read,
    size_of,
)
from stlspec.learning.tables import over_steps, over_time, tabulate

MOST_STATES = 100_000
_MOST_TIMED = 4_000_000

_UNBOUNDED = (None, (0, None))


@dataclass(frozen=True, slots=True)
class Product:
    """Learner states and the steps between them; row = number of the state.

    places: (n_states,), the state of the environment in each; () = they are the environment's own. start: the
    one in which a run begins. transitions: (n_states, n_actions), the next states; a run ends where a hard
    requirement is violated, so nothing leads on from there. violating: (n_states,). settled: (n_states,),
    whether the hard requirements with memory hold if the run ends here; () = they do. clock: (n_states,), the
    samples before this one, counted up to the last that matters; () = none does. robustness: (n_states,
    n_hard), of what hard requirements without memory demand always. forbidden: the states of the environment
    in which one of these is violated, whatever the way there.
    """

    places: tuple[int, ...]
    start: int
    transitions: tuple[tuple[int, ...], ...]
    violating: tuple[bool, ...]
    settled: tuple[bool, ...]
    clock: tuple[int, ...]
    robustness: tuple[tuple[float, ...], ...]
    forbidden: tuple[bool, ...]

    @property
    def n_states(self) -> int:
        """The number of learner states."""
        return len(self.transitions)


@dataclass(frozen=True, slots=True)
class Split:
    """Hard requirements by what watching them takes.

    plain: for each requirement without memory its conditions. remembering: those with memory.
    """

    plain: tuple[tuple[Condition, ...], ...]
    remembering: tuple[Requirement, ...]


def step_conditions(bundle: BundleData, requirement: Requirement) -> tuple[Condition, ...] | None:
    """Find the conditions that a hard requirement demands of every sample on its own.

    Paper: hard requirements "typically have the form always(phi)"; Algorithm 2 watches them step by step.

    Returns: the conditions; all of them hold at every sample exactly if the requirement holds. None if it is
             not `always` of conditions over the present sample.
    """
    simple = momentary(bundle.nodes)
    found: list[Condition] = []
    stack = [(requirement.root, False)]
    while stack:
        index, negated = stack.pop()
        node = bundle.nodes[index]
        if node.op == "not":
            stack.append((node.children[0], not negated))
        elif node.op == ("or" if negated else "and") and not simple[index]:
            stack.extend((child, negated) for child in reversed(node.children))
        elif (
            node.op == ("eventually" if negated else "always")
            and simple[node.children[0]]
            and node.interval in _UNBOUNDED
        ):
            found.append(Condition(node.children[0], negated))
        else:
            return None
    return tuple(found)


def split_hard(bundle: BundleData) -> Split:
    """Sort the hard requirements by what watching them takes; those that only a goal can meet are left out."""
    plain, remembering = [], []
    for requirement in bundle.requirements:
        if requirement.strength != "hard":
            continue
        conditions = step_conditions(bundle, requirement)
        if conditions is not None:
            plain.append(conditions)
        elif not _never_lost(bundle.nodes, requirement.root):
            remembering.append(requirement)
    return Split(tuple(plain), tuple(remembering))


def _never_lost(nodes: Sequence[Node], root: int) -> bool:
    """Tell whether a formula is `eventually` without bounds all over: while a run lasts it can still hold."""
    simple, stack = momentary(nodes), [(root, False)]
    while stack:
        index, inside = stack.pop()
        node = nodes[index]
        if node.op in ("and", "or") and not simple[index]:
            stack.extend((child, inside) for child in node.children)
        elif node.op == "eventually" and node.interval in _UNBOUNDED:
            stack.append((node.children[0], True))
        elif not (inside and simple[index]):
            return False
    return True


def make_product(
    bundle: BundleData,
    environment: Environment,
    transitions: Sequence[Sequence[int]],
    *,
    longest: int,
    earliest: int = 0,
) -> Product:
    """Find the learner states.

    Not in the paper: decision 13, hard requirements that are not Markov in the environment's state.

    Args:    transitions: of the environment, deterministic. longest: steps of the longest run; what lies further
             apart is not told apart. earliest: a number of samples that must be told apart in any case, for goals
             that do not count before.
    Returns: the product; the environment itself, state for state, where nothing is remembered.
    Raises:  UsageError D868: a hard requirement cannot be watched; D878: there are too many states.
    """
    assert environment.start is not None
    split = split_hard(bundle)
    values, holds = tabulate(bundle, [c for row in split.plain for c in row], environment)
    forbidden = [any(not holds[c][s] for row in split.plain for c in row) for s in range(environment.n_states)]
    lows = [list(map(min, zip(*(values[c] for c in row), strict=True))) for row in split.plain]
    robustness = tuple(zip(*lows, strict=True)) if lows else ((),) * environment.n_states
    if not split.remembering and not earliest:
        rows = tuple(map(tuple, transitions))
        return Product((), environment.start, rows, tuple(forbidden), (), (), robustness, tuple(forbidden))
    machine = _machine(bundle, split.remembering, longest)
    letters = _Letters(bundle, environment, transitions, machine, split.remembering, longest, earliest)
    explorer = _Explorer(environment, transitions, forbidden, machine, letters, split.remembering)
    return explorer.explore(robustness)


def _machine(bundle: BundleData, requirements: Sequence[Requirement], longest: int) -> Machine:
    """Make the machine of requirements; a window that no run outlasts has no end, so that nothing counts up to it."""
    for requirement in requirements:
        try:
            make_machine(bundle.nodes, [requirement.root], bundle.time)
        except FutureInPastError:
            _refuse(requirement, "a past operator stands over `always`, `eventually`, `until` or `next`")
    machine = make_machine(bundle.nodes, [r.root for r in requirements], bundle.time)
    windows = {i: (low, None if high is None or high > longest else high) for i, (low, high) in machine.windows.items()}
    return replace(machine, windows=windows)


def _refuse(requirement: Requirement, reason: str) -> NoReturn:
    raise UsageError([diagnostic("D868", requirement=requirement.name, reason=reason)])


class _Letters:
    """Looks up which letters of a machine hold when a state is entered from another at some time."""

    def __init__(
        self,
        bundle: BundleData,
        environment: Environment,
        transitions: Sequence[Sequence[int]],
        machine: Machine,
        requirements: Sequence[Requirement],
        longest: int,
        earliest: int,
    ) -> None:
        kinds = [_kind(bundle, source, requirements) for source in machine.sources]
        self._kinds = kinds
        by_kind = {kind: [s for s, k in zip(machine.sources, kinds, strict=True) if k == kind] for kind in set(kinds)}
        still = [Condition(s) for s in by_kind.get("state", [])]
        holds = tabulate(bundle, still, environment)[1]
        self._state = {c.node: row for c, row in holds.items()}
        moved = by_kind.get("step", [])
        steps = sorted({(s, after) for s, row in enumerate(transitions) for after in row}) if moved else []
        # at the first sample nothing has changed, as if one had stood there before
        steps += [(s, s) for s in range(environment.n_states)] if moved else []
        tables = over_steps(bundle, moved, environment, steps) if moved else []
        self._step = {root: dict(zip(steps, table, strict=True)) for root, table in zip(moved, tables, strict=True)}
        timed = by_kind.get("time", [])
        self.last = earliest
        self._time: dict[int, list[list[bool]]] = {}
        if timed:
            until = max(earliest, min(longest, _MOST_TIMED // max(1, environment.n_states)))
            table_of = over_time(bundle, timed, environment, until)
            changes = [int(k) + 1 for t in table_of for k in (t[1:] != t[:-1]).any(axis=1).nonzero()[0]]
            self.last = max(earliest, *changes) if changes else earliest
            self._time = {root: table[: self.last + 1].tolist() for root, table in zip(timed, table_of, strict=True)}
        self._sources = machine.sources

    def __call__(self, before: int, state: int, time: int) -> tuple[bool, ...]:
        """Return which letters hold in `state`, entered from `before` (itself at the start) at sample `time`."""
        found = []
        for source, kind in zip(self._sources, self._kinds, strict=True):
            if kind == "state":
                found.append(self._state[source][state])
            elif kind == "step":
                found.append(self._step[source][before, state])
            else:
                found.append(self._time[source][time][state])
        return tuple(found)


def _kind(bundle: BundleData, root: int, requirements: Sequence[Requirement]) -> str:
    """Tell what a letter depends on: the state, the step that led to it, or the state and the time."""
    nodes = bundle.nodes
    deepest: dict[int, tuple[int, bool]] = {}
    for index in range(root + 1):
        inner = [deepest[c] for c in nodes[index].children]
        back = max((d for d, _ in inner), default=0) + (nodes[index].op in ("delta", "rate"))
        deepest[index] = back, nodes[index].op == "now" or any(t for _, t in inner)
    back, timed = deepest[root]
    if back > 1 or (back and timed):
        what = "delta or rate of delta or rate" if back > 1 else "both delta or rate and now"
        user = next(r for r in requirements if _uses(nodes, r.root, root))
        _refuse(user, f"a comparison in it has {what}")
    return "step" if back else "time" if timed else "state"


def _uses(nodes: Sequence[Node], root: int, wanted: int) -> bool:
    stack, seen = [root], set[int]()
    while stack:
        index = stack.pop()
        if index not in seen:
            seen.add(index)
            stack.extend(nodes[index].children)
    return wanted in seen


class _Explorer:
    """Walks environment, machine and clock together, breadth first."""

    def __init__(
        self,
        environment: Environment,
        transitions: Sequence[Sequence[int]],
        forbidden: Sequence[bool],
        machine: Machine,
        letters: _Letters,
        requirements: Sequence[Requirement],
    ) -> None:
        self.environment = environment
        self.requirements = requirements
        self.transitions = transitions
        self.forbidden = forbidden
        self.machine = machine
        self.letters = letters
        self.numbers: dict[tuple[int, int, int], int] = {}
        self.states: list[tuple[int, int, int]] = []
        self.memories: dict[MachineState, int] = {}
        self.known: list[MachineState] = []
        self.read: dict[tuple[int, tuple[bool, ...]], int] = {}

    def memory(self, state: MachineState) -> int:
        """Number a state of the machine."""
        if state not in self.memories:
            self.memories[state] = len(self.known)
            self.known.append(state)
        return self.memories[state]

    def enter(self, before: int, place: int, time: int, memory: int) -> int:
        """Number the learner state that is reached by entering a place."""
        holds = self.letters(before, place, time)
        key = memory, holds
        if key not in self.read:
            self.read[key] = self.memory(self.after(memory, holds))
        state = place, time, self.read[key]
        if state not in self.numbers:
            self.numbers[state] = len(self.states)
            self.states.append(state)
            if len(self.states) > MOST_STATES:
                raise UsageError([diagnostic("D878", places=self.environment.n_states, most=f"{MOST_STATES:,}")])
        return self.numbers[state]

    def after(self, memory: int, holds: Sequence[bool]) -> MachineState:
        """Let the machine read a sample; refuse what asks more of the rest with every sample, without an end."""
        try:
            return read(self.machine, self.known[memory], holds)
        except RecursionError:
            demands = [size_of(residual) for residual in self.known[memory][0]]
        requirement = self.requirements[demands.index(max(demands))]
        _refuse(requirement, "what it asks of the samples to come grows with every sample")

    def lost(self, number: int) -> bool:
        """Tell whether a hard requirement is violated in a learner state."""
        place, _, memory = self.states[number]
        return self.forbidden[place] or any(r is False for r in self.known[memory][0])

    def explore(self, robustness: Sequence[tuple[float, ...]]) -> Product:
        """Find all learner states that can be reached."""
        start = self.environment.start
        assert start is not None
        self.enter(start, start, 0, self.memory(first_state(self.machine)))
        rows: list[tuple[int, ...]] = []
        violating: list[bool] = []
        while len(rows) < len(self.states):
            number = len(rows)
            place, time, memory = self.states[number]
            violating.append(self.lost(number))
            if violating[-1] or place in self.environment.terminal:
                rows.append((number,) * self.environment.n_actions)
                continue
            later = min(time + 1, self.letters.last)
            rows.append(tuple(self.enter(place, after, later, memory) for after in self.transitions[place]))
        return Product(
            tuple(place for place, _, _ in self.states),
            0,
            tuple(rows),
            tuple(violating),
            tuple(all(at_end(self.machine, r) for r in self.known[memory][0]) for _, _, memory in self.states),
            tuple(time for _, time, _ in self.states),
            tuple(robustness[place] for place, _, _ in self.states),
            tuple(self.forbidden),
        )
