"""The checks of `expect` statements that need no data file: they speak of what the spec has, and of what can be.

In: the syntax and what it declares. Out: diagnostics. Whether an expectation is met is the matter of
`tools.expectations`, which runs them.
"""

import math
from collections.abc import Iterable, Mapping

from stlspec.compiler.extents import Extents
from stlspec.compiler.model import Declared, Model
from stlspec.compiler.printing import counted, number_text
from stlspec.errors import Diagnostic, Edit, Label, diagnostic
from stlspec.lang.nodes import (
    Column,
    DataFile,
    Expression,
    InlineData,
    LabelExpectation,
    LetStatement,
    Name,
    Number,
    RankExpectation,
    Truth,
    VerdictExpectation,
    names_in,
)
from stlspec.lang.parse import Syntax
from stlspec.lang.spelling import closest
from stlspec.source import SourceText

LABELS = ("good", "incomplete", "bad")
TIME = "time"
"""The column of time stamps in data that stands in a spec."""


def check_expectations(syntax: Syntax, declared: Declared, problems: list[Diagnostic]) -> None:
    """Check every `expect` statement of the main file; what is wrong is added to `problems`."""
    for statement in syntax.statements:
        match statement:
            case VerdictExpectation():
                _verdict(syntax, declared, statement, problems)
            case LabelExpectation(_, data, label):
                _file(syntax.source, data, problems)
                if label.text not in LABELS:
                    way = _meant(label.text, LABELS, f"write one of {', '.join(LABELS)}")
                    problems.append(_value(syntax.source, label, f"`{label.text}` is not a label", way))
            case RankExpectation(_, better, worse):
                _file(syntax.source, better, problems)
                _file(syntax.source, worse, problems)


def check_margins(syntax: Syntax, model: Model, problems: list[Diagnostic]) -> None:
    """Refuse margins that no trace can give, by the ranges of the signals."""
    wanted = [s for s in syntax.statements if isinstance(s, VerdictExpectation) and s.margin is not None]
    if not wanted or any(problem.severity == "error" for problem in problems):
        return
    extents = Extents(model)
    for statement in wanted:
        assert statement.margin is not None
        name, verdict = statement.requirement.text, statement.verdict.text
        low, high = extents.of(model.declared.requirements[name].formula)
        most = max(0.0, high if verdict == "holds" else -low)
        if statement.margin.value > most:
            source, span, shown = syntax.source, statement.margin.span, number_text(most)
            problems.append(diagnostic("T208", source=source, span=span, name=name, verdict=verdict, most=shown))


def signals_of(declared: Declared, formula: Expression) -> tuple[str, ...]:
    """Return the signals that a formula needs, through the lets that it uses, in the order of their declaration."""
    found: set[str] = set()
    pending = list(names_in(formula))
    while pending:
        name = pending.pop()
        if name in found:
            continue
        found.add(name)
        let = declared.lets.get(name)
        pending += _free(let) if let is not None else ()
    return tuple(name for name in declared.signals if name in found)


def _free(let: LetStatement) -> list[str]:
    """Return the names in the body of a let that are not its arguments."""
    arguments = {argument.text for argument in let.arguments}
    return [name for name in names_in(let.body) if name not in arguments]


def _value(source: SourceText, node: Name | Number | DataFile | Column, what: str, way: str) -> Diagnostic:
    return diagnostic("T205", source=source, span=node.span, what=what, help=way)


def _meant(word: str, known: Iterable[str], otherwise: str) -> str:
    close = closest(word, known, 0.5)
    return f"did you mean `{close}`?" if close else otherwise


def _verdict(syntax: Syntax, declared: Declared, statement: VerdictExpectation, problems: list[Diagnostic]) -> None:
    source, name = syntax.source, statement.requirement
    at, margin, data = statement.at, statement.margin, statement.data
    if name.text not in declared.requirements:
        problem = _no_requirement(syntax, declared, name)
        problems += [problem] if problem is not None else []
    if at is not None and not (math.isfinite(at.value) and at.value == at.value // 1):
        way = "write a whole number; -1 is the last sample"
        problems.append(_value(source, at, "a sample is named by its number", way))
    if margin is not None and margin.value == float("inf"):
        problems.append(diagnostic("S023", source=source, span=margin.span))
    if isinstance(data, DataFile):
        _file(source, data, problems)
        return
    before = len(problems)
    _inline(syntax, declared, data, problems)
    if len(problems) == before and not syntax.lost.nameless:
        problems += _missing(source, declared, name, data)
        samples = len(data.columns[0].samples)
        if at is not None and not -samples <= at.value < samples:
            problems.append(
                _value(source, at, f"the data has {counted(samples, 'sample')}", f"write a number below {samples}")
            )


def _no_requirement(syntax: Syntax, declared: Declared, name: Name) -> Diagnostic | None:
    text = name.text
    lost = syntax.lost
    if text in syntax.requirement_names or text in lost.names or lost.nameless:
        return None
    if text in declared.elsewhere:
        return diagnostic("N112", source=syntax.source, span=name.span, labels=(declared.elsewhere[text],), name=text)
    labels: tuple[Label, ...] = ()
    way = "state it with `hard` or `soft`, or remove the expectation"
    if text in declared.places:
        labels = (declared.place(text),)
        way = f"state a requirement about it: `hard {text}_holds: always {text}`"
    close = closest(text, declared.requirements, 0.5) if text not in declared.places else None
    edits = (Edit(name.span, close),) if close else ()
    way = f"did you mean `{close}`?" if close else way
    return diagnostic("N116", source=syntax.source, span=name.span, labels=labels, edits=edits, name=text, help=way)


def _file(source: SourceText, data: DataFile, problems: list[Diagnostic]) -> None:
    if not data.path.text.strip():
        problems.append(_value(source, data, "this names no file", "write the path of a demonstration"))
    if isinstance(data.episode, Number) and data.episode.value != data.episode.value // 1:
        way = 'write its number in the file, or its name in quotes: episode "a detour"'
        problems.append(_value(source, data.episode, "an episode has a whole number", way))


def _inline(syntax: Syntax, declared: Declared, data: InlineData, problems: list[Diagnostic]) -> None:
    """Check data that stands in the spec: columns of known signals, of one length, with values of their kind."""
    source, seen = syntax.source, dict[str, Column]()
    first = data.columns[0]
    for column in data.columns:
        name = column.name.text
        if name in seen:
            problems.append(_value(source, column.name, f"`{name}` is given twice", "keep one of the two"))
            return
        seen[name] = column
        if name != TIME and name not in declared.signals:
            silent = name in syntax.lost.names or syntax.lost.nameless or name in syntax.names - declared.places.keys()
            way = _meant(name, (*declared.signals, TIME), f"declare it: `signal {name}`, or remove it")
            problems += (
                [] if silent else [diagnostic("N101", source=source, span=column.name.span, name=name, help=way)]
            )
        elif len(column.samples) != len(first.samples):
            found = counted(len(column.samples), "sample")
            what = f"`{name}` has {found}, and `{first.name.text}` has {len(first.samples)}"
            problems.append(_value(source, column, what, "give each column one value for every sample"))
        else:
            problems += _values(source, declared, column)


def _values(source: SourceText, declared: Declared, column: Column) -> list[Diagnostic]:
    """Report the first value that a column cannot hold."""
    signal = declared.signals.get(column.name.text)
    is_bool = signal is not None and signal.type is not None and signal.type.text == "bool"
    if signal is not None and signal.type is not None and signal.type.text not in ("bool", "real"):
        return []
    for sample in column.samples:
        if isinstance(sample, Truth) and not is_bool:
            way = "write numbers, or declare the signal `: bool`"
            return [diagnostic("T205", source=source, span=sample.span, what="this signal is a number", help=way)]
        if isinstance(sample, Number) and is_bool and sample.value not in (0, 1):
            return [_value(source, sample, "this signal is true or false", "write true or false")]
    return []


def _missing(source: SourceText, declared: Declared, name: Name, data: InlineData) -> list[Diagnostic]:
    """Report what the formula needs and the data lacks."""
    requirement = declared.requirements.get(name.text)
    given: Mapping[str, Column] = {column.name.text: column for column in data.columns}
    needed = [] if requirement is None else [s for s in signals_of(declared, requirement.formula) if s not in given]
    if declared.time_known and declared.time.kind == "stamps" and TIME not in given:
        needed.append(TIME)
    if not needed:
        return []
    parts = ", ".join(f"{signal}: [...]" for signal in needed)
    shown = ", ".join(f"`{signal}`" for signal in needed)
    return [diagnostic("N117", source=source, span=data.span, names=shown, name=name.text, parts=parts)]
