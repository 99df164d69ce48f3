"""The algebra as a value: what `and`, `or`, windows and until are made of.

In: two operations and their neutral elements, with the laws that they fulfil. Out: an `Algebra` that evaluation
and gradients take. The laws are tried on a few elements when the value is made, so that an algebra that
promises too much is refused before it spoils a number.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import COMPARISONS, PAST, REAL, Node
from stlspec.compiler.passes import Law
from stlspec.errors import UsageError, diagnostic
from stlspec.semantics.windows import Grid, index_windows
from stlspec.traces import Trace

Floats = NDArray[np.float64]
Operation = Callable[[Floats, Floats], Floats]
"""Element by element over two arrays of one shape, as a binary ufunc."""

LAWS: frozenset[Law] = frozenset(get_args(Law))


@dataclass(frozen=True, slots=True)
class Algebra:
    """A structure (⊕, ⊗, ⊤, ⊥) to evaluate formulas in.

    join: ⊕, of `or`, eventually, until. meet: ⊗, of `and`, always, until. Both are associative. top: ⊤,
    neutral for ⊗; bottom: ⊥, neutral for ⊕. laws: what else holds, see `passes.Law`. negate: of `not`.
    embed: from the signed distance of a predicate to its element; None: the distance itself. slopes: for
    gradients, d result / d operand of ⊕ and of ⊗ as functions of (operand, result), where these suffice.
    """

    name: str
    join: Operation
    meet: Operation
    top: float
    bottom: float
    laws: frozenset[Law] = frozenset()
    negate: Callable[[Floats], Floats] = np.negative
    embed: Callable[[Floats], Floats] | None = None
    slopes: tuple[Operation, Operation] | None = None

    def __post_init__(self) -> None:
        """Refuse an algebra that does not keep its laws. Raises: UsageError."""
        _check_parts(self)
        elements = _tried(self, "embed", lambda: embedded(self, np.array([-3.0, -1.0, -0.25, 0.5, 1.0, 2.0])))
        elements = np.concatenate([elements, [self.bottom, self.top]])
        grid = np.meshgrid(elements, elements, elements, indexing="ij")
        for law, text, holds in _LAWS:
            if law is not None and law not in self.laws:
                continue
            with np.errstate(all="ignore"):
                kept = _tried(self, law or "an operation", partial(holds, self, *grid))
            if not np.all(kept):
                raise refusal(f"the algebra '{self.name}' does not fulfil {text}", _WAY_OUT[law is None])


_WAY_OUT = ("declare only laws that hold", "⊤ must be neutral for ⊗, ⊥ for ⊕, and both operations associative")


def refusal(what: str, way_out: str) -> UsageError:
    """Make the error of an algebra that cannot be used."""
    return UsageError([diagnostic("D880", what=what, help=way_out)])


def checked(value: object) -> Algebra:
    """Return what a caller passed as `algebra`. Raises: UsageError: it is no algebra."""
    if isinstance(value, Algebra):
        return value
    raise refusal(f"algebra={value!r}"[:60], "give MIN_MAX, BOOLEAN, log_sum_exp(T) or an `Algebra`")


def _check_parts(algebra: Algebra) -> None:
    shown = f"the algebra '{algebra.name}'"
    for part in ("join", "meet", "negate", *(("embed",) if algebra.embed is not None else ())):
        if not callable(getattr(algebra, part)):
            raise refusal(f"{shown} has no callable `{part}`", "give a function of arrays, such as np.maximum")
    for part in ("top", "bottom"):
        value = getattr(algebra, part)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or math.isnan(value):
            raise refusal(f"`{part}` of {shown} is no number", "give a number; inf and -inf are allowed")
    unknown = sorted(map(str, set(algebra.laws) - LAWS))
    if unknown:
        raise refusal(f"{shown} declares an unknown law '{unknown[0]}'", "the laws are " + ", ".join(sorted(LAWS)))


def _tried(algebra: Algebra, part: str, call: Callable[[], Any]) -> NDArray[Any]:
    """Call what the caller handed in; whatever it raises is the caller's mistake."""
    try:
        return np.asarray(call())
    except Exception as problem:
        what = f"the algebra '{algebra.name}' fails in `{part}`: {type(problem).__name__}: {problem}"
        raise refusal(what, "an operation takes float64 arrays of one shape and returns one") from problem


def embedded(algebra: Algebra, values: Floats) -> Floats:
    """Return the elements of signed distances; not in the paper, whose predicates are elements already."""
    return values if algebra.embed is None else np.asarray(algebra.embed(values), dtype=np.float64)


def _same(left: Floats, right: Floats) -> NDArray[np.bool_]:
    return np.isclose(left, right, rtol=1e-9, atol=1e-12)


_Holds = Callable[[Algebra, Floats, Floats, Floats], Any]


def _neutral(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    del y, z
    return _same(a.join(x, np.full_like(x, a.bottom)), x) & _same(a.meet(x, np.full_like(x, a.top)), x)


def _associative(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    joined, met = a.join(a.join(x, y), z), a.meet(a.meet(x, y), z)
    return _same(joined, a.join(x, a.join(y, z))) & _same(met, a.meet(x, a.meet(y, z)))


def _absorbing(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    del y, z
    top, bottom = np.full_like(x, a.top), np.full_like(x, a.bottom)
    return _same(a.join(top, x), top) & _same(a.meet(bottom, x), bottom)


def _de_morgan(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    del z
    distances = np.array([-2.0, -0.5, 0.25, 3.0])
    mirrored = _same(embedded(a, -distances), np.asarray(a.negate(embedded(a, distances)))).all()
    involution = _same(a.negate(a.negate(x)), x) & _same(a.negate(np.full_like(x, a.top)), np.full_like(x, a.bottom))
    return mirrored & involution & _same(a.negate(a.join(x, y)), a.meet(a.negate(x), a.negate(y)))


def _distributive(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    return _same(a.meet(x, a.join(y, z)), a.join(a.meet(x, y), a.meet(x, z)))


def _idempotent(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    del y, z
    return _same(a.join(x, x), x) & _same(a.meet(x, x), x)


def _monotone(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    joined, met = (a.join(x, z), a.join(y, z)), (a.meet(x, z), a.meet(y, z))
    return (x > y) | (((joined[0] <= joined[1]) | _same(*joined)) & ((met[0] <= met[1]) | _same(*met)))


def _selective(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    del z
    joined, met = a.join(x, y), a.meet(x, y)
    return ((joined == x) | (joined == y)) & ((met == x) | (met == y))


def _lattice(a: Algebra, x: Floats, y: Floats, z: Floats) -> Any:
    """Max and min, and an embedding that both of them and negation pass through."""
    found = embedded(a, np.array([-np.inf, -2.0, -0.5, 0.0, 0.5, 2.0, np.inf]))
    rises = (np.diff(found) >= 0).all() & (found[0] == a.bottom) & (found[-1] == a.top)
    return rises & (a.join(x, y) == np.maximum(x, y)) & (a.meet(x, y) == np.minimum(x, y)) & _de_morgan(a, x, y, z)


_LAWS: tuple[tuple[Law | None, str, _Holds], ...] = (
    (None, "the laws of ⊤ and ⊥", _neutral),
    (None, "(x ⊕ y) ⊕ z = x ⊕ (y ⊕ z), or the same for ⊗", _associative),
    ("absorbing", "⊤ ⊕ x = ⊤ and ⊥ ⊗ x = ⊥", _absorbing),
    ("de_morgan", "-(x ⊕ y) = -x ⊗ -y, -⊤ = ⊥ and embed(-x) = -embed(x)", _de_morgan),
    ("distributive", "x ⊗ (y ⊕ z) = (x ⊗ y) ⊕ (x ⊗ z)", _distributive),
    ("idempotent", "x ⊕ x = x ⊗ x = x", _idempotent),
    ("monotone", "that greater operands give no lesser result", _monotone),
    ("selective", "that a result is one of the operands", _selective),
    ("lattice", "that ⊕ is max, ⊗ is min, and embed rises from ⊥ to ⊤ and is odd", _lattice),
)

MIN_MAX = Algebra("min-max", np.maximum, np.minimum, math.inf, -math.inf, LAWS)
"""Robustness as the paper's references define it; every verdict, label and witness is decided in it."""
BOOLEAN = Algebra("boolean", np.maximum, np.minimum, 1.0, -1.0, LAWS, embed=np.sign)
"""1 where a formula holds, -1 where it does not."""


def log_sum_exp(temperature: float = 1.0) -> Algebra:
    """Return the smooth algebra: ⊕ is T log(sum of exp(x / T)), ⊗ the same downwards.

    Not in the paper, which leaves the algebra open. `error_bound` says how far it is from max and min.

    Args:    temperature: T, in the unit of the predicates; above 0, and the smaller the closer to max and min.
    Returns: the algebra; its derivatives are continuous, so that all samples share a gradient.
    Raises:  UsageError: the temperature is no positive finite number.
    """
    if isinstance(temperature, bool) or not isinstance(temperature, (int, float)) or not 0 < temperature < math.inf:
        raise refusal(f"temperature={temperature!r}", "give a finite number above 0")
    t = float(temperature)

    def softened(x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        low, high = np.minimum(x, y), np.maximum(x, y)
        with np.errstate(invalid="ignore", under="ignore", over="ignore"):
            # Equal infinities have no difference, and softening changes nothing there.
            excess = np.fmax(low - high, -np.inf)
            excess /= t
            np.exp(excess, out=excess)
            np.log1p(excess, out=excess)
            excess *= t
        return low, high, excess

    def join(x: Floats, y: Floats) -> Floats:
        _, high, excess = softened(x, y)
        return np.asarray(high + excess)

    def meet(x: Floats, y: Floats) -> Floats:
        low, _, excess = softened(x, y)
        return np.asarray(low - excess)

    def slope_of_join(x: Floats, result: Floats) -> Floats:
        with np.errstate(invalid="ignore", under="ignore", over="ignore"):
            return np.exp(np.fmin(x - result, 0.0) / t)

    def slope_of_meet(x: Floats, result: Floats) -> Floats:
        return slope_of_join(result, x)

    name, slopes = f"log-sum-exp({t:g})", (slope_of_join, slope_of_meet)
    laws: frozenset[Law] = frozenset({"absorbing", "de_morgan", "monotone"})
    return Algebra(name, join, meet, math.inf, -math.inf, laws, slopes=slopes)


def error_bound(nodes: Sequence[Node], root: int, trace: Trace, temperature: float) -> tuple[float, float]:
    """Bound how far the robustness in `log_sum_exp` is from the one in `MIN_MAX`.

    Not in the paper. One ⊕ over k operands raises the value by 0 to T log k, one ⊗ lowers it by as much, and
    neither makes the errors of its operands larger; so the bounds add up along the deepest path.

    Args:    nodes: the DAG. root: a formula. trace: its windows tell k. temperature: T.
    Returns: (below, above), both at least 0: exact - below <= smooth <= exact + above at every sample, up to
             rounding; equal infinities count as equal.
    """
    grid = Grid(trace.ticks, trace.spacing)
    bounds: list[tuple[float, float]] = []
    for node in nodes[: root + 1]:
        below = max((bounds[c][0] for c in node.children), default=0.0)
        above = max((bounds[c][1] for c in node.children), default=0.0)
        if node.op in REAL or node.op in COMPARISONS:
            below, above = 0.0, 0.0
        elif node.op == "not":
            below, above = above, below
        joined, met = _operands(node, grid)
        bounds.append((below + temperature * math.log(met), above + temperature * math.log(joined)))
    return bounds[root]


def _operands(node: Node, grid: Grid) -> tuple[int, int]:
    """Return how many operands a node joins and how many it meets, at most."""
    if node.op in ("and", "or"):
        count = len(node.children)
        return (1, count) if node.op == "and" else (count, 1)
    if node.interval is None:
        return 1, 1
    begin, end = index_windows(grid.reversed() if node.op in PAST else grid, node.interval)
    longest = max(1, int((end - begin).max()))
    if len(node.children) == 1:
        return (1, longest) if node.op in ("always", "historically") else (longest, 1)
    inside = end > begin
    reach = (end - np.arange(len(end)))[inside]
    return longest, int(reach.max(initial=1))
