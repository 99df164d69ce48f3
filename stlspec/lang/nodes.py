"""The syntax tree: what the text says, with a span for every piece, and nothing that it means.

In: reductions of the parser. Out: frozen nodes. Formulas and arithmetic share one set of nodes, because one
grammar covers both; a later pass tells reals from Booleans. Every operator of the language, prefix or infix,
is an `Operator` inside a `Prefix` or an `Infix`, so that passes need no case for each of them.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from stlspec.source import Span


@dataclass(frozen=True, slots=True)
class Name:
    """A name, where it is declared or used."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Text:
    """A quoted text, without its quotes."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit written after a number, such as `ms` or `m/s`."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Number:
    """A number as written, with its unit if it has one."""

    span: Span
    value: float
    unit: Unit | None


@dataclass(frozen=True, slots=True)
class Truth:
    """`true` or `false`."""

    span: Span
    value: bool


@dataclass(frozen=True, slots=True)
class Infinity:
    """`inf`."""

    span: Span


@dataclass(frozen=True, slots=True)
class Group:
    """An expression in round brackets; they are kept because the formatter and some lints want them."""

    span: Span
    inner: "Expression"


@dataclass(frozen=True, slots=True)
class Interval:
    """The bounds of a temporal operator or the range of a signal."""

    span: Span
    low: "Expression"
    high: "Expression"


@dataclass(frozen=True, slots=True)
class Operator:
    """One operator where it stands: its canonical word, as the grammar's rule names it, and its interval."""

    span: Span
    word: str
    interval: Interval | None = None


@dataclass(frozen=True, slots=True)
class Prefix:
    """An operator before its operand: `not`, the unary minus `neg`, or a temporal one."""

    span: Span
    operator: Operator
    operand: "Expression"


@dataclass(frozen=True, slots=True)
class Infix:
    """Operators of one level between their operands; there is one operand more than operators."""

    span: Span
    operators: tuple[Operator, ...]
    operands: tuple["Expression", ...]


@dataclass(frozen=True, slots=True)
class Call:
    """`abs(x)`, or a template with its arguments."""

    span: Span
    function: Name
    arguments: tuple["Expression", ...]


@dataclass(frozen=True, slots=True)
class Index:
    """`x[t]`, a habit from other tools that reads as `x`."""

    span: Span
    name: Name
    index: "Expression"


Expression = Number | Name | Truth | Infinity | Group | Prefix | Infix | Call | Index


@dataclass(frozen=True, slots=True)
class SpecStatement:
    """`spec NAME ["title"]`."""

    span: Span
    name: Name
    title: Text | None


@dataclass(frozen=True, slots=True)
class TimeStatement:
    """`time step`, `time s` (number None) or `time 100 ms`."""

    span: Span
    number: float | None
    unit: Unit


@dataclass(frozen=True, slots=True)
class SignalStatement:
    """`signal NAME [: TYPE] [unit "..."] [in [lo, hi]] [from "..."] ["doc"]`."""

    span: Span
    name: Name
    type: Name | None
    unit: Text | None
    range: Interval | None
    source: Text | None
    doc: Text | None
    repeated: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class ParamStatement:
    """`param NAME [= NUMBER [UNIT]] ["doc"]`; the number carries its sign."""

    span: Span
    name: Name
    number: Number | None
    doc: Text | None


@dataclass(frozen=True, slots=True)
class LetStatement:
    """`let NAME [(ARG, ...)] = EXPRESSION`."""

    span: Span
    name: Name
    arguments: tuple[Name, ...]
    body: Expression


@dataclass(frozen=True, slots=True)
class RequirementStatement:
    """`hard|soft NAME ["doc"] [depends on ...] [scale N] [bound B]: FORMULA`."""

    span: Span
    strength: str
    name: Name
    doc: Text | None
    depends_on: tuple[Name, ...]
    scale: Number | None
    bound: Name | None
    formula: Expression
    repeated: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class UseStatement:
    """`use "file.stl"`."""

    span: Span
    path: Text


@dataclass(frozen=True, slots=True)
class DataFile:
    """`"demo.csv" [episode 3]`: a file of demonstrations, or one of those in it, by number or by name."""

    span: Span
    path: Text
    episode: Number | Text | None


@dataclass(frozen=True, slots=True)
class Column:
    """`d_obs: [2, 1, 1]` in data that stands in the spec; numbers carry their sign."""

    span: Span
    name: Name
    samples: tuple[Number | Truth, ...]


@dataclass(frozen=True, slots=True)
class InlineData:
    """`{d_obs: [2, 1, 1], time: [0, 1, 2]}`."""

    span: Span
    columns: tuple[Column, ...]


@dataclass(frozen=True, slots=True)
class VerdictExpectation:
    """`expect NAME holds|fails on DATA [at K] [margin >= M]`."""

    span: Span
    requirement: Name
    verdict: Name
    data: DataFile | InlineData
    at: Number | None
    margin: Number | None
    repeated: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class LabelExpectation:
    """`expect "demo.csv" is good|incomplete|bad`."""

    span: Span
    data: DataFile
    label: Name


@dataclass(frozen=True, slots=True)
class RankExpectation:
    """`expect "a.csv" outranks "b.csv"`."""

    span: Span
    better: DataFile
    worse: DataFile


ExpectStatement = VerdictExpectation | LabelExpectation | RankExpectation

Statement = (
    SpecStatement
    | UseStatement
    | TimeStatement
    | SignalStatement
    | ParamStatement
    | LetStatement
    | RequirementStatement
    | ExpectStatement
)


def children(node: Expression) -> tuple[Expression, ...]:
    """Return the operands of `node`, the bounds of its intervals left out."""
    match node:
        case Group(_, inner):
            return (inner,)
        case Prefix(_, _, operand):
            return (operand,)
        case Infix(_, _, operands):
            return operands
        case Call(_, _, arguments):
            return arguments
    return ()


def operators(node: Expression) -> tuple[Operator, ...]:
    """Return the operators of `node`, none for what is no operation."""
    match node:
        case Prefix(_, operator, _):
            return (operator,)
        case Infix(_, found, _):
            return found
    return ()


def bounds(node: Expression) -> tuple[Expression, ...]:
    """Return the expressions in square brackets that belong to `node`: bounds of its intervals, its index."""
    if isinstance(node, Index):
        return (node.index,)
    intervals = [operator.interval for operator in operators(node) if operator.interval is not None]
    return tuple(bound for interval in intervals for bound in (interval.low, interval.high))


def post_order(root: Expression) -> Iterator[Expression]:
    """Yield every expression under `root`, operands before what holds them; deep trees need no deep stack."""
    pending: list[tuple[Expression, bool]] = [(root, False)]
    while pending:
        node, expanded = pending.pop()
        below = () if expanded else children(node)
        if below:
            pending.append((node, True))
            pending.extend((child, False) for child in reversed(below))
        else:
            yield node


def names_in(root: Expression) -> Iterable[str]:
    """Yield the names that an expression uses, in its intervals too."""
    pending = [root]
    while pending:
        for node in post_order(pending.pop()):
            match node:
                case Name():
                    yield node.text
                case Call():
                    yield node.function.text
                case Index():
                    yield node.name.text
            if not isinstance(node, Index):
                pending += bounds(node)
