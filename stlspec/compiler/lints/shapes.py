"""Formulas whose shape says something else than it seems to: collapsing, `next` at the end.

In: a `Subject`. Out: L610 and L612.
"""

from stlspec.compiler.ir import FUTURE, PAST
from stlspec.compiler.lints.subject import Subject
from stlspec.errors import Diagnostic, Edit, diagnostic
from stlspec.lang.nodes import Expression, Group, Infix, Operator, Prefix, post_order

_UNBOUNDED = frozenset({"always", "eventually", "historically", "once"})
_AT_THE_END = {"always": "eventually", "eventually": "always"}


def check_shapes(subject: Subject) -> list[Diagnostic]:
    """Judge the shape of every formula."""
    found: list[Diagnostic] = []
    for formula in subject.formulas:
        inside: set[int] = set()
        for node in reversed(list(post_order(formula))):
            if isinstance(node, Prefix) and id(node) not in inside:
                found += _next_at_the_end(subject, node)
                found += _collapsing(subject, node, inside)
    return found


def _next_at_the_end(subject: Subject, node: Prefix) -> list[Diagnostic]:
    """Report `always (p implies next q)`, and offer the weak `next`."""
    inner = _bare(node.operand)
    implies = isinstance(inner, Infix) and inner.operators[0].word == "implies"
    if not implies or not _is_unbounded(node.operator, subject) or node.operator.word != "always":
        return []
    found = []
    assert isinstance(inner, Infix)
    for strong in _demanded_next(inner.operands[-1]):
        source, span = subject.syntax.source, strong.operator.span
        word = source.slice(span)
        found.append(diagnostic("L610", source=source, span=span, edits=(Edit(span, "wnext"),), word=word))
    return found


def _demanded_next(root: Expression) -> list[Prefix]:
    """Return each `next` that must hold for `root` to hold."""
    found, pending = [], [root]
    while pending:
        node = _bare(pending.pop())
        if isinstance(node, Prefix) and node.operator.word == "next":
            found.append(node)
        elif isinstance(node, Infix) and node.operators[0].word == "and":
            pending += node.operands
    return found


def _collapsing(subject: Subject, node: Prefix, inside: set[int]) -> list[Diagnostic]:
    """Report a tower of unbounded operators that says no more than a lower one; `inside` is what it consists of."""
    tower = [node]
    while True:
        below = _bare(tower[-1].operand)
        if not isinstance(below, Prefix) or not _is_unbounded(below.operator, subject):
            break
        both = {tower[-1].operator.word, below.operator.word}
        if not _is_unbounded(tower[-1].operator, subject) or not (both <= FUTURE or both <= PAST):
            break
        tower.append(below)
    if len(tower) == 1:
        return []
    words = [part.operator.word for part in tower]
    inside.update(id(part) for part in tower)
    operand = subject.text(_bare(tower[-1].operand).span)
    if len(set(words)) == 1:
        meaning, way = f"`{words[0]} ({operand})`", f"write `{words[0]}` once"
    elif set(words) == set(_AT_THE_END):
        meaning = f"that `{operand}` holds at the last sample of the trace"
        way = f"bound the inner operator, such as `{words[0]} {_AT_THE_END[words[0]]}[0, 5] (...)`"
        if subject.model.declared.time.kind != "step":
            way = way.replace("5]", f"5 {subject.model.declared.time.unit}]")
    elif set(words) == {"historically", "once"}:
        meaning, way = f"that `{operand}` holds at the first sample of the trace", "bound the inner operator"
    else:
        return []
    return [subject.warn("L612", node.span, text=subject.text(node.span), meaning=meaning, help=way)]


def _is_unbounded(operator: Operator, subject: Subject) -> bool:
    """Tell whether an operator looks from the sample at hand to the end, or to the beginning."""
    if operator.word not in _UNBOUNDED:
        return False
    if operator.interval is None:
        return True
    return subject.model.intervals.get(id(operator.interval)) == (0, None)


def _bare(node: Expression) -> Expression:
    while isinstance(node, Group):
        node = node.inner
    return node
