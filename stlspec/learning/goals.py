"""Which states the spec wants visited, and what it says about their order.

In: a compiled spec. Out: `Wish`es, each a condition on the present sample under an `eventually`, with what
comes before it; `Guard`s, what is to be kept up until then; and, once both are looked up in the states of an
environment, `Visit`s and the orders in which they may be made. A formula is walked once, top down, with its
polarity: a negated `always p` is an `eventually not p`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import TEMPORAL, Node
from stlspec.compiler.printing import expression_text

_WITH_MEMORY = TEMPORAL | {"now", "delta", "rate"}


@dataclass(frozen=True, slots=True, order=True)
class Condition:
    """A formula over the present sample: the node of the formula DAG, or its negation."""

    node: int
    negated: bool = False


Conditions = tuple[Condition, ...]
"""Conditions that hold at one sample, ascending."""


@dataclass(frozen=True, slots=True)
class Wish:
    """Conditions that a requirement wants to hold together at some sample.

    requirement: its number. earliest: ticks before which it does not count. after: the numbers of the wishes
    that must have come true before (it is nested in their `eventually`). certain: whether the requirement can
    hold only if it comes true; not so on one side of an `or`, or in what a condition asks for.
    """

    conditions: Conditions
    requirement: int
    earliest: int = 0
    after: tuple[int, ...] = ()
    certain: bool = True


@dataclass(frozen=True, slots=True)
class Guard:
    """What is to hold at every sample: `keep`, until all of `until` hold (() = for good).

    hard: of a hard requirement, which is watched anyway; only what it says about the order counts.
    """

    keep: Conditions
    until: Conditions
    hard: bool


@dataclass(frozen=True, slots=True)
class Agenda:
    """All wishes and guards of a spec."""

    wishes: tuple[Wish, ...]
    guards: tuple[Guard, ...]


def momentary(nodes: Sequence[Node]) -> tuple[bool, ...]:
    """Tell for each node whether its value depends on the present sample alone.

    Not in the paper: it defines which formulas are predicates over states.

    Returns: (n_nodes,), False where a temporal operator, delta, rate or now stands in the node or below it.
    """
    found: list[bool] = []
    for node in nodes:
        found.append(node.op not in _WITH_MEMORY and all(found[child] for child in node.children))
    return tuple(found)


def find_agenda(bundle: BundleData) -> Agenda:
    """Collect what the requirements want to hold eventually, and what until then.

    Paper: the set Goals of Algorithms 2 and 3, which the paper takes as given; a negated `always p` counts as
    `eventually not p`, and a negated `eventually p` wants p never. `p until q` wants q, and p until then.

    Returns: the agenda, wishes in the order of the requirements and of their text, outer ones first.
    """
    walk = _Walk(bundle)
    for number, requirement in enumerate(bundle.requirements):
        walk.visit(requirement.root, _Place(number))
    return Agenda(tuple(walk.wishes), tuple(dict.fromkeys(walk.guards)))


@dataclass(frozen=True, slots=True)
class _Place:
    """Where in a requirement a formula stands: under a negation, under which wishes, and joined by `and` only."""

    requirement: int
    negated: bool = False
    after: tuple[int, ...] = ()
    joined: bool = True


@dataclass
class _Walk:
    """The wishes and guards found so far."""

    bundle: BundleData
    wishes: list[Wish] = field(default_factory=list)
    guards: list[Guard] = field(default_factory=list)
    _seen: set[tuple[int, _Place]] = field(default_factory=set)
    _simple: tuple[bool, ...] = ()
    _named: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        self._simple = momentary(self.bundle.nodes)
        self._named = frozenset(self.bundle.names.values())

    def visit(self, root: int, place: _Place) -> None:
        """Walk a formula; each node once in each place."""
        stack = [(root, place)]
        while stack:
            index, here = stack.pop()
            if self._simple[index] or (index, here) in self._seen:
                continue
            self._seen.add((index, here))
            stack.extend(reversed(list(self._below(index, here))))

    def _below(self, index: int, here: _Place) -> Iterator[tuple[int, _Place]]:
        """Note what a node wants, and return the nodes below it with their places."""
        node, wanted = self.bundle.nodes[index], here.negated
        if node.op == "not":
            yield node.children[0], _Place(here.requirement, not wanted, here.after, here.joined)
        elif node.op in ("and", "or"):
            joined = here.joined and (node.op == "and") != wanted
            if joined is not here.joined:
                self._weak(node, here)
            yield from ((c, _Place(here.requirement, wanted, here.after, joined)) for c in node.children)
        elif node.op == ("always" if wanted else "eventually"):
            yield from self._wish(node.children[0], here, node.interval[0] if node.interval else 0)
        elif node.op == "until" and not wanted:
            yield from self._until(node, here)
        else:
            if node.op == ("eventually" if wanted else "always") and here.joined:
                self._keep(node.children[0], here, None)
            yield from ((c, _Place(here.requirement, wanted, here.after, False)) for c in node.children)

    def _wish(self, root: int, here: _Place, earliest: int) -> list[tuple[int, _Place]]:
        """Note what is wanted at one sample, and return what is wanted from there on."""
        now, later = self._parts(root, here.negated)
        after = here.after
        if now:
            after = (*after, len(self.wishes))
            first = earliest if here.joined else 0
            self.wishes.append(Wish(now, here.requirement, first, here.after, here.joined))
        below = []
        for index, negated in later:
            place = _Place(here.requirement, negated, after, False)
            node = self.bundle.nodes[index]
            if node.op == ("and" if negated else "or"):
                # one of several is wanted: each is something to head for
                below += [further for child in node.children for further in self._wish(child, place, 0)]
            else:
                below.append((index, place))
        return below

    def _parts(self, root: int, negated: bool) -> tuple[Conditions, list[tuple[int, bool]]]:
        """Part a formula, at its `and`, into conditions on the present sample and the rest.

        `always p` joined to them is taken as p: to stay somewhere one must first get there.
        """
        now, later = set[Condition](), []
        stack = [(root, negated)]
        while stack:
            index, flipped = stack.pop()
            node = self.bundle.nodes[index]
            if self._simple[index] and index in self._named:
                now.add(Condition(index, flipped))
            elif node.op == "not":
                stack.append((node.children[0], not flipped))
            elif node.op == ("or" if flipped else "and"):
                stack.extend((child, flipped) for child in reversed(node.children))
            elif self._simple[index]:
                now.add(Condition(index, flipped))
            elif node.op == ("eventually" if flipped else "always") and self._simple[node.children[0]]:
                now.add(Condition(node.children[0], flipped))
            else:
                later.append((index, flipped))
        return tuple(sorted(now)), later

    def _until(self, node: Node, here: _Place) -> Iterator[tuple[int, _Place]]:
        left, right = node.children
        if here.joined:
            self._keep(left, here, right)
        yield left, _Place(here.requirement, here.negated, here.after, False)
        yield from self._wish(right, here, node.interval[0] if node.interval else 0)

    def _weak(self, node: Node, here: _Place) -> None:
        """Note `p unless q`, which is (p until q) or always p: q need not come, but p is kept until it does."""
        held = {self.bundle.nodes[c].children for c in node.children if self.bundle.nodes[c].op == "always"}
        for child in node.children:
            part = self.bundle.nodes[child]
            if not here.negated and part.op == "until" and part.children[:1] in held:
                self._seen.add((child, _Place(here.requirement, here.negated, here.after, False)))
                self._keep(part.children[0], here, part.children[1])

    def _keep(self, root: int, here: _Place, until: int | None) -> None:
        """Note what is to be kept up, if it is about the present sample only."""
        keep, later = self._parts(root, here.negated)
        ending: Conditions = ()
        if until is not None:
            ending, further = self._parts(until, here.negated)
            later = [*later, *further]
        if keep and not later and (ending or until is None):
            hard = self.bundle.requirements[here.requirement].strength == "hard"
            self.guards.append(Guard(keep, ending, hard))


def condition_name(bundle: BundleData, conditions: Conditions) -> str:
    """Return what the spec calls a goal: the name of its `let`, else its formula."""
    return " and ".join(_name(bundle, condition) for condition in conditions)


def _name(bundle: BundleData, condition: Condition) -> str:
    named = [name for name, node in bundle.names.items() if node == condition.node]
    if named:
        return f"not {named[0]}" if condition.negated else named[0]
    text = expression_text(bundle.nodes, condition.node)
    return f"not ({text})" if condition.negated else text
