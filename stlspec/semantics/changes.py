"""Changes: to which value one sample of a signal must go for a predicate to change its truth.

In: a predicate, a trace, a sample, a signal. Out: the nearest such values above and below, as people write
numbers. Floats in order are whole numbers in order (their bits), so a search by halves over all of them takes
64 steps, from an infinity too, and ends at two neighbouring floats, whatever the predicate computes.
"""

import math
import operator
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stlspec.compiler.bundle import Signal
from stlspec.compiler.constants import fold
from stlspec.compiler.ir import Node
from stlspec.compiler.printing import number_text
from stlspec.semantics.relaxation import memory, signal_nodes
from stlspec.semantics.robustness import needed_nodes
from stlspec.traces import Trace

Sides = Callable[[float], tuple[float, float]]
"""The two sides of a predicate, given the value of the sample."""

_LARGEST = 1.7976931348623157e308
_PROBES = 48
_SAME = 1e-12
_MOST_NODES = 2000
_COMPARE: dict[str, Callable[[float, float], bool]] = {
    "lt": operator.lt,
    "le": operator.le,
    "gt": operator.gt,
    "ge": operator.ge,
    "eq": operator.eq,
    "ne": operator.ne,
}


@dataclass(frozen=True, slots=True)
class Change:
    """One sample of one signal, taken to another value.

    before: the value as recorded. bound: the nearest value that flips, as a short number that differs from it by
    no more than rounding errors do; strict: the bound itself does not flip, what lies beyond it does. value: one
    that flips: the bound, or a number next to it. beyond: so does every value farther off. boolean: 1.0 and 0.0
    stand for true and false.
    """

    signal: str
    sample: int
    before: float
    bound: float
    strict: bool
    value: float
    beyond: bool = False
    boolean: bool = False

    @property
    def text(self) -> str:
        """The change in words, such as "d_obs at sample 3 from 0 to at least 1"."""
        if self.boolean:
            before = "true" if self.before else "false"
        else:
            before = f"{self.before + 0.0:.6g}"
            before = _shown(self.before) if before == _shown(self.bound) else before
        return f"{self.signal} at sample {self.sample} from {before} to {self.target}"

    @property
    def target(self) -> str:
        """Where to, in words, such as "at least 1"."""
        if self.boolean:
            return "true" if self.value else "false"
        up = self.value > self.before
        words = ""
        if self.strict:
            words = ("more than " if up else "less than ") if self.beyond else ("just above " if up else "just below ")
        elif self.beyond:
            words = "at least " if up else "at most "
        return f"{words}{_shown(self.bound)}"


def flipping_changes(
    nodes: Sequence[Node], predicate: int, trace: Trace, at: int, signal: Signal, sample: int
) -> list[Change]:
    """Find the nearest changes of one sample that flip a predicate at sample `at`, upwards and downwards.

    Not in the paper: it says what a demonstration should have done.

    Args:    nodes: the DAG. predicate: a comparison or a Boolean signal. trace: one trace. at: where the
             predicate is taken. signal: declared; its range is kept to. sample: the one to change.
    Returns: at most two; only the predicate was looked at, not the requirement.
    """
    before = float(trace.signals[signal.name][sample])
    if nodes[predicate].op == "bool":
        after = 1.0 - before
        return [Change(signal.name, sample, before, after, False, after, boolean=True)]
    sides = _sides(nodes, predicate, trace, at, signal.name, sample)
    if sides is None:
        return []
    compare, now = _COMPARE[nodes[predicate].op], sides(before)
    truth = compare(*now)

    def flipped(x: float) -> bool:
        left, right = sides(x)
        return left == left and right == right and compare(left, right) != truth

    low = -_LARGEST if signal.low is None else max(signal.low, -_LARGEST)
    high = _LARGEST if signal.high is None else min(signal.high, _LARGEST)
    roots = _roots(sides, before if math.isfinite(before) else min(max(0.0, low), high))
    found = []
    for limit in (high, low):
        if (limit > before) == (limit == high) and limit != before:
            nearest = _nearest(flipped, before, limit, roots)
            if nearest is not None:
                found.append(_written(flipped, signal.name, sample, before, *nearest, (low, high)))
    return found


def direction(nodes: Sequence[Node], root: int, name: str) -> int | None:
    """Say which way a signal works on a formula.

    Not in the paper: it tells "at least 1" from "1".

    Returns: 1 if raising any sample of the signal never lowers the robustness, -1 if lowering it never does,
        0 if the formula does not depend on it, None if none of these is sure.
    """
    ways: dict[int, int | None] = {}
    for index in needed_nodes(nodes, [root]):
        node = nodes[index]
        ways[index] = _way(node, [ways[c] for c in node.children], nodes, name)
    return ways[root]


def _way(node: Node, below: list[int | None], nodes: Sequence[Node], name: str) -> int | None:
    if node.op in ("signal", "bool"):
        return int(node.value == name)
    if not any(way != 0 for way in below):
        return 0
    if node.op in ("neg", "not"):
        return _turned(below[0])
    if node.op in ("sub", "ge", "gt"):
        return _joint([below[0], _turned(below[1])])
    if node.op in ("le", "lt"):
        return _joint([_turned(below[0]), below[1]])
    if node.op in ("mul", "div"):
        factors = [nodes[c].value for c in node.children if nodes[c].op == "const"]
        if len(factors) < len(below) - 1 or (node.op == "div" and nodes[node.children[1]].op != "const"):
            return None
        product = math.prod(float(f or 0.0) for f in factors)
        way = _joint(below)
        return None if not product else way if product > 0 else _turned(way)
    if node.op in ("eq", "ne", "abs", "sqrt", "log", "sin", "cos", "hypot", "pow", "delta", "rate"):
        return None
    return _joint(below)


def _turned(way: int | None) -> int | None:
    return None if way is None else -way


def _joint(ways: list[int | None]) -> int | None:
    kinds = {way for way in ways if way != 0}
    return kinds.pop() if len(kinds) == 1 else 0 if not kinds else None


def _sides(nodes: Sequence[Node], predicate: int, trace: Trace, at: int, name: str, sample: int) -> Sides | None:
    """Return the two sides as a function of one sample; None if the predicate is too large to search."""
    left, right = nodes[predicate].children
    needed = needed_nodes(nodes, [left, right])
    first = max(0, at - memory(nodes[: predicate + 1])[predicate])
    if len(needed) * (at - first + 1) > _MOST_NODES:
        return None
    uses = signal_nodes(nodes[: predicate + 1])
    varying = [i for i in needed if name in uses[i]]
    rows: list[dict[int, float]] = []
    for k in range(first, at + 1):
        rows.append({})
        for index in needed:
            rows[-1][index] = _number_at(nodes[index], k, rows[-1], rows[-2] if k > first else None, trace)

    def sides(x: float) -> tuple[float, float]:
        for k in range(max(sample, first), at + 1):
            row, previous = rows[k - first], rows[k - first - 1] if k > first else None
            for index in varying:
                changed = nodes[index].op == "signal" and k == sample
                row[index] = x if changed else _number_at(nodes[index], k, row, previous, trace)
        return rows[-1][left], rows[-1][right]

    return sides


def _number_at(
    node: Node, sample: int, row: dict[int, float], previous: dict[int, float] | None, trace: Trace
) -> float:
    """Return a real node at one sample, given its operands there and at the sample before."""
    if node.op == "const":
        return float(node.value or 0.0)
    if node.op == "signal":
        return float(trace.signals[str(node.value)][sample])
    if node.op == "now":
        return float(trace.ticks[sample] - trace.ticks[0]) / trace.ticks_per_unit
    operands = [row[c] for c in node.children]
    if node.op in ("delta", "rate"):
        if sample == 0 or previous is None:
            return 0.0
        change = operands[0] - previous[node.children[0]]
        elapsed = float(trace.ticks[sample] - trace.ticks[sample - 1]) / trace.ticks_per_unit
        return change if node.op == "delta" else change / elapsed
    return fold(node.op, operands)


def _roots(sides: Sides, start: float) -> list[float]:
    """Guess where the sides meet, by Newton's steps; exact where the predicate is linear."""
    roots: list[float] = []
    x = start
    for _ in range(6):
        here = _difference(sides(x))
        step = max(1.0, abs(x)) * 2.0**-10
        slope = (_difference(sides(x + step)) - here) / step
        if not (math.isfinite(here) and math.isfinite(slope)) or slope == 0:
            break
        x -= here / slope
        if not math.isfinite(x):
            break
        roots.append(x)
        if here == 0:
            break
    return roots


def _difference(sides: tuple[float, float]) -> float:
    return sides[0] - sides[1]


def _nearest(
    flipped: Callable[[float], bool], before: float, limit: float, roots: Sequence[float]
) -> tuple[float, float] | None:
    """Return the nearest value that flips, between `before` and `limit`, and its neighbour that does not."""
    start, end = _code(before), _code(limit)
    probes = {start + (end - start) * k // _PROBES for k in range(1, _PROBES + 1)}
    for root in roots:
        written = _code(float(f"{root:.12g}"))
        probes.update((written, *range(_code(root) - 3, _code(root) + 4)))
    inside = (code for code in probes if min(start, end) <= code <= max(start, end) and code != start)
    miss = start
    for code in sorted(inside, key=lambda c: abs(c - start)):
        if flipped(_float(code)):
            hit = code
            break
        miss = code
    else:
        return None
    while abs(hit - miss) > 1:
        middle = (hit + miss) // 2
        if flipped(_float(middle)):
            hit = middle
        else:
            miss = middle
    return _float(hit), _float(miss)


def _written(
    flipped: Callable[[float], bool],
    name: str,
    sample: int,
    before: float,
    hit: float,
    miss: float,
    limits: tuple[float, float],
) -> Change:
    """Write the bound with few digits: as a value that flips, or as one that must be passed."""
    scale = max(abs(hit), abs(before) if math.isfinite(before) else 0.0)
    for digits in range(17):
        number = float(f"{hit:.{digits}g}") + 0.0 if digits else 0.0
        if abs(number - hit) > _SAME * scale or not limits[0] <= number <= limits[1]:
            continue
        beyond = number == hit or (number > hit) == (hit > before)
        flips = flipped(number)
        if not flips and not beyond:
            return Change(name, sample, before, number, True, hit)
        if flips and beyond:
            hit = number
            break
    if len(number_text(miss)) < len(number_text(hit)):
        return Change(name, sample, before, miss, True, hit)
    return Change(name, sample, before, hit, False, hit)


def _code(x: float) -> int:
    """Return the place of a float among all floats."""
    (bits,) = struct.unpack("<q", struct.pack("<d", x + 0.0))
    return int(bits) if bits >= 0 else -(int(bits) + 2**63)


def _float(code: int) -> float:
    """Return the float at a place; the inverse of `_code`."""
    bits = code if code >= 0 else -code - 2**63
    (x,) = struct.unpack("<d", struct.pack("<q", bits))
    return float(x)


def _shown(value: float) -> str:
    short = f"{value + 0.0:.6g}"
    return short if float(short) == value else number_text(value)
