"""What an expression and a predicate may be at a sample that is still to come.

In: the declared ranges of the signals. Out: for every real node and every predicate an interval that holds all
its values, by interval arithmetic. Samples for which an expression has no value are refused when they come, so
they count for nothing; where the ends of an interval have no value (inf - inf), it is opened to infinity.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import product

from stlspec.compiler.bundle import Signal, TimeBase
from stlspec.compiler.ir import COMPARISONS, REAL, Node

Range = tuple[float, float]

INF = math.inf
TIE = 5e-324
"""What a predicate exactly on its bound counts: plus this if it holds, minus this if not."""

WHOLE: Range = (-INF, INF)

_HOLDS_ON_BOUND = frozenset({"ge", "le", "eq"})


def value_ranges(nodes: Sequence[Node], signals: Sequence[Signal], base: TimeBase) -> dict[int, Range]:
    """Return the range of every real expression and predicate.

    Not in the paper: it evaluates complete traces only.

    Args:    nodes: the DAG. signals: the declared ones. base: how the spec measures time.
    Returns: by node (low, high), both of which may be infinite, never NaN. A bound of a predicate that is 0 is
             the tie token with the sign of its truth.
    """
    declared = {s.name: (-INF if s.low is None else s.low, INF if s.high is None else s.high) for s in signals}
    shortest = 1.0 if base.kind == "step" else (base.period or 1) / base.ticks_per_unit
    found: dict[int, Range] = {}
    for index, node in enumerate(nodes):
        if node.op in REAL:
            found[index] = _real(node, [found[c] for c in node.children], declared, shortest)
        elif node.op in COMPARISONS:
            found[index] = _predicate(node.op, found[node.children[0]], found[node.children[1]])
    return found


def image(op: str, operands: Sequence[Range]) -> Range:
    """Enclose the values of an operation over everything that its operands may be.

    Not in the paper: interval arithmetic.

    Args:    op: a word of arithmetic, as nodes have it, or a function. operands: at least one.
    Returns: (low, high), never NaN; `WHOLE` for an operation that is none of arithmetic.
    """
    result = operands[0]
    if len(operands) == 1:
        return _UNARY[op](result) if op in _UNARY else result if op in _BINARY else WHOLE
    for operand in operands[1:]:
        result = _BINARY[op](result, operand) if op in _BINARY else WHOLE
    return result


def _real(node: Node, operands: Sequence[Range], declared: Mapping[str, Range], shortest: float) -> Range:
    if node.op == "const":
        value = float(node.value or 0.0)
        return value, value
    if node.op == "signal":
        return declared.get(str(node.value), WHOLE)
    if node.op == "now":
        return 0.0, INF
    if node.op in ("delta", "rate"):
        low, high = _spread(operands[0], operands[0])
        # The shortest step gives the steepest rate; no change, as at the first sample, is always among them.
        return (low, high) if node.op == "delta" else (low / shortest, high / shortest)
    return image(node.op, operands)


def _between(low: float, high: float) -> Range:
    """Open an end that has no value."""
    return (-INF if math.isnan(low) else low, INF if math.isnan(high) else high)


def _add(x: Range, y: Range) -> Range:
    return _between(x[0] + y[0], x[1] + y[1])


def _spread(x: Range, y: Range) -> Range:
    return _between(x[0] - y[1], x[1] - y[0])


def _corners(values: Sequence[float]) -> Range:
    # A corner without a value (0 * inf, inf / inf) is approached from all sides; 0 and the others enclose it.
    kept = [0.0 if math.isnan(v) else v for v in values]
    return min(kept), max(kept)


def _times(x: Range, y: Range) -> Range:
    return _corners([a * b for a, b in product(x, y)])


def _over(x: Range, y: Range) -> Range:
    if y[0] <= 0 <= y[1]:
        return WHOLE
    return _corners([a / b for a, b in product(x, y)])


def _magnitude(x: Range) -> Range:
    least = 0.0 if x[0] <= 0 <= x[1] else min(abs(x[0]), abs(x[1]))
    return least, max(abs(x[0]), abs(x[1]))


def _hypotenuse(x: Range, y: Range) -> Range:
    (a, b), (c, d) = _magnitude(x), _magnitude(y)
    return _wider(math.hypot(a, c), math.hypot(b, d), 0.0)


def _wider(low: float, high: float, least: float = -INF) -> Range:
    """Leave room for the last digits, on which mathematical libraries disagree."""
    if math.isfinite(low):
        low = max(least, low - 4 * math.ulp(low))
    return low, high + 4 * math.ulp(high) if math.isfinite(high) else high


def _root(x: Range) -> Range:
    return math.sqrt(max(x[0], 0.0)), math.sqrt(max(x[1], 0.0))


def _exponential(x: Range) -> Range:
    low, high = (math.exp(v) if v < 709 else INF for v in x)
    # The largest finite exponential is still below 1e309, so an infinite low end must come down.
    return _wider(low if low < INF else 1e307, high, 0.0) if x[0] < INF else (INF, INF)


def _logarithm(x: Range) -> Range:
    low, high = (-INF if v <= 0 else math.log(v) for v in x)
    return _wider(low, high)


def _power(x: Range, y: Range) -> Range:
    exponent = y[0]
    if y[0] != y[1] or not math.isfinite(exponent) or not 0 < exponent <= 64:
        return (0.0, INF) if x[0] >= 0 else WHOLE
    if exponent == math.floor(exponent):
        if exponent % 2 == 0:
            x = _magnitude(x)
    elif x[0] == -INF:
        return 0.0, INF  # (-inf) ** 0.5 is inf
    else:
        x = max(x[0], 0.0), max(x[1], 0.0)
    low, high = (_powered(v, exponent) for v in x)
    return _wider(low, high, 0.0 if low >= 0 else -INF)


def _powered(value: float, exponent: float) -> float:
    try:
        return math.pow(value, exponent)
    except OverflowError:
        return math.copysign(INF, value)


def _smaller(x: Range, y: Range) -> Range:
    return min(x[0], y[0]), min(x[1], y[1])


def _larger(x: Range, y: Range) -> Range:
    return max(x[0], y[0]), max(x[1], y[1])


_UNARY: dict[str, Callable[[Range], Range]] = {
    "neg": lambda x: (-x[1], -x[0]),
    "abs": _magnitude,
    "sqrt": _root,
    "exp": _exponential,
    "log": _logarithm,
    "sin": lambda _: (-1.0, 1.0),
    "cos": lambda _: (-1.0, 1.0),
}
_BINARY: dict[str, Callable[[Range, Range], Range]] = {
    "add": _add,
    "sub": _spread,
    "mul": _times,
    "div": _over,
    "pow": _power,
    "min": _smaller,
    "max": _larger,
    "hypot": _hypotenuse,
}


def _predicate(op: str, left: Range, right: Range) -> Range:
    tie = TIE if op in _HOLDS_ON_BOUND else -TIE
    if op in ("lt", "le"):
        left, right = right, left
    low, high = _distance(left[0], right[1]), _distance(left[1], right[0])
    if op in ("eq", "ne"):
        near = 0.0 if left[0] <= right[1] and right[0] <= left[1] else min(abs(low), abs(high))
        far = max(abs(low), abs(high))
        low, high = (-far, -near) if op == "eq" else (near, far)
    return low or tie, high or tie


def _distance(left: float, right: float) -> float:
    return 0.0 if left == right else left - right
