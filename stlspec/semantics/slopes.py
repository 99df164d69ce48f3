"""Derivatives of real expressions, one operator at a time, backwards.

In: a real node, the values of its operands and its own, the derivative of some goal with respect to it. Out: the
derivatives with respect to its operands. Only what the operators of `expressions` are made of is known here.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import Node
from stlspec.traces import Trace

Floats = NDArray[np.float64]


def times(cotangent: Floats, slope: Floats) -> Floats:
    """Multiply, but 0 where the cotangent is: what has no influence has none, however steep it is.

    Not in the paper: the chain rule at a sample where a slope may be infinite.

    Args:    cotangent, slope: arrays of one shape.
    Returns: the product.
    """
    with np.errstate(all="ignore"):
        return np.where(cotangent == 0, 0.0, cotangent * slope)


def operand_slopes(
    node: Node, operands: Sequence[Floats], values: Floats, cotangent: Floats, trace: Trace
) -> list[Floats]:
    """Bring the derivative with respect to a real node back to its operands.

    Not in the paper: reverse accumulation.

    Args:    node: neither `const`, `signal` nor `now`. operands: their values, (n_samples,). values: of the node.
             cotangent: d goal / d node, (n_samples,). trace: the times.
    Returns: d goal / d operand for each operand, (n_samples,); see `gradients` on where there is none.
    """
    if node.op in ("delta", "rate"):
        return [_of_change(cotangent, trace, node.op == "rate")]
    if node.op in ("min", "max"):
        return _of_choice(operands, values, cotangent)
    with np.errstate(all="ignore"):
        if node.op == "mul":
            return [times(cotangent, slope) for slope in _of_product(operands)]
        return [times(cotangent, slope) for slope in _plain(node.op, operands, values)]


def _plain(op: str, operands: Sequence[Floats], values: Floats) -> list[Floats]:
    x, y = operands[0], operands[-1]
    one = np.ones(x.shape)
    if op == "add":
        return [one] * len(operands)
    if op in ("sub", "neg"):
        return [one, -one] if op == "sub" else [-one]
    if op == "div":
        return [one / y, -x / (y * y)]
    if op == "pow":
        # The power rule has 0 * x ** -1 for the exponent 0, whose slope is 0 also where x is.
        return [np.where(y == 0, 0.0, y * np.power(x, y - 1)), _of_exponent(x, values)]
    if op == "hypot":
        return [np.where(values == 0, 0.0, x / values), np.where(values == 0, 0.0, y / values)]
    return [_unary(op, x, values)]


def _unary(op: str, x: Floats, values: Floats) -> Floats:
    if op == "abs":
        return np.sign(x)
    if op == "sqrt":
        return 0.5 / values
    if op == "exp":
        return values
    if op == "log":
        return 1 / x
    return np.cos(x) if op == "sin" else -np.sin(x)


def _of_exponent(base: Floats, values: Floats) -> Floats:
    """The slope of base ** y in y is base ** y log(base), 0 where the power is 0."""
    return np.where((base == 0) & (values == 0), 0.0, values * np.log(base))


def _of_product(operands: Sequence[Floats]) -> list[Floats]:
    """The slope of a product in one factor is the product of the others; not by division, for a factor may be 0."""
    ahead = [np.ones(operands[0].shape)]
    behind = [np.ones(operands[0].shape)]
    for left, right in zip(operands[:-1], operands[:0:-1], strict=True):
        ahead.append(ahead[-1] * left)
        behind.append(behind[-1] * right)
    return [a * b for a, b in zip(ahead, reversed(behind), strict=True)]


def _of_choice(operands: Sequence[Floats], values: Floats, cotangent: Floats) -> list[Floats]:
    """The first operand that is the least or greatest takes it all."""
    free = np.ones(values.shape, dtype=np.bool_)
    found = []
    for operand in operands:
        chosen = free & (operand == values)
        free &= ~chosen
        found.append(np.where(chosen, cotangent, 0.0))
    return found


def _of_change(cotangent: Floats, trace: Trace, per_unit: bool) -> Floats:
    """The change at sample i is x[i] - x[i-1]; the first sample has none."""
    towards = cotangent[1:]
    if per_unit:
        towards = towards / (np.diff(trace.times) / trace.ticks_per_unit)
    found = np.zeros(len(cotangent))
    found[1:] = towards
    found[:-1] -= towards
    return found
