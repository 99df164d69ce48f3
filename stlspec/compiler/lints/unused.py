"""Declarations that nothing uses.

In: a `Subject`. Out: L615 to L617, at the name. A file without requirements declares for others, and is left alone.
"""

from collections.abc import Iterator

from stlspec.compiler.lints.subject import Subject
from stlspec.errors import Diagnostic
from stlspec.lang.nodes import (
    LetStatement,
    ParamStatement,
    RequirementStatement,
    SignalStatement,
    Statement,
    names_in,
)


def check_unused(subject: Subject) -> list[Diagnostic]:
    """Report every signal, param and let of the main file that no formula, interval or range of it uses."""
    statements = subject.syntax.statements
    if not any(isinstance(statement, RequirementStatement) for statement in statements):
        return []
    used = {name for statement in statements for name in _names(statement)}
    found = []
    for statement in statements:
        code = {SignalStatement: "L615", ParamStatement: "L616", LetStatement: "L617"}.get(type(statement))
        if code is None:
            continue
        assert isinstance(statement, SignalStatement | ParamStatement | LetStatement)
        if statement.name.text not in used:
            found.append(subject.warn(code, statement.name.span, name=statement.name.text))
    return found


def _names(statement: Statement) -> Iterator[str]:
    match statement:
        case LetStatement(arguments=arguments, body=body):
            hidden = {argument.text for argument in arguments}
            yield from (name for name in names_in(body) if name not in hidden)
        case RequirementStatement(formula=formula):
            yield from names_in(formula)
        case SignalStatement(range=extent) if extent is not None:
            yield from names_in(extent.low)
            yield from names_in(extent.high)
