"""Hard requirements as a machine with finitely many states, which reads one sample after another.

In: formulas, and at each sample which of their conditions hold. Out: states of the machine, plain tuples, and
whether a formula can no longer hold, whatever follows. What lies ahead is kept by rewriting: a formula becomes
what is left to demand of the next sample, its windows one sample shorter. What lies behind is kept as the ages
of the samples that may still matter, saturated where older ones count the same. So equal states have equal
futures, and there are few of them.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.ir import FUTURE, PAST, TEMPORAL, Node, reachable
from stlspec.learning.goals import momentary

Residual: TypeAlias = bool | tuple[Any, ...]
"""What is left to demand: True, False, ("at", node) of the next sample, which there must be,
("window", node, low, high) counted from the next sample, ("not", r), ("and", {r...}) or ("or", {r...})."""

Window = tuple[int, int | None]
"""Samples, both ends included; None = without end. Empty if the end comes first."""

MachineState = tuple[tuple[Residual, ...], tuple[int, ...]]
"""What is left of each formula, and what each past operator remembers."""


class FutureInPastError(Exception):
    """A past operator stands over a future one, so that its value is not known when its sample comes."""


@dataclass(frozen=True, slots=True)
class Machine:
    """The formulas of a machine, prepared.

    nodes: the DAG, cut to what the formulas need. roots: the formulas. letters: the nodes that a reader looks up
    at each sample: conditions on the present, `delta`, `rate` and `now` included. sources: for each letter its
    node in the DAG of the bundle. past: the past operators, children first. windows: in samples.
    """

    nodes: tuple[Node, ...]
    roots: tuple[int, ...]
    letters: tuple[int, ...]
    sources: tuple[int, ...]
    past: tuple[int, ...]
    windows: dict[int, Window]


def make_machine(nodes: Sequence[Node], roots: Sequence[int], time: TimeBase) -> Machine:
    """Prepare formulas for reading.

    Not in the paper: its hard requirements have no memory.

    Args:    nodes: the DAG of a bundle. roots: the formulas. time: of the spec, "step" or "period".
    Returns: the machine.
    Raises:  FutureInPastError: a past operator stands over a future one.
    """
    cut, places = reachable(nodes, roots)
    back = {new: old for old, new in places.items()}
    simple = momentary(cut)
    ahead = [False] * len(cut)
    letters = sorted(_tops(cut, simple, [places[r] for r in roots]))
    for index, node in enumerate(cut):
        ahead[index] = node.op in FUTURE or any(ahead[c] for c in node.children)
        if node.op in PAST and any(ahead[c] for c in node.children):
            raise FutureInPastError
    windows = {i: samples_of(n.interval or (0, None), time) for i, n in enumerate(cut) if n.op in TEMPORAL}
    past = tuple(i for i, node in enumerate(cut) if node.op in PAST)
    return Machine(cut, tuple(places[r] for r in roots), tuple(letters), tuple(back[i] for i in letters), past, windows)


def _tops(nodes: Sequence[Node], simple: Sequence[bool], roots: Iterable[int]) -> set[int]:
    """Return the largest formulas over the present sample, and the comparisons with delta, rate or now."""
    found, stack = set[int](), list(roots)
    seen = set[int]()
    while stack:
        index = stack.pop()
        if index in seen:
            continue
        seen.add(index)
        node = nodes[index]
        if simple[index] or (node.op not in TEMPORAL and node.op not in ("and", "or", "not")):
            found.add(index)
        else:
            stack.extend(node.children)
    return found


def samples_of(interval: tuple[int, int | None], time: TimeBase) -> Window:
    """Turn an interval of ticks into the samples that lie in it.

    Not in the paper: between two steps of an environment passes one period of the spec.
    """
    low, high = interval
    period = time.period or 1
    return -(-low // period), None if high is None else high // period


def first_state(machine: Machine) -> MachineState:
    """Return the state before the first sample."""
    return tuple(("at", root) for root in machine.roots), (0,) * len(machine.past)


def read(machine: Machine, state: MachineState, holds: Sequence[bool]) -> MachineState:
    """Read one sample.

    Not in the paper: formula progression for the future (Bacchus and Kabanza 1998), ages for the past.

    Args:    state: before the sample. holds: (n_letters,), whether each letter holds at it.
    Returns: the state after it. A formula that became False cannot hold any more, however the trace goes on.
    """
    residuals, memory = state
    known: dict[int, Residual] = dict(zip(machine.letters, holds, strict=True))
    reader = _Reader(machine, known)
    later = []
    for index, remembered in zip(machine.past, memory, strict=True):
        known[index], after = _past(machine, index, remembered, lambda child: reader.value(child) is True)
        later.append(after)
    return tuple(reader.read(r) for r in residuals), tuple(later)


def at_end(machine: Machine, residual: Residual) -> bool:
    """Tell whether a formula holds if there are no more samples: a window without samples decides it."""
    if isinstance(residual, bool):
        return residual
    if residual[0] == "at":
        return False
    if residual[0] == "window":
        return machine.nodes[residual[1]].op == "always"
    if residual[0] == "not":
        return not at_end(machine, residual[1])
    return (all if residual[0] == "and" else any)(at_end(machine, part) for part in residual[1])


def size_of(residual: Residual) -> int:
    """Return of how many demands a residual consists. Not in the paper: error handling."""
    pending, size = [residual], 0
    while pending:
        part = pending.pop()
        size += 1
        if isinstance(part, tuple) and part[0] in ("not", "and", "or"):
            pending.extend([part[1]] if part[0] == "not" else part[1])
    return size


def _past(machine: Machine, index: int, memory: int, holds: Callable[[int], bool]) -> tuple[bool, int]:
    """Return the value of a past operator, and what it remembers after this sample.

    Memory is a set of ages as bits: bit k for the sample k before the last one. `p since q` remembers the
    samples of q after which p has held; `once q` is `true since q`, `historically q` is `not once not q`.
    """
    node = machine.nodes[index]
    if node.op == "prev":
        return bool(memory), int(holds(node.children[0]))
    low, high = machine.windows[index]
    kept = node.op != "since" or holds(node.children[0])
    wanted = holds(node.children[-1]) != (node.op == "historically")
    ages = (memory << 1 if kept else 0) | wanted
    if high is None:
        # only the oldest counts, and beyond the near end of the window its age no longer matters
        ages = 1 << min(ages.bit_length() - 1, low) if ages else 0
        found = bool(ages >> low)
    else:
        found = high >= low and bool(ages >> low & (1 << high - low + 1) - 1)
        ages &= (1 << max(high, 0)) - 1
        if low == 0:
            ages &= -ages  # only the youngest counts
    return found != (node.op == "historically"), ages


class _Reader:
    """Rewrites formulas at one sample; values of nodes are kept, since they are shared."""

    def __init__(self, machine: Machine, known: dict[int, Residual]) -> None:
        self.machine = machine
        self.known = known

    def read(self, residual: Residual) -> Residual:
        """Turn what is demanded of this sample into what is demanded of the next."""
        if isinstance(residual, bool):
            return residual
        if residual[0] == "at":
            return self.value(residual[1])
        if residual[0] == "window":
            return self._window(*residual[1:])
        if residual[0] == "not":
            return _negated(self.read(residual[1]))
        return self._joined(residual[0], [self.read(part) for part in residual[1]])

    def value(self, index: int) -> Residual:
        """Return what a formula demands of the samples after this one."""
        if index not in self.known:
            self.known[index] = self._value(index)
        return self.known[index]

    def _value(self, index: int) -> Residual:
        node = self.machine.nodes[index]
        if node.op == "not":
            return _negated(self.value(node.children[0]))
        if node.op in ("and", "or"):
            return self._joined(node.op, [self.value(child) for child in node.children])
        if node.op == "next":
            return "at", node.children[0]
        return self._window(index, *self.machine.windows[index])

    def _window(self, index: int, low: int, high: int | None) -> Residual:
        node = self.machine.nodes[index]
        if high is not None and high < low:
            return node.op == "always"
        ahead: Residual = node.op == "always"
        if high is None or high > 0:
            ahead = ("window", index, max(low - 1, 0), None if high is None else high - 1)
        if node.op == "until":
            ahead = self._joined("and", [self.value(node.children[0]), ahead])
        if low > 0:
            return ahead
        return self._joined("and" if node.op == "always" else "or", [self.value(node.children[-1]), ahead])

    def _joined(self, op: str, parts: Iterable[Residual]) -> Residual:
        """Join demands; of windows that differ in their end alone one implies the others."""
        decided = op == "or"
        found: dict[Any, Residual] = {}
        for part in _flat(op, parts):
            if part is decided:
                return decided
            if part is (not decided):
                continue
            key, other = self._key(op, part, found)
            found[key] = part if other is None else other
        if len(found) <= 1:
            return next(iter(found.values()), not decided)
        return op, frozenset(found.values())

    def _key(self, op: str, part: Residual, found: dict[Any, Residual]) -> tuple[Any, Residual | None]:
        """Return what identifies a demand up to the end of its window, and the stronger one of two such."""
        assert not isinstance(part, bool)
        inner, flipped = (part[1], True) if part[0] == "not" else (part, False)
        if isinstance(inner, bool) or inner[0] != "window" or inner[2] != 0:
            return part, None
        key = (flipped, inner[1])
        other = found.get(key)
        if other is None:
            return key, None
        assert not isinstance(other, bool)
        rival = other[1] if flipped else other
        always = self.machine.nodes[inner[1]].op == "always"
        # joined by `and`, the longest `always` and the shortest `eventually` or `until` imply the others
        longest = always == ((op == "and") != flipped)
        longer = inner[3] is None or (rival[3] is not None and inner[3] > rival[3])
        return key, part if longer == longest else other


def _flat(op: str, parts: Iterable[Residual]) -> Iterable[Residual]:
    for part in parts:
        if isinstance(part, tuple) and part[0] == op:
            yield from part[1]
        else:
            yield part


def _negated(residual: Residual) -> Residual:
    if isinstance(residual, bool):
        return not residual
    return residual[1] if residual[0] == "not" else ("not", residual)
