"""The operand of an outermost `always`, as a conjunction of clauses over settled formulas and inner operators.

In: the DAG. Out: clauses. Each is a disjunction of one settled mix and some inner operators that look ahead, its
unknowns; each gets an engine of its own, whose cost grows with the number of unknowns. So conjunctions are
multiplied out, and two `eventually` with the same window become one. All of that moves min and max about by
the laws of lattices, which hold for the ends of enclosures as well as for values.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from stlspec.compiler.ir import FUTURE, Interval
from stlspec.compiler.ranges import INF, Range
from stlspec.semantics.online.plan import Plan

_MOST_CLAUSES = 16
_LARGEST = 64


@dataclass(frozen=True, slots=True)
class Settled:
    """A mix of formulas, as a rule settled: op is "and", "or" with parts, or "formula" with a node and its sign."""

    op: str
    parts: tuple["Settled", ...] = ()
    node: int = -1
    negated: bool = False

    @property
    def size(self) -> int:
        """How many formulas it mixes."""
        return sum(part.size for part in self.parts) or 1


@dataclass(frozen=True, slots=True)
class Unknown:
    """An inner operator: `op` is one of always, eventually, until, release. tail: of its value."""

    op: str
    interval: Interval
    operands: tuple[Settled, ...]
    tail: Range


@dataclass(frozen=True, slots=True)
class Clause:
    """The disjunction of a settled mix and of unknowns."""

    settled: Settled
    unknowns: tuple[Unknown, ...] = ()


FALSE = Settled("or")


def clauses_of(plan: Plan, index: int, negated: bool = False) -> list[Clause] | None:
    """Return a formula or its negation as a conjunction of clauses.

    Not in the paper: it serves monitors.

    Returns: clauses; None if the formula looks ahead through more than one operator, or the clauses get too many
             or too large.
    """
    return _Multiplication(plan).clauses(index, negated)


class _Multiplication:
    """Looks at each node of a shared DAG once, and stops where clauses get too many or too large."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._found: dict[tuple[int, bool], list[Clause] | None] = {}

    def clauses(self, index: int, negated: bool) -> list[Clause] | None:
        key = (index, negated)
        if key not in self._found:
            found = self._clauses(index, negated)
            if found is not None and (len(found) > _MOST_CLAUSES or any(c.settled.size > _LARGEST for c in found)):
                found = None
            self._found[key] = found
        return self._found[key]

    def _clauses(self, index: int, negated: bool) -> list[Clause] | None:
        plan = self._plan
        node = plan.nodes[index]
        if plan.settled[index]:
            return [Clause(Settled("formula", (), index, negated))]
        if node.op == "not":
            return self.clauses(node.children[0], not negated)
        if node.op in ("and", "or"):
            found = [self.clauses(child, negated) for child in node.children]
            lists = [clauses for clauses in found if clauses is not None]
            if len(lists) < len(found):
                return None
            if (node.op == "and") != negated:
                return _joined([clause for clauses in lists for clause in clauses])
            return _multiplied(lists)
        if node.op not in FUTURE or not all(plan.settled[c] for c in node.children):
            return None
        if node.op == "next" and not plan.counted:
            return None  # With gaps nobody knows when the next sample comes.
        return [Clause(FALSE, (operator_of(plan, index, negated),))]


def operator_of(plan: Plan, index: int, negated: bool) -> Unknown:
    """Return the operator of a node, a negation moved to its operands; not in the paper: it serves monitors."""
    node = plan.nodes[index]
    operands = tuple(Settled("formula", (), child, negated) for child in node.children)
    low, high = plan.tails[index]
    tail = (-high, -low) if negated else (low, high)
    if node.op == "next":
        return Unknown("always" if negated else "eventually", (1, 1), operands, tail)
    assert node.interval is not None
    dual = {"always": "eventually", "eventually": "always", "until": "release"}
    return Unknown(dual[node.op] if negated else node.op, node.interval, operands, tail)


def _multiplied(lists: Sequence[Sequence[Clause]]) -> list[Clause] | None:
    """Return the disjunction of conjunctions as a conjunction."""
    count = 1
    for clauses in lists:
        count *= len(clauses)
    if count > _MOST_CLAUSES:
        return None
    return _joined([_disjunction(choice) for choice in product(*lists)])


def _disjunction(clauses: Sequence[Clause]) -> Clause:
    settled = tuple(dict.fromkeys(clause.settled for clause in clauses if clause.settled != FALSE))
    mix = settled[0] if len(settled) == 1 else Settled("or", settled)
    unknowns: list[Unknown] = []
    for unknown in dict.fromkeys(u for clause in clauses for u in clause.unknowns):
        for i, other in enumerate(unknowns):
            if unknown.op == other.op == "eventually" and unknown.interval == other.interval:
                operand = Settled("or", (other.operands[0], unknown.operands[0]))
                tail = (max(other.tail[0], unknown.tail[0]), max(other.tail[1], unknown.tail[1]))
                unknowns[i] = Unknown("eventually", unknown.interval, (operand,), tail)
                break
        else:
            unknowns.append(unknown)
    return Clause(mix, tuple(unknowns))


def _joined(clauses: Sequence[Clause]) -> list[Clause]:
    """Return a conjunction with all its settled clauses as one, each other clause once."""
    settled = tuple(dict.fromkeys(clause.settled for clause in clauses if not clause.unknowns))
    found = list(dict.fromkeys(clause for clause in clauses if clause.unknowns))
    if settled:
        found.append(Clause(settled[0] if len(settled) == 1 else Settled("and", settled)))
    return found


def settled_tail(plan: Plan, mix: Settled) -> Range:
    """Enclose a settled mix at a sample to come."""
    if mix.op == "formula":
        low, high = plan.tails[mix.node]
        return (-high, -low) if mix.negated else (low, high)
    pick, empty = (min, INF) if mix.op == "and" else (max, -INF)
    tails = [settled_tail(plan, part) for part in mix.parts]
    return pick((t[0] for t in tails), default=empty), pick((t[1] for t in tails), default=empty)


def clause_tail(plan: Plan, clause: Clause) -> Range:
    """Enclose a clause at a sample to come."""
    tails = [settled_tail(plan, clause.settled), *(unknown.tail for unknown in clause.unknowns)]
    return max(t[0] for t in tails), max(t[1] for t in tails)


def fills(plan: Plan, unknown: Unknown) -> list[tuple[float, float, float]]:
    """Return what an unknown may still be worth, by what is known of samples to come: low, high, current.

    Not in the paper: it serves monitors.

    Returns: first while the next sample may be in its window, then while the window has not begun.
    """
    tails = [settled_tail(plan, operand) for operand in unknown.operands]
    if unknown.op in ("eventually", "until"):
        return _fills(plan, unknown.op == "until", tails[0], tails[-1])
    # The duals: their bounds are those of the negated operands, negated and swapped.
    negated = [(-high, -low) for low, high in tails]
    return [(-y, -x, -z) for x, y, z in _fills(plan, unknown.op == "release", negated[0], negated[-1])]


def _fills(plan: Plan, until: bool, left: Range, right: Range) -> list[tuple[float, float, float]]:
    running = (right[0] if plan.certain else -INF, right[1], -INF)
    if not until or not plan.dense:
        return [running, running]
    # Before the window there is at least one sample to come, at which the left operand must hold.
    return [running, (min(running[0], left[0]), min(right[1], left[1]), -INF)]
