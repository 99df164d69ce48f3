"""Statements of the syntax tree as text of this language.

In: statements, made by an importer. Out: text, one statement a line, formulas on a line of their own. Brackets stand
where the language needs them, and wherever operators meet that other tools read in another order.
"""

from collections.abc import Sequence

from stlspec.compiler.printing import number_text
from stlspec.lang.nodes import (
    Call,
    Expression,
    Group,
    Index,
    Infinity,
    Infix,
    Interval,
    LetStatement,
    Name,
    Number,
    Operator,
    ParamStatement,
    Prefix,
    RequirementStatement,
    SignalStatement,
    SpecStatement,
    Statement,
    TimeStatement,
    Truth,
    UseStatement,
)
from stlspec.tools.importing.tokens import Comment

_SIGNS = {
    "lt": "<",
    "le": "<=",
    "gt": ">",
    "ge": ">=",
    "eq": "==",
    "ne": "!=",
    "add": "+",
    "sub": "-",
    "mul": "*",
    "div": "/",
    "pow": "**",
    "neg": "-",
}
_BOOLEAN, _COMPARISON, _PREFIX, _SUM, _PRODUCT, _NEGATION, _POWER, _ATOM = range(8)
_LEVELS = {"add": _SUM, "sub": _SUM, "mul": _PRODUCT, "div": _PRODUCT, "pow": _POWER}
Text = tuple[str, int]


def spec_text(statements: Sequence[Statement], comments: Sequence[Comment]) -> str:
    """Write a spec; each comment stands before the first statement that begins behind it, or that it trails.

    Not in the paper: other tools' languages.
    """
    lines: list[str] = []
    waiting = sorted(comments, key=lambda comment: comment.span.start)
    kind: type | None = None
    starts = [min(later.span.start for later in statements[i:]) for i in range(len(statements))]
    for i, statement in enumerate(statements):
        following = min((start for start in starts[i + 1 :] if start > starts[i]), default=None)
        told = [c for c in waiting if c.span.start < starts[i] or _trails(c, starts[i], following)]
        waiting = [c for c in waiting if c not in told]
        if lines and (told or type(statement) is not kind or isinstance(statement, RequirementStatement)):
            lines.append("")
        lines += [f"# {line}" for comment in told for line in comment.lines]
        lines += _statement(statement)
        kind = type(statement)
    rest = [f"# {line}" for comment in waiting for line in comment.lines]
    return "\n".join([*lines, *([""] if rest else []), *rest]) + "\n"


def _trails(comment: Comment, start: int, following: int | None) -> bool:
    at = comment.span.start
    return comment.trails and start < at and (following is None or at < following)


def _statement(statement: Statement) -> list[str]:
    match statement:
        case SpecStatement(_, name, _):
            return [f"spec {name.text}"]
        case TimeStatement(_, number, unit):
            return [f"time {unit.text}" if number is None else f"time {number_text(number)} {unit.text}"]
        case SignalStatement(_, name, kind, _, _, origin, _):
            return [
                f"signal {name.text}"
                + (f": {kind.text}" if kind else "")
                + (f' from "{origin.text}"' if origin else "")
            ]
        case ParamStatement(_, name, number, _):
            return [f"param {name.text}" + (f" = {expression_text(number)}" if number else "")]
        case LetStatement(_, name, _, body):
            return [f"let {name.text} = {expression_text(body)}"]
        case RequirementStatement(_, strength, name):
            return [f"{strength} {name.text}:", f"    {expression_text(statement.formula)}"]
        case UseStatement(_, path):
            return [f'use "{path.text}"']
    raise AssertionError(statement)


def expression_text(root: Expression) -> str:
    """Write an expression on one line. Not in the paper: other tools' languages."""
    return _text(root)[0]


def _text(node: Expression) -> Text:
    match node:
        case Number(_, value, unit):
            text = number_text(value) + (f" {unit.text}" if unit else "")
            return text, _NEGATION if value < 0 else _ATOM
        case Truth(_, value):
            return str(value).lower(), _ATOM
        case Infinity():
            return "inf", _ATOM
        case Name(_, text):
            return text, _ATOM
        case Group(_, inner):
            return f"({_text(inner)[0]})", _ATOM
        case Index(_, name, _):
            return name.text, _ATOM
        case Call(_, function, arguments):
            return f"{function.text}({', '.join(_text(argument)[0] for argument in arguments)})", _ATOM
        case Prefix(_, operator, operand):
            return _prefix(operator, _text(operand))
        case Infix(_, operators, operands):
            return _infix(operators, [_text(operand) for operand in operands])


def _prefix(operator: Operator, operand: Text) -> Text:
    if operator.word == "neg":
        return f"-{_wrapped(operand, _NEGATION)}", _NEGATION
    return f"{operator.word}{_interval(operator.interval)} {_wrapped(operand, _PREFIX)}", _PREFIX


def _infix(operators: Sequence[Operator], operands: Sequence[Text]) -> Text:
    word, (left, right) = operators[0].word, operands[:2]
    if word == "pow":
        return f"{_wrapped(left, _ATOM)} ** {_wrapped(right, _NEGATION)}", _POWER
    if word in _LEVELS:
        level = _LEVELS[word]
        # Sums of floating-point numbers do not associate: a right operand of the same level keeps its brackets.
        pairs = zip(operators, operands[1:], strict=True)
        rest = "".join(f" {_SIGNS[operator.word]} {_wrapped(operand, level + 1)}" for operator, operand in pairs)
        return _wrapped(left, level) + rest, level
    if word in _SIGNS:
        return f"{_wrapped(left, _SUM)} {_SIGNS[word]} {_wrapped(right, _SUM)}", _COMPARISON
    sign = f" {word}{_interval(operators[0].interval)} "
    return sign.join(_wrapped(operand, _PREFIX) for operand in operands), _BOOLEAN


def _interval(interval: Interval | None) -> str:
    return "" if interval is None else f"[{_text(interval.low)[0]}, {_text(interval.high)[0]}]"


def _wrapped(operand: Text, level: int) -> str:
    text, own = operand
    # A prefix formula is no number, whatever the levels say: `(not p) > 1` is an error either way.
    return text if own >= level else f"({text})"
