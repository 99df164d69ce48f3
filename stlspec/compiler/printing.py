"""Nodes of the DAG as text, for messages.

In: the nodes and the index of a real expression, a predicate or a Boolean signal. Out: one line in the
language's own notation. Built bottom-up and cut at every step, because the text of a shared DAG can be
exponentially longer than the DAG.
"""

from collections.abc import Sequence

from stlspec.compiler.ir import COMPARISONS, Node

LONGEST = 80

_SUM, _PRODUCT, _NEGATION, _POWER, _ATOM = range(1, 6)
_INFIX = {
    "add": ("+", _SUM),
    "sub": ("-", _SUM),
    "mul": ("*", _PRODUCT),
    "div": ("/", _PRODUCT),
}


def number_text(value: float) -> str:
    """Return the shortest text that reads back as `value`: 1.0 is "1", infinity is "inf"."""
    text = repr(float(value))
    return text.removesuffix(".0")


def short_text(value: float) -> str:
    """Return a number for a person, cut to six digits. Not in the paper: it serves the messages."""
    return f"{value + 0.0:.6g}"


def counted(count: int, noun: str) -> str:
    """Return "1 error", "2 errors". Not in the paper: it serves the messages."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def expression_text(nodes: Sequence[Node], root: int) -> str:
    """Return a real expression, a predicate or a Boolean signal as the user would write it.

    Not in the paper: it serves the messages.

    Args:    nodes: the DAG, children first. root: index of a real node, a comparison or a `bool`.
    Returns: one line of at most `LONGEST` characters, cut off with "…" if it would be longer.
    """
    texts: dict[int, tuple[str, int]] = {}
    stack = [root]
    while stack:
        index = stack[-1]
        waiting = [c for c in nodes[index].children if c not in texts]
        if waiting:
            stack += waiting
            continue
        stack.pop()
        node = nodes[index]
        text, rank = _text(node, [texts[c] for c in node.children])
        texts[index] = (text, rank) if len(text) <= LONGEST else (text[: LONGEST - 1] + "…", _ATOM)
    return texts[root][0]


def _text(node: Node, operands: list[tuple[str, int]]) -> tuple[str, int]:
    if node.op == "const":
        text = number_text(float(node.value or 0.0))
        return text, _NEGATION if text.startswith("-") else _ATOM
    if node.op in ("signal", "bool"):
        return str(node.value), _ATOM
    if node.op in COMPARISONS:
        return f"{operands[0][0]} {COMPARISONS[node.op]} {operands[1][0]}", 0
    if node.op in _INFIX:
        sign, rank = _INFIX[node.op]
        head = _wrapped(operands[0], rank)
        # Floating-point sums do not associate, so a right operand of the same rank keeps its parentheses.
        return f" {sign} ".join([head, *(_wrapped(o, rank + 1) for o in operands[1:])]), rank
    if node.op == "neg":
        return f"-{_wrapped(operands[0], _POWER)}", _NEGATION
    if node.op == "pow":
        return f"{_wrapped(operands[0], _ATOM)} ** {_wrapped(operands[1], _POWER)}", _POWER
    if not operands:
        return node.op, _ATOM
    return f"{node.op}({', '.join(text for text, _ in operands)})", _ATOM


def _wrapped(operand: tuple[str, int], rank: int) -> str:
    text, own = operand
    return text if own >= rank else f"({text})"
