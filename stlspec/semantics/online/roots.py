"""How the enclosure of a requirement at sample 0 is computed: which engine serves which part of its formula.

In: the DAG. Out: lines that give low, high and current of each requirement. Boolean operators at the top are
computed from the enclosures of their operands; each outermost temporal operator gets the cheapest
engine that serves it: one clamp over settled operands, queues of clamps over one level more, one table where
nothing has an end, arrays for the rest.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from stlspec.compiler.ir import Interval
from stlspec.compiler.ranges import INF
from stlspec.semantics.online.bodies import (
    Clause,
    Settled,
    Unknown,
    clause_tail,
    clauses_of,
    fills,
    operator_of,
)
from stlspec.semantics.online.corners import Corners
from stlspec.semantics.online.front import Front
from stlspec.semantics.online.general import General, inputs_of
from stlspec.semantics.online.nested import Nested
from stlspec.semantics.online.outermost import Always, First, Starting, Until
from stlspec.semantics.online.plan import DEEPEST, Plan
from stlspec.semantics.online.unending import Signed, Unending, unending_operators

MOST_UNKNOWNS = 4
"""In one clause; the tables of `corners` double with each."""

Names = tuple[str, str, str]
"""The variables of low, high and current."""


class Roots:
    """Writes enclosures; each (node, sample) once."""

    def __init__(self, plan: Plan, front: Front) -> None:
        self._plan, self._front, self._lines = plan, front, front.lines
        self._found: dict[tuple[int, int], Names] = {}

    def enclosure(self, index: int, origin: int = 0) -> Names:
        """Write the enclosure of a formula at sample number `origin`.

        It may be read from that sample on; before, its variables hold anything.
        """
        key = (index, origin)
        if key not in self._found:
            self._found[key] = self._write(index, origin)
        return self._found[key]

    def _write(self, index: int, origin: int) -> Names:
        node, lines = self._plan.nodes[index], self._lines
        below = node.children
        if self._plan.depths[index] > DEEPEST:
            return self._general(index, origin)
        if self._plan.settled[index]:
            return self._engine(lambda: First(), [self._front.value(index)], origin)
        if node.op == "not":
            low, high, current = self.enclosure(below[0], origin)
            return lines.negated(high), lines.negated(low), lines.negated(current)
        if node.op in ("and", "or"):
            operands = [self.enclosure(c, origin) for c in below]
            pick = lines.least if node.op == "and" else lines.greatest
            return pick([x[0] for x in operands]), pick([x[1] for x in operands]), pick([x[2] for x in operands])
        if node.op == "next":
            return self._next(below[0], origin)
        if node.op == "prev":
            return self.enclosure(below[0], origin - 1) if origin else ("NINF", "NINF", "NINF")
        if node.op in ("historically", "once", "since") and origin == 0:
            return self._past(index)
        return self._temporal(index, origin)

    def _next(self, child: int, origin: int) -> Names:
        """The next sample may not exist yet."""
        lines, (low, high) = self._lines, self._plan.tails[child]
        beyond = (lines.number(low if self._plan.certain else -INF), lines.number(high), "NINF")
        names = self.enclosure(child, origin + 1)
        found = [lines.let(f"{a} if n > {origin} else {b}") for a, b in zip(names, beyond, strict=True)]
        return found[0], found[1], found[2]

    def _past(self, index: int) -> Names:
        """Sample 0 has no sample before it."""
        node = self._plan.nodes[index]
        assert node.interval is not None
        if node.interval[0] == 0:
            return self.enclosure(node.children[-1], 0)
        constant = "INF" if node.op == "historically" else "NINF"
        return constant, constant, constant

    def _temporal(self, index: int, origin: int) -> Names:
        node, plan, front = self._plan.nodes[index], self._plan, self._front
        interval, below = node.interval, node.children
        if interval is not None and all(plan.settled[c] for c in below) and node.op in ("always", "until"):
            tails = [plan.tails[c] for c in below]
            names = [front.value(c) for c in below]
            if node.op == "always":
                return self._engine(lambda: Always(plan, interval, tails[0]), names, origin)
            return self._engine(lambda: Until(plan, interval, tails[0], tails[1]), names, origin)
        if interval is not None and node.op == "eventually" and plan.settled[below[0]]:
            low, high = plan.tails[below[0]]
            names = [self._lines.negated(front.value(below[0]))]
            found = self._engine(lambda: Always(plan, interval, (-high, -low)), names, origin)
            low_name, high_name, current = (self._lines.negated(name) for name in found)
            return high_name, low_name, current
        if node.op in ("always", "eventually"):
            clauses = clauses_of(plan, below[0], negated=node.op == "eventually")
            if clauses is not None and all(len(clause.unknowns) <= MOST_UNKNOWNS for clause in clauses):
                return self._conjunction(clauses, index, origin)
        endless = unending_operators(plan, (index, False))
        if endless is not None:
            return self._unending(endless, origin)
        return self._general(index, origin)

    def _general(self, index: int, origin: int) -> Names:
        plan = self._plan
        names = [self._front.value(c) for c in inputs_of(plan, index)]
        return self._called(self._lines.part(lambda: General(plan, index, origin)), names)

    def _conjunction(self, clauses: list[Clause], index: int, origin: int) -> Names:
        """Write always of a conjunction as the conjunction of always; eventually is the negation of it all."""
        lines, node = self._lines, self._plan.nodes[index]
        assert node.interval is not None
        found = [self._clause(clause, node.interval, origin) for clause in clauses]
        low, high, current = (lines.least([names[i] for names in found]) for i in range(3))
        if node.op == "always":
            return low, high, current
        return lines.negated(high), lines.negated(low), lines.negated(current)

    def _clause(self, clause: Clause, outer: Interval, origin: int) -> Names:
        plan, tail, unknowns = self._plan, clause_tail(self._plan, clause), clause.unknowns
        settled = self._mix(clause.settled)
        if not unknowns:
            return self._engine(lambda: Always(plan, outer, tail), [settled], origin)
        rows = [(u.interval, fills(plan, u), u.op in ("until", "release")) for u in unknowns]
        changes = [self._changes(unknown) for unknown in unknowns]
        if len(unknowns) == 1:
            interval, filling, waits = rows[0]
            make = partial(Nested, plan, outer, interval, tail, filling, waits)
            return self._engine(make, [settled, "INF", *changes[0]], origin)
        padded = [name for names in changes for name in [*names, "NINF", "INF"][:4]]
        return self._engine(partial(Corners, plan, outer, tail, rows), [settled, *padded], origin)

    def _unending(self, operators: list[Signed], origin: int) -> Names:
        filling = [fills(self._plan, operator_of(self._plan, *signed))[0] for signed in operators]
        names: list[str] = []
        for m in range(2 ** len(operators)):
            now: dict[Signed, str] = {}
            for i, signed in enumerate(operators):
                now[signed] = self._endless(signed, "INF" if m >> i & 1 else "NINF", now)
            names += [now[signed] for signed in operators]
        return self._engine(partial(Unending, filling, len(operators) - 1), names, origin)

    def _endless(self, signed: Signed, following: str, now: dict[Signed, str]) -> str:
        """Write an operator at this sample from its value at the next one; `now` has those under it."""
        least, greatest = self._lines.least, self._lines.greatest
        operator = operator_of(self._plan, *signed)
        names = [self._under(operand.node, operand.negated, now) for operand in operator.operands]
        if operator.op == "always":
            return least([names[0], following])
        if operator.op == "eventually":
            return greatest([names[0], following])
        if operator.op == "until":
            return greatest([names[1], least([names[0], following])])
        return least([names[1], greatest([names[0], following])])

    def _under(self, index: int, negated: bool, now: dict[Signed, str]) -> str:
        """Write a Boolean mix of settled formulas and of operators whose values are known."""
        node = self._plan.nodes[index]
        if (index, negated) in now:
            return now[index, negated]
        if self._plan.settled[index]:
            name = self._front.value(index)
            return self._lines.negated(name) if negated else name
        if node.op == "not":
            return self._under(node.children[0], not negated, now)
        pick = self._lines.least if (node.op == "and") != negated else self._lines.greatest
        now[index, negated] = pick([self._under(child, negated, now) for child in node.children])
        return now[index, negated]

    def _mix(self, mix: Settled) -> str:
        """Write a settled mix."""
        if mix.op == "formula":
            name = self._front.value(mix.node)
            return self._lines.negated(name) if mix.negated else name
        pick = self._lines.least if mix.op == "and" else self._lines.greatest
        return pick([self._mix(part) for part in mix.parts])

    def _changes(self, unknown: Unknown) -> list[str]:
        """Write what a sample does to an inner operator: the clamp in its window, and that before it."""
        lines, names = self._lines, [self._mix(operand) for operand in unknown.operands]
        if unknown.op == "eventually":
            return [names[0], "INF"]
        if unknown.op == "always":
            return ["NINF", names[0]]
        if unknown.op == "until":
            return [names[1], lines.greatest(names), "NINF", names[0]]
        return [lines.least(names), names[1], names[0], "INF"]

    def _engine(self, make: Callable[[], Any], names: list[str], origin: int) -> Names:
        part = self._lines.part(make if origin == 0 else lambda: Starting(make(), origin))
        return self._called(part, names)

    def _called(self, part: str, names: list[str]) -> Names:
        number = part[1:]
        low, high, current = f"l{number}", f"h{number}", f"c{number}"
        self._lines.add(f"{low}, {high}, {current} = {part}(T, {', '.join(names)})")
        return low, high, current
