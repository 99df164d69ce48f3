"""The operand of an outermost operator, as a Boolean mix of settled formulas and operators over such.

In: the DAG. Out: `Body`, a tree in negation normal form. Its variables are the inner operators that look ahead;
all else is known as soon as its sample is. A formula that looks ahead deeper has no body of this kind.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from stlspec.compiler.ir import FUTURE, Interval
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.ranges import INF, Range

Signed = tuple[int, bool]
"""A node, and whether its negation is meant."""


@dataclass(frozen=True, slots=True)
class Body:
    """op: "and", "or" with parts; "settled" or "open" (a variable) with what it stands for."""

    op: str
    parts: tuple["Body", ...] = ()
    stands_for: Signed = (0, False)


@dataclass(frozen=True, slots=True)
class Inner:
    """An inner operator: `op` is one of always, eventually, until, release; its operands are settled."""

    op: str
    interval: Interval
    operands: tuple[Signed, ...]


def body_of(plan: Plan, index: int, negated: bool = False) -> Body | None:
    """Return a formula or its negation as a body; None if it looks ahead through more than one operator.

    Not in the paper: it serves monitors.
    """
    node = plan.nodes[index]
    if plan.settled[index]:
        return Body("settled", stands_for=(index, negated))
    if node.op == "not":
        return body_of(plan, node.children[0], not negated)
    if node.op in ("and", "or"):
        parts = [body_of(plan, child, negated) for child in node.children]
        if any(part is None for part in parts):
            return None
        op = node.op if not negated else {"and": "or", "or": "and"}[node.op]
        return Body(op, tuple(part for part in parts if part is not None))
    if node.op not in FUTURE or not all(plan.settled[c] for c in node.children):
        return None
    # Without gaps the next sample is the one a tick ahead; with gaps nobody knows when it comes.
    return Body("open", stands_for=(index, negated)) if node.op != "next" or plan.counted else None


def conjuncts(body: Body) -> list[Body]:
    """Return what a body is the conjunction of; settled parts as one."""
    if body.op != "and":
        return [body]
    parts = [part for whole in body.parts for part in conjuncts(whole)]
    settled = [part for part in parts if not variables(part)]
    found = [part for part in parts if variables(part)]
    return [*found, Body("and", tuple(settled))] if settled else found


def variables(body: Body) -> list[Signed]:
    """Return the variables of a body, each once."""
    if body.op == "open":
        return [body.stands_for]
    return list(dict.fromkeys(v for part in body.parts for v in variables(part)))


def tail_of(plan: Plan, body: Body) -> Range:
    """Enclose a body at a sample to come."""
    if body.op in ("and", "or"):
        pick = min if body.op == "and" else max
        tails = [tail_of(plan, part) for part in body.parts]
        return pick(x[0] for x in tails), pick(x[1] for x in tails)
    return signed_tail(plan, body.stands_for)


def signed_tail(plan: Plan, signed: Signed) -> Range:
    """Return the tail of a formula or its negation."""
    low, high = plan.tails[signed[0]]
    return (-high, -low) if signed[1] else (low, high)


def inner_of(plan: Plan, variable: Signed) -> Inner:
    """Return the operator that a variable stands for, its negation moved to the operands."""
    index, negated = variable
    node = plan.nodes[index]
    operands = tuple((child, negated) for child in node.children)
    if node.op == "next":
        return Inner("always" if negated else "eventually", (1, 1), operands)
    assert node.interval is not None
    dual = {"always": "eventually", "eventually": "always", "until": "release"}
    return Inner(dual[node.op] if negated else node.op, node.interval, operands)


def write(
    body: Body,
    values: Mapping[Signed, str],
    settled: Callable[[Signed], str],
    least: Callable[[list[str]], str],
    greatest: Callable[[list[str]], str],
) -> str:
    """Write a body with its variables replaced by `values`; return the variable that holds it."""
    if body.op == "open":
        return values[body.stands_for]
    if body.op == "settled":
        return settled(body.stands_for)
    parts = [write(part, values, settled, least, greatest) for part in body.parts]
    return least(parts) if body.op == "and" else greatest(parts)


def fills(plan: Plan, inner: Inner) -> list[tuple[float, float, float]]:
    """Return what an inner operator may still be worth: low, high, current.

    Not in the paper: it serves monitors.

    Returns: first while the next sample may be in its window, then while the window has not begun.
    """
    tails = [signed_tail(plan, operand) for operand in inner.operands]
    low, high = tails[-1]
    if inner.op in ("always", "release"):
        # The dual of the other two, whose bounds are those of the negated operands, swapped.
        left = (-tails[0][1], -tails[0][0])
        found = _fills(plan, inner.op == "release", left, (-high, -low))
        return [(-y, -x, -z) for x, y, z in found]
    return _fills(plan, inner.op == "until", tails[0], (low, high))


def _fills(plan: Plan, until: bool, left: Range, right: Range) -> list[tuple[float, float, float]]:
    running = (right[0] if plan.certain else -INF, right[1], -INF)
    if not until or not plan.dense:
        return [running, running]
    # Before the window there is at least one sample to come, at which the left operand must hold.
    return [running, (min(running[0], left[0]), min(right[1], left[1]), -INF)]
