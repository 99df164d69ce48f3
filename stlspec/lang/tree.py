"""Reductions of the grammar to nodes of the syntax tree.

In: the children of each reduced rule, tokens kept. Out: the node, its span taken from its first and last
child. One method a rule, named after it; every operator rule goes through `_operator`.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from lark import Token

from stlspec.lang import nodes
from stlspec.source import Span

Child = Any  # a token, a node, or a clause made by one of the methods below
OPERATORS = frozenset(
    (
        "always eventually historically once next prev wnext wprev until since unless release not "
        "and or xor implies iff lt le gt ge eq ne assign add sub mul div pow neg"
    ).split()
)


def span_of(child: Child) -> Span:
    """Return the place of a token or of a node."""
    if isinstance(child, Token):
        assert child.start_pos is not None and child.end_pos is not None
        return Span(child.start_pos, child.end_pos)
    span: Span = child.span
    return span


def _over(children: Sequence[Child]) -> Span:
    return Span(span_of(children[0]).start, span_of(children[-1]).end)


def _name(token: Token) -> nodes.Name:
    return nodes.Name(span_of(token), str(token))


def _text(token: Token) -> nodes.Text:
    return nodes.Text(span_of(token), token[1:-1])


def _unit(token: Token) -> nodes.Unit:
    return nodes.Unit(span_of(token), str(token))


def _number(tokens: Sequence[Token]) -> nodes.Number:
    """Return a number, or `inf`, that may carry a minus."""
    value = float(tokens[-1])
    return nodes.Number(_over(tokens), -value if len(tokens) > 1 else value, None)


def _operator(rule: str, children: list[Child]) -> nodes.Operator:
    return nodes.Operator(span_of(children[0]), rule)


class Clause:
    """A clause of a header: the field that it fills and what it says."""

    __slots__ = ("field", "span", "value")

    def __init__(self, field: str, value: Child, children: Sequence[Child]) -> None:
        self.field = field
        self.value = value
        self.span = _over(children)


def _clauses(given: Sequence[Clause]) -> tuple[dict[str, Child], tuple[nodes.Name, ...]]:
    """Return the value of each clause, the first one if it is repeated, and the repeated ones."""
    found: dict[str, Child] = {}
    repeated = []
    for clause in given:
        if clause.field in found:
            repeated.append(nodes.Name(clause.span, clause.field))
        found.setdefault(clause.field, clause.value)
    return found, tuple(repeated)


class TreeBuilder:
    """The callbacks that Lark calls; without state, so that threads share one parser."""

    def __getattr__(self, rule: str) -> Callable[[list[Child]], Child]:
        """Return the callback of an operator's rule."""
        if rule in OPERATORS:
            return partial(_operator, str(rule))  # Lark passes a token
        raise AttributeError(rule)

    def statement(self, children: list[Child]) -> Child:
        """Pass on the one statement."""
        return children[0]

    def spec(self, children: list[Child]) -> nodes.SpecStatement:
        """`spec NAME ["title"]`."""
        title = _text(children[2]) if len(children) > 2 else None
        return nodes.SpecStatement(_over(children), _name(children[1]), title)

    def time(self, children: list[Child]) -> nodes.TimeStatement:
        """`time UNIT` or `time NUMBER UNIT`."""
        number = float(children[1]) if len(children) > 2 else None
        return nodes.TimeStatement(_over(children), number, _unit(children[-1]))

    def signal(self, children: list[Child]) -> nodes.SignalStatement:
        """Collect the clauses of a signal."""
        clauses, repeated = _clauses(children[2:])
        return nodes.SignalStatement(
            _over(children),
            _name(children[1]),
            clauses.get("type"),
            clauses.get("unit"),
            clauses.get("range"),
            clauses.get("source"),
            clauses.get("doc"),
            repeated,
        )

    def use(self, children: list[Child]) -> nodes.UseStatement:
        """`use "file"`."""
        return nodes.UseStatement(_over(children), _text(children[1]))

    def expect_verdict(self, children: list[Child]) -> nodes.VerdictExpectation:
        """`expect NAME holds|fails on DATA`, and its clauses."""
        clauses, repeated = _clauses(children[5:])
        return nodes.VerdictExpectation(
            _over(children),
            _name(children[1]),
            _name(children[2]),
            children[4],
            clauses.get("at"),
            clauses.get("margin"),
            repeated,
        )

    def expect_label(self, children: list[Child]) -> nodes.LabelExpectation:
        """`expect DATA is LABEL`; the label is checked later."""
        return nodes.LabelExpectation(_over(children), children[1], _name(children[3]))

    def expect_rank(self, children: list[Child]) -> nodes.RankExpectation:
        """`expect DATA outranks DATA`."""
        return nodes.RankExpectation(_over(children), children[1], children[3])

    def recording(self, children: list[Child]) -> nodes.DataFile:
        """`"file" [episode NUMBER or "name"]`."""
        episode = None
        if len(children) > 1:
            episode = _number(children[2:]) if children[2].type == "NUMBER" else _text(children[2])
        return nodes.DataFile(_over(children), _text(children[0]), episode)

    def inline(self, children: list[Child]) -> nodes.InlineData:
        """`{NAME: [...], ...}`."""
        columns = tuple(child for child in children if isinstance(child, nodes.Column))
        return nodes.InlineData(_over(children), columns)

    def column(self, children: list[Child]) -> nodes.Column:
        """`NAME: [VALUE, ...]`."""
        samples = tuple(child for child in children[3:-1] if not isinstance(child, Token))
        return nodes.Column(_over(children), _name(children[0]), samples)

    def sample(self, children: list[Child]) -> nodes.Number | nodes.Truth:
        """Return one value of a column."""
        return self.truth(children) if children[0].type in ("TRUE", "FALSE") else _number(children)

    def at_clause(self, children: list[Child]) -> Clause:
        """`at 3`, or `at -1`."""
        return Clause("at", _number(children[1:]), children)

    def margin_clause(self, children: list[Child]) -> Clause:
        """`margin >= 0.5`."""
        return Clause("margin", _number(children[2:]), children)

    def param(self, children: list[Child]) -> nodes.ParamStatement:
        """`param NAME [= [-] NUMBER [UNIT]] ["doc"]`."""
        doc = _text(children[-1]) if children[-1].type == "STRING" else None
        value = [child for child in children[3:] if child.type != "STRING"]
        number = None
        if value:
            negative = value[0].type == "MINUS"
            digits = value[negative]
            unit = _unit(value[-1]) if value[-1].type == "UNIT" else None
            number = nodes.Number(_over(value), -float(digits) if negative else float(digits), unit)
        return nodes.ParamStatement(_over(children), _name(children[1]), number, doc)

    def let(self, children: list[Child]) -> nodes.LetStatement:
        """`let NAME [(ARG, ...)] = BODY`."""
        arguments = children[2] if isinstance(children[2], tuple) else ()
        return nodes.LetStatement(_over(children), _name(children[1]), arguments, children[-1])

    def arguments(self, children: list[Child]) -> tuple[nodes.Name, ...]:
        """Return the names between the brackets."""
        return tuple(_name(child) for child in children if child.type == "NAME")

    def requirement(self, children: list[Child]) -> nodes.RequirementStatement:
        """Collect the clauses of a requirement's header; the formula comes last."""
        clauses, repeated = _clauses(children[2:-2])
        return nodes.RequirementStatement(
            _over(children),
            str(children[0]),
            _name(children[1]),
            clauses.get("doc"),
            clauses.get("depends on", ()),
            clauses.get("scale"),
            clauses.get("bound"),
            children[-1],
            repeated,
        )

    def type_clause(self, children: list[Child]) -> Clause:
        """`: real` or `: bool`."""
        return Clause("type", _name(children[1]), children)

    def unit_clause(self, children: list[Child]) -> Clause:
        """`unit "m/s"`."""
        return Clause("unit", _text(children[1]), children)

    def range_clause(self, children: list[Child]) -> Clause:
        """`in [low, high]`."""
        return Clause("range", children[1], children)

    def source_clause(self, children: list[Child]) -> Clause:
        """`from "column or path"`."""
        return Clause("source", _text(children[1]), children)

    def doc_clause(self, children: list[Child]) -> Clause:
        """Return the quoted text."""
        return Clause("doc", _text(children[0]), children)

    def depends_clause(self, children: list[Child]) -> Clause:
        """`depends on A, B`."""
        names = tuple(_name(child) for child in children[2:] if child.type == "NAME")
        return Clause("depends on", names, children)

    def scale_clause(self, children: list[Child]) -> Clause:
        """`scale NUMBER`."""
        return Clause("scale", nodes.Number(span_of(children[1]), float(children[1]), None), children)

    def bound_clause(self, children: list[Child]) -> Clause:
        """`bound tanh`; the word is checked later."""
        return Clause("bound", _name(children[1]), children)

    def infix(self, children: list[Child]) -> nodes.Infix:
        """Fold operands and operators, each operator followed by its interval if it has one."""
        operators: list[nodes.Operator] = []
        operands: list[nodes.Expression] = []
        for child in children:
            if isinstance(child, nodes.Operator):
                operators.append(child)
            elif isinstance(child, nodes.Interval):
                operators[-1] = nodes.Operator(operators[-1].span, operators[-1].word, child)
            else:
                operands.append(child)
        return nodes.Infix(_over(children), tuple(operators), tuple(operands))

    def prefix(self, children: list[Child]) -> nodes.Prefix:
        """Return the operator with its interval, before its operand."""
        operator = children[0]
        if len(children) > 2:
            operator = nodes.Operator(operator.span, operator.word, children[1])
        return nodes.Prefix(_over(children), operator, children[-1])

    def interval(self, children: list[Child]) -> nodes.Interval:
        """`[low, high]`, or `[low:high]`."""
        return nodes.Interval(_over(children), children[1], children[3])

    def number(self, children: list[Child]) -> nodes.Number:
        """Return the number with its unit."""
        unit = _unit(children[1]) if len(children) > 1 else None
        return nodes.Number(_over(children), float(children[0]), unit)

    def name(self, children: list[Child]) -> nodes.Name:
        """Return a name used in an expression."""
        return _name(children[0])

    def call(self, children: list[Child]) -> nodes.Call:
        """`f(a, b)`."""
        arguments = tuple(child for child in children[2:-1] if not isinstance(child, Token))
        return nodes.Call(_over(children), _name(children[0]), arguments)

    def index(self, children: list[Child]) -> nodes.Index:
        """`x[t]`."""
        return nodes.Index(_over(children), _name(children[0]), children[2])

    def group(self, children: list[Child]) -> nodes.Group:
        """`( ... )`."""
        return nodes.Group(_over(children), children[1])

    def truth(self, children: list[Child]) -> nodes.Truth:
        """`true` or `false`."""
        return nodes.Truth(span_of(children[0]), children[0].type == "TRUE")

    def infinity(self, children: list[Child]) -> nodes.Infinity:
        """`inf`."""
        return nodes.Infinity(span_of(children[0]))
