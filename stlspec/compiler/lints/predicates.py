"""Conditions that say less than they seem to: on time alone, never or always true, of one sign, equal by chance.

In: a `Subject`. Out: L601 to L604, L607 and L609, each at the condition itself, one for each root cause.
"""

import math
from collections.abc import Iterator, Sequence

from stlspec.compiler.ir import COMPARISONS, Node
from stlspec.compiler.lints.subject import Subject
from stlspec.compiler.model import Typing
from stlspec.compiler.printing import number_text
from stlspec.compiler.ranges import TIE, Range
from stlspec.errors import Diagnostic
from stlspec.lang.nodes import Expression, Group, Infix, Name, Prefix, children, post_order

_NEGATING = frozenset({"not"})
_BOTH_WAYS = frozenset({"iff", "xor"})
_COMPUTED = frozenset("div pow sqrt exp log sin cos hypot rate".split())


def check_predicates(subject: Subject) -> list[Diagnostic]:
    """Judge every condition of the spec by what is known of the values in it."""
    found: list[Diagnostic] = []
    kinds = _kinds(subject.sketch.nodes)
    for formula in subject.formulas:
        if subject.model.typing(formula).kind != "formula":
            continue
        told = {id(inner) for part in _timeless(subject, formula, kinds, found) for inner in post_order(part)}
        told |= {id(inner) for part in _untriggered(subject, formula, found) for inner in post_order(part)}
        for node, positive in _comparisons(formula):
            if id(node) not in told:
                found += _judged(subject, node, positive)
    return found


def _kinds(nodes: Sequence[Node]) -> list[tuple[bool, bool]]:
    """Tell of each node whether time and whether a signal occurs in it."""
    found: list[tuple[bool, bool]] = []
    for node in nodes:
        below = [found[child] for child in node.children]
        timed = node.op == "now" or any(time for time, _ in below)
        found.append((timed, node.op in ("signal", "bool") or any(signal for _, signal in below)))
    return found


def _timeless(
    subject: Subject, formula: Expression, kinds: Sequence[tuple[bool, bool]], found: list[Diagnostic]
) -> Iterator[Expression]:
    """Report and yield what stands alone under a temporal operator, or alone as a formula, and is of time alone."""
    made = subject.sketch.made
    for node in post_order(formula):
        if isinstance(node, Prefix) and node.operator.word not in ("not", "neg"):
            operand = _bare(node.operand)
            if kinds[made[id(operand)]] == (True, False) and not _has_temporal(operand):
                found.append(subject.warn("L601", operand.span, text=subject.text(operand.span)))
                yield operand


def _has_temporal(root: Expression) -> bool:
    return any(isinstance(node, Prefix) and node.operator.word not in ("not", "neg") for node in post_order(root))


def _untriggered(subject: Subject, formula: Expression, found: list[Diagnostic]) -> Iterator[Expression]:
    """Report and yield the left sides of implications that never hold."""
    for node in post_order(formula):
        if isinstance(node, Infix) and node.operators[0].word == "implies":
            for left in node.operands[:-1]:
                if subject.truth(left)[1] < 0:
                    inner = _bare(left)
                    found.append(subject.warn("L607", inner.span, text=subject.text(inner.span)))
                    yield left


def _comparisons(root: Expression) -> Iterator[tuple[Infix, bool | None]]:
    """Yield every comparison with its polarity: True, False, or None where it counts both ways."""
    pending: list[tuple[Expression, bool | None]] = [(root, True)]
    while pending:
        node, positive = pending.pop()
        if isinstance(node, Infix) and node.operators[0].word in COMPARISONS:
            yield node, positive
            continue
        opposite = None if positive is None else not positive
        below = children(node)
        if isinstance(node, Prefix) and node.operator.word in _NEGATING:
            pending.append((below[0], opposite))
        elif isinstance(node, Infix) and node.operators[0].word in _BOTH_WAYS:
            pending += [(child, None) for child in below]
        elif isinstance(node, Infix) and node.operators[0].word == "implies":
            pending += [(child, opposite) for child in below[:-1]]
            pending.append((below[-1], positive))
        else:
            pending += [(child, positive) for child in below]


def _judged(subject: Subject, node: Infix, positive: bool | None) -> list[Diagnostic]:
    """Judge one comparison."""
    low, high = subject.truth(node)
    text = subject.text(node.span)
    if high < 0:
        return [subject.warn("L602", node.span, text=text, why=_why(subject, node))]
    if low > 0:
        return [subject.warn("L603", node.span, text=text, why=_why(subject, node))]
    words = {operator.word for operator in node.operators}
    if words & {"eq", "ne"}:
        return _equality(subject, node)
    if len(words) > 1 or len(node.operators) > 1 or positive is None:
        return []
    if abs(high) <= TIE:
        way = "leave it some room, such as `< 1`" if positive else "leave the bound some room"
        return [subject.warn("L604", node.span, text=text, sign="positive", why=_why(subject, node), help=way)]
    if abs(low) <= TIE:
        way = "leave a margin, so that how far it is missed shows"
        return [subject.warn("L604", node.span, text=text, sign="negative", why=_why(subject, node), help=way)]
    return []


def _why(subject: Subject, node: Infix) -> str:
    """Say what is known of the operands that are not plain numbers."""
    parts = []
    for operand in node.operands:
        low, high = subject.ranges[subject.sketch.made[id(operand)]]
        typing = subject.model.typing(operand)
        if typing.value is not None and not isinstance(_bare(operand), Name):
            continue
        name = subject.text(_bare(operand).span)
        parts.append(f"`{name}` {_range_text((low, high))}")
    return " and ".join(dict.fromkeys(parts)) or "both sides are constant"


def _range_text(extent: Range) -> str:
    low, high = number_text(extent[0]), number_text(extent[1])
    return f"is {low}" if low == high else f"lies in [{low}, {high}]"


def _equality(subject: Subject, node: Infix) -> list[Diagnostic]:
    """Report `==` between measured quantities; whole numbers without a unit may be rows, gears or modes."""
    typings = [subject.model.typing(operand) for operand in node.operands]
    nodes, made = subject.sketch.nodes, subject.sketch.made
    if not (any(map(_is_measure, typings)) or any(nodes[made[id(x)]].op in _COMPUTED for x in node.operands)):
        return []
    left, right = (subject.text(operand.span) for operand in node.operands[:2])
    return [subject.warn("L609", node.span, text=subject.text(node.span), left=left, right=right)]


def _is_measure(typing: Typing) -> bool:
    if typing.value is not None and math.isfinite(typing.value) and typing.value != math.floor(typing.value):
        return True
    return bool(typing.unit) and typing.unit != {"step": 1}


def _bare(node: Expression) -> Expression:
    while isinstance(node, Group):
        node = node.inner
    return node
