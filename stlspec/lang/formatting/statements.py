"""Statements as documents, one function a kind.

In: a statement. Out: a `Doc`. The clauses of a header stand in the order of the language's reference, unless
comments stand among them: then they keep the author's order, so that each comment stays with its clause.
"""

from collections.abc import Sequence

from stlspec.lang.formatting.expressions import Expressions, listed
from stlspec.lang.formatting.layout import HARD, LINE, SOFT, STEP, Doc, Fold, Indent, Leaf
from stlspec.lang.nodes import (
    Column,
    DataFile,
    InlineData,
    Interval,
    LabelExpectation,
    LetStatement,
    Name,
    Number,
    ParamStatement,
    RankExpectation,
    RequirementStatement,
    SignalStatement,
    SpecStatement,
    Statement,
    Text,
    TimeStatement,
    Truth,
    UseStatement,
    VerdictExpectation,
)
from stlspec.source import Span

Clause = tuple[int, int, Doc]
"""Where a clause begins and ends, and its document."""


def statement_doc(made: Expressions, statement: Statement) -> Doc:
    """Return the document of a statement.

    Not in the paper: the language.

    Args:    made: makes the documents of expressions of this text. statement: one without diagnostics.
    Returns: the document, to be written at the left margin.
    """
    match statement:
        case SpecStatement():
            title = [_doc_clause(statement.title)] if statement.title else []
            return _header(made, statement.span.start, "spec", statement.name, title, STEP)
        case UseStatement():
            return (Leaf("use", statement.span.start), " ", _text(statement.path))
        case TimeStatement():
            return _time(made, statement)
        case SignalStatement():
            return _header(made, statement.span.start, "signal", statement.name, _signal(made, statement), STEP)
        case ParamStatement():
            return _param(made, statement)
        case LetStatement():
            return _let(made, statement)
        case RequirementStatement():
            clauses = _requirement(made, statement)
            head = _header(made, statement.span.start, statement.strength, statement.name, clauses, 2 * STEP)
            return (head, ":", Indent((HARD, made.doc(statement.formula))))
        case VerdictExpectation():
            return _verdict(made, statement)
        case LabelExpectation(span, data, label):
            return _expect(
                span, (_recording(made, data), (Leaf("is", made.places.before(label.span.start, 1)), " ", _name(label)))
            )
        case RankExpectation(span, better, worse):
            word = Leaf("outranks", made.places.before(worse.span.start, 1))
            return _expect(span, (_recording(made, better), (word, " ", _recording(made, worse))))


def _name(name: Name) -> Leaf:
    return Leaf(name.text, name.span.start)


def _text(text: Text) -> Leaf:
    return Leaf(f'"{text.text}"', text.span.start)


def _doc_clause(text: Text) -> Clause:
    return (text.span.start, text.span.end, _text(text))


def _header(made: Expressions, start: int, word: str, name: Name, clauses: Sequence[Clause], indent: int) -> Doc:
    """Return the word and the name of a statement, and its clauses."""
    end = max((clause[1] for clause in clauses), default=name.span.end)
    if made.places.has_comment(Span(start, end)):
        clauses = sorted(clauses, key=lambda clause: clause[0])
    more: list[Doc] = []
    for _, _, clause in clauses:
        glued = not more and isinstance(clause, tuple) and clause[:1] == (_COLON,)
        more += ["" if glued else LINE, clause]
    return Fold((Leaf(word, start), " ", _name(name), Indent(tuple(more), indent)), start, end)


_COLON = ": "


def _worded(made: Expressions, word: str, at: int, end: int, doc: Doc, count: int = 1) -> Clause:
    """Return a clause whose word stands `count` tokens before place `at`."""
    start = made.places.before(at, count)
    return (start, end, (Leaf(word, start), " ", doc))


def _signal(made: Expressions, statement: SignalStatement) -> list[Clause]:
    clauses: list[Clause] = []
    if statement.type:
        start = made.places.before(statement.type.span.start, 1)
        clauses.append((start, statement.type.span.end, (_COLON, _name(statement.type))))
    for word, text in (("unit", statement.unit), ("from", statement.source)):
        if text:
            clauses.append(_worded(made, word, text.span.start, text.span.end, _text(text)))
    if statement.range:
        between = _worded(
            made, "in", statement.range.span.start, statement.range.span.end, _interval(made, statement.range)
        )
        clauses.insert(len(clauses) - bool(statement.source), between)
    return clauses + ([_doc_clause(statement.doc)] if statement.doc else [])


def _interval(made: Expressions, interval: Interval) -> Doc:
    return made.interval(interval, made.doc(interval.low), made.doc(interval.high))


def _requirement(made: Expressions, statement: RequirementStatement) -> list[Clause]:
    clauses = [_doc_clause(statement.doc)] if statement.doc else []
    names = statement.depends_on
    if names:
        end = names[-1].span.end
        more = [part for name in names[1:] for part in (",", Fold((LINE, _name(name)), name.span.start, name.span.end))]
        clauses.append(_worded(made, "depends on", names[0].span.start, end, (_name(names[0]), Indent(tuple(more))), 2))
    if statement.scale:
        span = statement.scale.span
        clauses.append(_worded(made, "scale", span.start, span.end, made.number(statement.scale)))
    if statement.bound:
        span = statement.bound.span
        clauses.append(_worded(made, "bound", span.start, span.end, _name(statement.bound)))
    return clauses


def _time(made: Expressions, statement: TimeStatement) -> Doc:
    words = made.places.words(Span(statement.span.start, statement.unit.span.start))
    return (
        Leaf("time", statement.span.start),
        " ",
        Leaf(" ".join([*words[1:], statement.unit.text]), statement.unit.span.start),
    )


def _param(made: Expressions, statement: ParamStatement) -> Doc:
    parts: list[Doc] = [Leaf("param", statement.span.start), " ", _name(statement.name)]
    if statement.number:
        parts += [" = ", made.number(statement.number)]
    if statement.doc:
        parts.append(Indent((LINE, _text(statement.doc))))
    return Fold(tuple(parts), statement.span.start, statement.span.end)


def _let(made: Expressions, statement: LetStatement) -> Doc:
    head: list[Doc] = [Leaf("let", statement.span.start), " ", _name(statement.name)]
    if statement.arguments:
        names = [_name(argument) for argument in statement.arguments]
        last = statement.arguments[-1].span.end
        head.append(Fold(listed("(", names, ")"), statement.arguments[0].span.start, last))
    body = statement.body
    return (*head, " =", Indent(Fold((LINE, made.doc(body)), body.span.start, body.span.end)))


def _expect(span: Span, parts: Sequence[Doc]) -> Doc:
    more = [part for each in parts[1:] for part in (LINE, each)]
    return Fold((Leaf("expect", span.start), " ", parts[0], Indent(tuple(more))), span.start, span.end)


def _verdict(made: Expressions, statement: VerdictExpectation) -> Doc:
    data = statement.data
    shown = _recording(made, data) if isinstance(data, DataFile) else _inline(made, data)
    verdict = (_name(statement.requirement), " ", _name(statement.verdict))
    parts: list[tuple[int, Doc]] = []
    for word, number, count in (("at", statement.at, 1), ("margin >=", statement.margin, 2)):
        if number:
            start, _, clause = _worded(made, word, number.span.start, number.span.end, _signed(made, number), count)
            parts.append((start, clause))
    if made.places.has_comment(statement.span):
        parts.sort(key=lambda part: part[0])
    on = (Leaf("on", made.places.before(data.span.start, 1)), " ", shown)
    return _expect(statement.span, ((*verdict, " ", on), *(clause for _, clause in parts)))


def _signed(made: Expressions, value: Number | Truth) -> Leaf:
    if isinstance(value, Truth):
        return Leaf("true" if value.value else "false", value.span.start)
    return made.number(value)


def _recording(made: Expressions, data: DataFile) -> Doc:
    episode = data.episode
    if episode is None:
        return _text(data.path)
    shown = _text(episode) if isinstance(episode, Text) else made.number(episode)
    word = Leaf("episode", made.places.before(episode.span.start, 1))
    return (_text(data.path), " ", word, " ", shown)


def _inline(made: Expressions, data: InlineData) -> Doc:
    columns = [_column(made, column) for column in data.columns]
    return Fold(
        listed(Leaf("{", data.span.start), columns, Leaf("}", data.span.end - 1)), data.span.start, data.span.end
    )


def _column(made: Expressions, column: Column) -> Doc:
    """Return a column; many samples fill lines."""
    samples: list[Doc] = [_signed(made, column.samples[0])]
    for sample in column.samples[1:]:
        samples += [",", Fold((LINE, _signed(made, sample)), sample.span.start, sample.span.end)]
    closing = Leaf("]", column.span.end - 1)
    inner = Fold(("[", Indent((SOFT, *samples)), SOFT, closing), column.samples[0].span.start, column.span.end)
    return (_name(column.name), ": ", inner)
