"""Arithmetic on numbers that are known at compile time, with the results that the engine would give.

In: an operator of the IR and its operands. Out: a float; where Python raises, IEEE 754 has an answer (1/0 is
inf, sqrt(-1) is NaN), and that answer is used, so that folding never changes a value.
"""

import math
from collections.abc import Callable, Sequence


def _divide(a: float, b: float) -> float:
    if b != 0:
        return a / b
    if a == 0 or math.isnan(a):
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1, b)


def _power(a: float, b: float) -> float:
    if a == 0 and b < 0:
        odd = b == math.floor(b) and b % 2 == 1
        return math.copysign(math.inf, a) if odd else math.inf
    result = a**b
    return result if isinstance(result, float) else math.nan


def _log(a: float) -> float:
    return -math.inf if a == 0 else math.log(a)


_FOLD: dict[str, Callable[..., float]] = {
    "neg": lambda a: -a,
    "add": lambda *a: sum(a[1:], a[0]),
    "sub": lambda a, b: a - b,
    "mul": lambda *a: math.prod(a[1:], start=a[0]),
    "div": _divide,
    "pow": _power,
    "abs": abs,
    "min": min,
    "max": max,
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": _log,
    "sin": math.sin,
    "cos": math.cos,
    "hypot": math.hypot,
}
FOLDABLE = frozenset(_FOLD)


def fold(op: str, operands: Sequence[float]) -> float:
    """Return `op` of `operands`; NaN where there is no value."""
    if any(math.isnan(x) for x in operands):
        return math.nan
    try:
        return float(_FOLD[op](*operands))
    except ValueError:
        return math.nan
    except OverflowError:
        # Only exp and ** of large operands overflow here; a negative base to an odd power is the one case below 0.
        negative = op == "pow" and operands[0] < 0 and operands[1] % 2 == 1
        return -math.inf if negative else math.inf
