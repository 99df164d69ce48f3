"""The statements of a spec, as an editor lists them.

In: the syntax of a file. Out: `Symbol`s in the order of the text.
"""

from dataclasses import dataclass

from stlspec.lang.nodes import (
    LetStatement,
    Name,
    ParamStatement,
    RequirementStatement,
    SignalStatement,
    SpecStatement,
    Statement,
    Text,
    UseStatement,
    VerdictExpectation,
)
from stlspec.lang.parse import Syntax
from stlspec.source import Span


@dataclass(frozen=True, slots=True)
class Symbol:
    """A statement: its name, what it is, the stretch that it takes and that of its name."""

    name: str
    kind: str
    detail: str
    span: Span
    name_span: Span


def outline(syntax: Syntax) -> tuple[Symbol, ...]:
    """Return the statements that say something under a name, and the expectations."""
    return tuple(found for statement in syntax.statements if (found := _symbol(syntax, statement)) is not None)


def _symbol(syntax: Syntax, statement: Statement) -> Symbol | None:
    match statement:
        case SpecStatement(name=name, title=title):
            return _named(statement.span, name, "spec", title)
        case UseStatement(path=path):
            return Symbol(path.text or "use", "use", "use", statement.span, path.span)
        case SignalStatement(name=name, doc=doc):
            return _named(statement.span, name, "signal", doc)
        case ParamStatement(name=name, doc=doc):
            return _named(statement.span, name, "param", doc)
        case LetStatement(name=name, arguments=arguments):
            return _named(statement.span, name, "template" if arguments else "let", None)
        case RequirementStatement(name=name, doc=doc, strength=strength):
            return _named(statement.span, name, strength, doc)
        case VerdictExpectation(requirement=name, verdict=verdict):
            return Symbol(f"expect {name.text} {verdict.text}", "expect", "", statement.span, name.span)
    if syntax.source.slice(statement.span).startswith("expect"):
        text = " ".join(syntax.source.slice(statement.span).split())
        return Symbol(text if len(text) <= 60 else f"{text[:59]}…", "expect", "", statement.span, statement.span)
    return None


def _named(span: Span, name: Name, kind: str, doc: Text | None) -> Symbol:
    return Symbol(name.text, kind, f"{kind}{f': {doc.text}' if doc is not None else ''}", span, name.span)
