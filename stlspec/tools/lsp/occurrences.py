"""Every place where a name stands, and what it names there.

In: the syntax of a file, with the files that it uses. Out: `Occurrence`s in the order of the text, each with its
`Target`, which is equal for two places exactly if they name the same thing, in whichever files they stand. Names that
nothing declares, such as functions and `now`, are left out; so is what broken statements say.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from stlspec.lang.nodes import (
    Call,
    Expression,
    Index,
    InlineData,
    LetStatement,
    Name,
    ParamStatement,
    RequirementStatement,
    SignalStatement,
    Statement,
    VerdictExpectation,
    bounds,
    post_order,
)
from stlspec.lang.parse import Syntax
from stlspec.lang.using import identity
from stlspec.source import Span

Kind = Literal["signal", "param", "let", "requirement", "argument"]
Declaration = SignalStatement | ParamStatement | LetStatement | RequirementStatement
KINDS: Mapping[type, Kind] = {
    SignalStatement: "signal",
    ParamStatement: "param",
    LetStatement: "let",
    RequirementStatement: "requirement",
}


@dataclass(frozen=True, slots=True)
class Target:
    """What a name stands for: declared in which file, and at which offset of it."""

    kind: Kind
    name: str
    file: str
    at: int


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A name where it stands; `declares` where it is declared."""

    span: Span
    target: Target
    declares: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Scope:
    """The names that a file sees: each with the file and the statement that declare it first."""

    syntax: Syntax
    declared: Mapping[str, tuple[Syntax, Declaration]]

    @classmethod
    def of(cls, syntax: Syntax) -> "Scope":
        """Collect what a file and those that it uses declare; the requirements of the others are not seen."""
        declared: dict[str, tuple[Syntax, Declaration]] = {}
        for file in (*syntax.used, syntax):
            for statement in file.statements:
                if isinstance(statement, Declaration) and (
                    file is syntax or not isinstance(statement, RequirementStatement)
                ):
                    declared.setdefault(statement.name.text, (file, statement))
        return cls(syntax, declared)

    def target(self, name: str) -> Target | None:
        """Return what a name stands for outside templates; None if nothing declares it."""
        found = self.declared.get(name)
        if found is None:
            return None
        file, statement = found
        return Target(KINDS[type(statement)], name, identity(file.source.name), statement.name.span.start)

    def occurrences(self) -> tuple[Occurrence, ...]:
        """Return every place of the file where a declared name stands."""
        targets: dict[str, Target | None] = {}
        found = []
        for statement in self.syntax.statements:
            arguments = self._arguments(statement)
            for name, declares in _names(statement):
                if name.text not in targets:
                    targets[name.text] = self.target(name.text)
                target = targets[name.text]
                if name.text in arguments and not (declares and name is statement.name):  # type: ignore[union-attr]
                    target = arguments[name.text]
                if target is not None:
                    found.append(Occurrence(name.span, target, declares))
        return tuple(sorted(found, key=lambda o: o.span))

    def _arguments(self, statement: Statement) -> dict[str, Target]:
        """Return what hides other names in a statement: the arguments of a template."""
        if not isinstance(statement, LetStatement) or not statement.arguments:
            return {}
        file = identity(self.syntax.source.name)
        return {a.text: Target("argument", a.text, file, a.span.start) for a in reversed(statement.arguments)}


def at(occurrences: Iterable[Occurrence], offset: int) -> Occurrence | None:
    """Return the occurrence at an offset, or that which ends there."""
    touching = [o for o in occurrences if o.span.start <= offset <= o.span.end]
    return touching[-1] if touching else None


def _names(statement: Statement) -> Iterator[tuple[Name, bool]]:
    """Yield the names of a statement that may stand for something declared, and whether they are declared there."""
    match statement:
        case SignalStatement(name=name, range=interval):
            yield name, True
            for bound in (interval.low, interval.high) if interval else ():
                yield from _used(bound)
        case ParamStatement(name=name):
            yield name, True
        case LetStatement(name=name, arguments=arguments, body=body):
            yield name, True
            yield from ((argument, True) for argument in arguments)
            yield from _used(body)
        case RequirementStatement(name=name, depends_on=depends_on, formula=formula):
            yield name, True
            yield from ((on, False) for on in depends_on)
            yield from _used(formula)
        case VerdictExpectation(requirement=requirement, data=data):
            yield requirement, False
            if isinstance(data, InlineData):
                yield from ((column.name, False) for column in data.columns)


def _used(root: Expression) -> Iterator[tuple[Name, bool]]:
    pending = [root]
    while pending:
        for node in post_order(pending.pop()):
            match node:
                case Name():
                    yield node, False
                case Call():
                    yield node.function, False
                case Index():
                    yield node.name, False
            pending += bounds(node)
