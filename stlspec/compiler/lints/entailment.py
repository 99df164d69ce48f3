"""Whether one formula holds wherever another does, and whether two can hold at the same sample.

In: the DAG and the ranges of its real nodes. Out: True only where it is certain, for every trace within the
ranges, and at every sample of it; False says nothing. Work is bounded: past a budget of steps nothing is certain.
"""

from collections.abc import Mapping, Sequence

from stlspec.compiler.ir import Interval, Node
from stlspec.compiler.ranges import INF, WHOLE, Range

_BUDGET = 200_000
_DEEPEST = 100
_LOWER, _UPPER = frozenset({"gt", "ge"}), frozenset({"lt", "le"})
_MIRRORED = {"gt": "lt", "ge": "le", "lt": "gt", "le": "ge", "eq": "eq"}
_OPPOSITE = {"gt": "le", "ge": "lt", "lt": "ge", "le": "gt"}
Box = tuple[float, bool, float, bool]
"""Values of one expression: from low (itself too, if closed) to high (itself too, if closed)."""


class Entailment:
    """The rules over one DAG; answers are kept."""

    def __init__(self, nodes: Sequence[Node], ranges: Mapping[int, Range]) -> None:
        self._nodes, self._ranges = nodes, ranges
        self._known: dict[tuple[str, int, int], bool] = {}
        self._steps = 0

    def entails(self, one: int, other: int, depth: int = 0) -> bool:
        """Tell whether `other` holds at every sample where `one` does."""
        if one == other:
            return True
        return self._once("entails", one, other, depth)

    def excludes(self, one: int, other: int, depth: int = 0) -> bool:
        """Tell whether there is no sample where both hold."""
        return self._once("excludes", min(one, other), max(one, other), depth)

    def _once(self, kind: str, one: int, other: int, depth: int) -> bool:
        key = (kind, one, other)
        if key not in self._known:
            self._steps += 1
            if self._steps > _BUDGET or depth > _DEEPEST:
                return False
            self._known[key] = False  # what is asked again below itself is not certain yet
            answer = self._entails if kind == "entails" else self._excludes
            self._known[key] = answer(one, other, depth + 1)
        return self._known[key]

    def _entails(self, one: int, other: int, depth: int) -> bool:
        a, b = self._nodes[one], self._nodes[other]
        if b.op == "true" or a.op == "false":
            return True
        box, wanted = self._box(one), self._box(other)
        if box is not None and wanted is not None and box[0] == wanted[0]:
            return _within(box[1], wanted[1])
        return (
            (a.op == "or" and all(self.entails(child, other, depth) for child in a.children))
            or (b.op == "and" and all(self.entails(one, child, depth) for child in b.children))
            or (a.op == "and" and any(self.entails(child, other, depth) for child in a.children))
            or (b.op == "or" and any(self.entails(one, child, depth) for child in b.children))
            or (a.op == b.op == "not" and self.entails(b.children[0], a.children[0], depth))
            or self._entails_in_time(a, b, one, other, depth)
        )

    def _entails_in_time(self, a: Node, b: Node, one: int, other: int, depth: int) -> bool:
        below = a.op == b.op and len(a.children) == len(b.children) == 1
        if below and a.op in ("always", "historically"):
            assert a.interval and b.interval
            if _inside(b.interval, a.interval) and self.entails(a.children[0], b.children[0], depth):
                return True
        if below and a.op in ("eventually", "once"):
            assert a.interval and b.interval
            if _inside(a.interval, b.interval) and self.entails(a.children[0], b.children[0], depth):
                return True
        # A window that begins at 0 holds the sample at hand.
        if _begins_here(a, ("always", "historically")) and self.entails(a.children[0], other, depth):
            return True
        return _begins_here(b, ("eventually", "once")) and self.entails(one, b.children[0], depth)

    def _excludes(self, one: int, other: int, depth: int) -> bool:
        a, b = self._nodes[one], self._nodes[other]
        box, wanted = self._box(one), self._box(other)
        if box is not None and wanted is not None:
            return box[0] == wanted[0] and self._is_empty(box[0], box[1], wanted[1])
        for x, y, second in ((a, b, other), (b, a, one)):
            if x.op == "false" or (x.op == "not" and self.entails(second, x.children[0], depth)):
                return True
            if x.op == "and" and any(self.excludes(child, second, depth) for child in x.children):
                return True
            if x.op == "or" and all(self.excludes(child, second, depth) for child in x.children):
                return True
            if self._excludes_in_time(x, y, second, depth):
                return True
        return False

    def _excludes_in_time(self, x: Node, y: Node, second: int, depth: int) -> bool:
        """Tell whether x, which may be `always`, excludes y at the samples that both speak of."""
        if x.op not in ("always", "historically") or x.interval is None:
            return False
        if x.interval[0] == 0 and self.excludes(x.children[0], second, depth):
            return True
        partner = {"always": "eventually", "historically": "once"}[x.op]
        return (
            y.op == partner
            and y.interval is not None
            and _inside(y.interval, x.interval)
            and self.excludes(x.children[0], y.children[0], depth)
        )

    def _box(self, index: int) -> tuple[int, Box] | None:
        """Return the expression that a comparison with a constant bounds, and the values that it allows."""
        node = self._nodes[index]
        if node.op == "not":
            inner = self._nodes[node.children[0]]
            if inner.op not in _OPPOSITE:
                return None
            node = Node(_OPPOSITE[inner.op], inner.children)
        if node.op not in _MIRRORED:
            return None
        left, right = node.children
        (low, high), op = self._ranges.get(right, WHOLE), node.op
        if low != high:
            (low, high), op, left = self._ranges.get(left, WHOLE), _MIRRORED[node.op], right
        if low != high or self._nodes[left].op == "const":
            return None
        if op == "eq":
            return left, (low, True, low, True)
        if op in _LOWER:
            return left, (low, op == "ge", INF, True)
        return left, (-INF, True, low, op == "le")

    def _is_empty(self, expression: int, *boxes: Box) -> bool:
        """Tell whether no value of an expression lies in all boxes."""
        low, high = self._ranges.get(expression, WHOLE)
        kept = [(low, True, high, True), *boxes]
        # Among equal ends the open one is the tighter.
        bottom, bottom_closed = max((b[0], not b[1]) for b in kept)
        top, top_open = min((b[2], b[3]) for b in kept)
        return bottom > top or (bottom == top and (bottom_closed or not top_open))


def _begins_here(node: Node, operators: tuple[str, ...]) -> bool:
    return node.op in operators and node.interval is not None and node.interval[0] == 0


def _within(inner: Box, outer: Box) -> bool:
    """Tell whether all of a box lies in another."""
    low = inner[0] > outer[0] or (inner[0] == outer[0] and (outer[1] or not inner[1]))
    high = inner[2] < outer[2] or (inner[2] == outer[2] and (outer[3] or not inner[3]))
    return low and high


def _inside(inner: Interval, outer: Interval) -> bool:
    """Tell whether a window lies in another."""
    return inner[0] >= outer[0] and (outer[1] is None or (inner[1] is not None and inner[1] <= outer[1]))
