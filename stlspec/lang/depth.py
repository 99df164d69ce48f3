"""How deep a text nests, and where that is too much.

In: a statement of the syntax tree. Out: a diagnostic if some part of it nests deeper than `DEEPEST` levels. Flat
chains such as `a and b and c` are not nested, however long.
"""

from typing import Any

from stlspec.errors import Diagnostic, diagnostic
from stlspec.lang.nodes import (
    Call,
    Expression,
    Group,
    Index,
    Infix,
    Interval,
    LetStatement,
    Number,
    Prefix,
    RequirementStatement,
    SignalStatement,
    bounds,
    children,
    post_order,
)
from stlspec.source import SourceText

DEEPEST = 200


def too_deep(source: SourceText, statement: Any) -> Diagnostic | None:
    """Refuse what nests too deep, in bounds and indices too.

    Not in the paper: the language.

    Args:    statement: a statement or an expression.
    Returns: the diagnostic for the first place that is too deep, None if there is none.
    """
    pending = [(expression, 0) for expression in _expressions(statement)]
    while pending:
        root, outer = pending.pop()
        depth: dict[int, int] = {}
        for node in post_order(root):
            below = max((depth[id(child)] for child in children(node)), default=outer)
            depth[id(node)] = below + _nests(node)
            if depth[id(node)] > DEEPEST:
                return diagnostic("S007", source=source, span=node.span, deepest=DEEPEST)
            pending += [(bound, outer + 1) for bound in bounds(node)]
    return None


def _nests(node: Expression) -> bool:
    """Tell whether `node` adds a level: flat chains such as `a and b and c` do not."""
    match node:
        case Group() | Prefix() | Call() | Index():
            return True
        case Infix(_, operators, _):
            return operators[0].word in ("implies", "pow")
    return False


def _expressions(statement: Any) -> tuple[Expression, ...]:
    match statement:
        case LetStatement():
            return (statement.body,)
        case RequirementStatement():
            return (statement.formula,)
        case SignalStatement(range=Interval(_, low, high)):
            return (low, high)
        case Number() | Group() | Prefix() | Infix() | Call() | Index():
            return (statement,)
    return ()
