"""What an importer collects of a foreign spec, and how it becomes a spec of this language.

In: names as they are met, assigned formulas. Out: statements in the order of the foreign text, what is declared
nowhere first. Times: bounds without a unit are in that of the spec; a param that stands in bounds only is a time
itself, and one that stands elsewhere too is multiplied by the unit where it is a bound.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from stlspec.compiler.expectations import TIME
from stlspec.compiler.names import declare
from stlspec.errors import Diagnostic, SpecError, UsageError, diagnostic
from stlspec.lang.nodes import (
    Call,
    Expression,
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
    Text,
    TimeStatement,
    Unit,
    names_in,
    operators,
)
from stlspec.lang.parse import parse
from stlspec.lang.statements import RESERVED
from stlspec.lang.units import NANOSECONDS, STEP
from stlspec.source import SourceText, Span
from stlspec.tools.importing.formulas import every_node
from stlspec.tools.importing.tokens import Comment

_TOP = Span(0, 0)


@dataclass
class Draft:
    """A spec in the making, in the names of the foreign text.

    assigned: formulas by name, in order. values: of params; None for one without. problems: errors and warnings.
    implied: signals and params that are used and not declared. bound_unit: of bounds, if not that of the time.
    """

    source: SourceText
    tool: str
    time: TimeStatement
    bound_unit: str | None = None
    title: Name | None = None
    signals: dict[str, SignalStatement] = field(default_factory=dict)
    values: dict[str, tuple[Name, Number | None]] = field(default_factory=dict)
    assigned: dict[str, tuple[Name, Expression]] = field(default_factory=dict)
    problems: list[Diagnostic] = field(default_factory=list)
    comments: list[Comment] = field(default_factory=list)
    implied: set[str] = field(default_factory=set)
    _names: dict[str, str] = field(default_factory=dict)

    @property
    def unit(self) -> str | None:
        """The unit of bounds that have none; None where they count samples."""
        return None if self.time.unit.text == STEP else self.bound_unit or self.time.unit.text

    def report(self, code: str, span: Span, **fields: Any) -> None:
        """Note an error or a warning."""
        self.problems.append(diagnostic(code, source=self.source, span=span, **fields))

    def signal(self, name: str, span: Span, kind: Name | None = None) -> None:
        """Declare a signal, once."""
        if name not in self.signals:
            legal = self.legal(name)
            origin = Text(span, name) if legal != name else None
            self.signals[name] = SignalStatement(span, Name(span, legal), kind, None, None, origin, None)

    def legal(self, name: str) -> str:
        """Return a foreign name as this language can have it: no dots, no word of its own, no other's name."""
        if name not in self._names:
            plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
            plain = plain if not plain[:1].isdigit() else f"_{plain}"
            while plain in RESERVED or plain == TIME or plain in self._names.values():
                plain += "_"
            self._names[name] = plain
        return self._names[name]

    def statements(self) -> list[Statement]:
        """Return the spec: what is used by others is a `let`, all else a hard requirement."""
        bodies = {name: formula for name, (_, formula) in self.assigned.items()}
        used = {inner for formula in bodies.values() for inner in names_in(formula)}
        times = self._times(bodies)
        written: list[SignalStatement | ParamStatement | LetStatement | RequirementStatement] = [
            SignalStatement(s.span, s.name, s.type, None, None, s.source, None) for s in self.signals.values()
        ]
        written += [
            ParamStatement(n.span, self._named(n), self._value(name, v, times), None)
            for name, (n, v) in self.values.items()
        ]
        for name, (place, formula) in self.assigned.items():
            body = self._rewritten(formula, times)
            if name in used:
                written.append(LetStatement(place.span, self._named(place), (), body))
            else:
                written.append(RequirementStatement(place.span, "hard", self._named(place), None, (), None, None, body))
        head: list[Statement] = [SpecStatement(_TOP, self._named(self.title), None)] if self.title else []
        implied = {self.legal(name) for name in self.implied}
        written.sort(key=lambda s: (_place(s), s.span.start) if s.name.text in implied else (2, s.span.start))
        return [*head, self.time, *written]

    def _named(self, name: Name) -> Name:
        return Name(name.span, self.legal(name.text))

    def _times(self, bodies: Mapping[str, Expression]) -> frozenset[str]:
        """Return the params that stand in bounds and nowhere else."""
        inside, outside = set[str](), set[str]()
        for formula in bodies.values():
            for node in every_node(formula):
                for operator in operators(node):
                    if operator.interval is not None:
                        for bound in (operator.interval.low, operator.interval.high):
                            inside |= set(names_in(bound))
                            outside |= set(names_in(bound)) if _has_unit(bound) else set()
                outside |= {node.text} if isinstance(node, Name) else set()
        return frozenset((inside - outside) & self.values.keys()) if self.unit else frozenset()

    def _value(self, name: str, value: Number | None, times: frozenset[str]) -> Number | None:
        if value is None or name not in times or self.unit is None:
            return value
        return Number(value.span, value.value, Unit(value.span, self.unit))

    def _rewritten(self, node: Expression, times: frozenset[str]) -> Expression:
        """Give names their legal form, and bounds their unit."""
        match node:
            case Name():
                return self._named(node)
            case Call(span, function, arguments):
                return Call(span, function, tuple(self._rewritten(a, times) for a in arguments))
            case Prefix(span, operator, operand):
                return Prefix(span, self._operator(operator, times), self._rewritten(operand, times))
            case Infix(span, operators, operands):
                made = tuple(self._operator(o, times) for o in operators)
                return Infix(span, made, tuple(self._rewritten(o, times) for o in operands))
        return node

    def _operator(self, operator: Operator, times: frozenset[str]) -> Operator:
        interval = operator.interval
        if interval is None:
            return operator
        low, high = (self._bound(bound, times) for bound in (interval.low, interval.high))
        return Operator(operator.span, operator.word, Interval(interval.span, low, high))

    def _bound(self, node: Expression, times: frozenset[str]) -> Expression:
        made, is_time = self._timed(node, times)
        return made if is_time else self._in_unit(made)

    def _in_unit(self, node: Expression) -> Expression:
        """Give a plain number the unit of the spec."""
        if self.unit is None or isinstance(node, Infinity) or (isinstance(node, Number) and node.value == 0):
            return node
        unit = Unit(node.span, self.unit)
        if isinstance(node, Number):
            return Number(node.span, node.value, unit)
        return Infix(node.span, (Operator(node.span, "mul"),), (node, Number(node.span, 1.0, unit)))

    def _timed(self, node: Expression, times: frozenset[str]) -> tuple[Expression, bool]:
        """Return a part of a bound in legal names, and whether it is a time already."""
        match node:
            case Number():
                return node, node.unit is not None
            case Name():
                return self._named(node), node.text in times
            case Prefix(span, operator, operand):
                inner, is_time = self._timed(operand, times)
                return Prefix(span, operator, inner), is_time
            case Infix(span, operators, operands):
                parts = [self._timed(operand, times) for operand in operands]
                timed = [is_time for _, is_time in parts]
                if operators[0].word in ("add", "sub") and any(timed):
                    parts = [(made if is_time else self._in_unit(made), True) for made, is_time in parts]
                elif (operators[0].word == "mul" and all(timed)) or (operators[0].word == "div" and timed[1]):
                    self.report("S040", span, **_PRODUCT_OF_TIMES)
                return Infix(span, operators, tuple(made for made, _ in parts)), any(timed)
        return node, False


_PRODUCT_OF_TIMES = {
    "what": "a product of times",
    "why": "bounds have a unit here",
    "help": "write its value as a param of its own",
}


def _place(statement: Statement) -> int:
    """Return 0 for what is first among the names that are declared nowhere: the signals."""
    return 0 if isinstance(statement, SignalStatement) else 1


def _has_unit(bound: Expression) -> bool:
    return any(isinstance(node, Number) and node.unit is not None for node in every_node(bound))


def time_statement(text: str) -> TimeStatement:
    """Read how time is measured, as after `time` in a spec.

    Not in the paper: other tools' languages.

    Raises: UsageError: it is no way to measure time.
    """
    syntax = parse(SourceText.of("<command line>", f"time {text}"))
    problems = list(syntax.diagnostics)
    declare(syntax, problems)
    found = [s for s in syntax.statements if isinstance(s, TimeStatement)]
    if problems or len(syntax.statements) != 1 or not found:
        what = f"`--time {text[:30]}` is no way to measure time"
        raise UsageError([diagnostic("D880", what=what, help="write --time step, --time s or --time '100 ms'")])
    return TimeStatement(_TOP, found[0].number, Unit(_TOP, found[0].unit.text))


def refuse_broken(problems: list[Diagnostic]) -> None:
    """Raise SpecError if something could not be carried. Not in the paper: other tools' languages."""
    if any(problem.severity == "error" for problem in problems):
        raise SpecError(sorted(problems, key=Diagnostic.sort_key))


UNITS = frozenset(NANOSECONDS)
