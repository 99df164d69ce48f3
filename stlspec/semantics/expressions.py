"""Real expressions: arithmetic over signals, sample by sample.

In: a real node and the values of its operands. Out: its values, a 0-d array where it is constant. Arithmetic
is IEEE 754 (1 / 0 is inf); an expression without a value (0 / 0, sqrt(-1), inf - inf) is refused with its
text and its operands, because a NaN would silently win or lose every comparison after it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import Node
from stlspec.compiler.printing import expression_text, number_text
from stlspec.errors import DataError, diagnostic
from stlspec.traces import Trace

Floats = NDArray[np.float64]

_UNARY: dict[str, np.ufunc] = {
    "neg": np.negative,
    "abs": np.absolute,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
}
_BINARY: dict[str, np.ufunc] = {
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "min": np.minimum,
    "max": np.maximum,
    "hypot": np.hypot,
}
_NEVER_NAN = frozenset({"const", "signal", "now", "neg", "abs", "min", "max", "exp", "hypot"})


def expression_values(nodes: Sequence[Node], index: int, operands: Sequence[Floats], trace: Trace) -> Floats:
    """Return the values of a real node.

    Paper: the functions f of its predicates f(x) >= c, left abstract there.

    Args:    nodes: the DAG. index: of a real node. operands: values of its children. trace: the signals.
    Returns: float64 of the shape of a signal, or 0-d where no signal and no time is involved.
    Raises:  DataError: the value at some sample is not a number.
    """
    node = nodes[index]
    values = _values(node, operands, trace)
    if node.op not in _NEVER_NAN:
        missing = np.isnan(values)
        if missing.any():
            raise _not_a_number(nodes, index, operands, np.broadcast_to(missing, trace.shape), trace)
    return values


def _values(node: Node, operands: Sequence[Floats], trace: Trace) -> Floats:
    op = node.op
    if op == "const":
        return np.asarray(node.value, dtype=np.float64)
    if op == "signal":
        return trace.signals[str(node.value)]
    if op == "now":
        return _per_sample(trace.times / trace.ticks_per_unit, trace)
    if op in ("delta", "rate"):
        return _change(operands[0], trace, per_unit=op == "rate")
    if op in _UNARY:
        return np.asarray(_UNARY[op](operands[0]))
    if op == "pow":
        return _power(operands[0], operands[1])
    values = np.asarray(operands[0])
    for operand in operands[1:]:
        values = np.asarray(_BINARY[op](values, operand))
    # Which zero the minimum of 0.0 and -0.0 is depends on the processor; 1 / min(x, y) must not.
    return np.asarray(values + 0.0) if op in ("min", "max") else values


def _power(base: Floats, exponent: Floats) -> Floats:
    """Raise to a power; numpy's square root for the exponent 0.5 misses that (-inf) ** 0.5 is inf."""
    if exponent.ndim == 0 and exponent == 0.5:
        return np.asarray(np.where(np.isinf(base), np.inf, np.sqrt(base) + 0.0))
    return np.asarray(np.power(base, exponent))


def _per_sample(values: Floats, trace: Trace) -> Floats:
    if trace.numbers is None:
        return values
    return np.repeat(values[:, None], trace.n_traces, axis=1)


def _change(values: Floats, trace: Trace, per_unit: bool) -> Floats:
    """Change since the previous sample, 0 at the first; `per_unit`: divided by the time between them."""
    change = np.zeros(trace.shape)
    values = np.broadcast_to(values, trace.shape)
    np.subtract(values[1:], values[:-1], out=change[1:])
    if per_unit:
        elapsed = np.diff(trace.times) / trace.ticks_per_unit
        change[1:] /= elapsed if trace.numbers is None else elapsed[:, None]
    return change


def _not_a_number(
    nodes: Sequence[Node], index: int, operands: Sequence[Floats], missing: NDArray[np.bool_], trace: Trace
) -> DataError:
    at = tuple(int(i) for i in np.unravel_index(int(missing.argmax()), missing.shape))
    shown: dict[str, None] = {}
    for child, values in zip(nodes[index].children, operands, strict=True):
        if nodes[child].op == "const":
            continue
        values = np.broadcast_to(values, trace.shape)
        text = f"{expression_text(nodes, child)} = {number_text(values[at])}"
        if nodes[index].op in ("delta", "rate"):
            text += f" after {number_text(values[(at[0] - 1, *at[1:])])}"
        shown[text] = None
    return DataError(
        [
            diagnostic(
                "D808",
                file=trace.file,
                expression=expression_text(nodes, index),
                sample=trace.place(*at),
                operands=", ".join(shown) or "its operands are constants",
            )
        ]
    )
