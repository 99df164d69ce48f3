"""How the enclosure of a requirement at sample 0 is computed: which engine serves which part of its formula.

In: the DAG. Out: lines that give low, high and current of each requirement. Boolean operators at the top are
computed from the enclosures of their operands; each outermost temporal operator gets the cheapest
engine that serves it: one clamp over settled operands, queues of clamps over one level more, arrays for the rest.
"""

from functools import partial

from stlspec.compiler.ir import Interval
from stlspec.semantics.online.bodies import (
    Body,
    Inner,
    Signed,
    body_of,
    conjuncts,
    fills,
    inner_of,
    tail_of,
    variables,
    write,
)
from stlspec.semantics.online.corners import Corners
from stlspec.semantics.online.front import Front
from stlspec.semantics.online.general import General, inputs_of
from stlspec.semantics.online.nested import Nested
from stlspec.semantics.online.outermost import Always, First, Starting, Until
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.ranges import INF

MOST_VARIABLES = 4

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
            body = body_of(plan, below[0], negated=node.op == "eventually")
            parts = [] if body is None else conjuncts(body)
            if parts and all(len(variables(part)) <= MOST_VARIABLES for part in parts):
                return self._conjunction(parts, index, origin)
        names = [front.value(c) for c in inputs_of(plan, index)]
        return self._called(self._lines.part(lambda: General(plan, index, origin)), names)

    def _conjunction(self, parts: list[Body], index: int, origin: int) -> Names:
        """always of a conjunction is the conjunction of always; eventually is the negation of it all."""
        lines, node = self._lines, self._plan.nodes[index]
        assert node.interval is not None
        found = [self._part(part, node.interval, origin) for part in parts]
        low, high, current = (lines.least([names[i] for names in found]) for i in range(3))
        if node.op == "always":
            return low, high, current
        return lines.negated(high), lines.negated(low), lines.negated(current)

    def _part(self, body: Body, outer: Interval, origin: int) -> Names:
        plan, tail, unknown = self._plan, tail_of(self._plan, body), variables(body)
        if not unknown:
            return self._engine(lambda: Always(plan, outer, tail), [self._corner(body, {})], origin)
        if len(unknown) > 1:
            return self._corners(body, unknown, outer, origin)
        inner = inner_of(plan, unknown[0])
        make = partial(Nested, plan, outer, inner.interval, tail, fills(plan, inner), inner.op in ("until", "release"))
        names = [self._corner(body, {unknown[0]: end}) for end in ("NINF", "INF")]
        return self._engine(make, [*names, *self._changes(inner)], origin)

    def _corners(self, body: Body, unknown: list[Signed], outer: Interval, origin: int) -> Names:
        plan, tail = self._plan, tail_of(self._plan, body)
        inners = [inner_of(plan, variable) for variable in unknown]
        rows = [(x.interval, fills(plan, x), x.op in ("until", "release")) for x in inners]
        names = []
        for m in range(2 ** len(unknown)):
            ends = {variable: "INF" if m >> i & 1 else "NINF" for i, variable in enumerate(unknown)}
            names.append(self._corner(body, ends))
        for inner in inners:
            names += [*self._changes(inner), "NINF", "INF"][:4]
        return self._engine(partial(Corners, plan, outer, tail, rows), names, origin)

    def _corner(self, body: Body, values: dict[Signed, str]) -> str:
        return write(body, values, self._signed, self._lines.least, self._lines.greatest)

    def _signed(self, signed: Signed) -> str:
        name = self._front.value(signed[0])
        return self._lines.negated(name) if signed[1] else name

    def _changes(self, inner: Inner) -> list[str]:
        """Write what a sample does to an inner operator: the clamp in its window, and that before it."""
        lines, names = self._lines, [self._signed(operand) for operand in inner.operands]
        if inner.op == "eventually":
            return [names[0], "INF"]
        if inner.op == "always":
            return ["NINF", names[0]]
        if inner.op == "until":
            return [names[1], lines.greatest(names), "NINF", names[0]]
        return [lines.least(names), names[1], names[0], "INF"]

    def _engine(self, make, names, origin: int) -> Names:  # type: ignore[no-untyped-def]
        part = self._lines.part(make if origin == 0 else lambda: Starting(make(), origin))
        return self._called(part, names)

    def _called(self, part: str, names: list[str]) -> Names:
        number = part[1:]
        low, high, current = f"l{number}", f"h{number}", f"c{number}"
        self._lines.add(f"{low}, {high}, {current} = {part}(T, {', '.join(names)})")
        return low, high, current
