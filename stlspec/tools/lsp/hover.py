"""What is said of the word under the pointer.

In: a reviewed buffer and an offset. Out: Markdown, and the stretch that it is about: for a name its declaration, with
unit, range, value, weight and horizon as far as they are known; for an operator, a function or a word its meaning; for
a code in a comment what the code means.
"""

import re
from dataclasses import dataclass

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.dependencies import ancestors, dependency_weights, softmax
from stlspec.compiler.horizon import horizons
from stlspec.compiler.lower import Sketch, sketch
from stlspec.compiler.model import Model
from stlspec.compiler.notation import ticks_text
from stlspec.compiler.printing import number_text
from stlspec.errors import CATALOGUE
from stlspec.lang.nodes import (
    Expression,
    Interval,
    LetStatement,
    ParamStatement,
    RequirementStatement,
    SignalStatement,
    bounds,
    operators,
    post_order,
)
from stlspec.lang.parse import Syntax
from stlspec.lang.units import spell
from stlspec.source import SourceText, Span
from stlspec.tools.lsp import words
from stlspec.tools.lsp.cursor import Token, token_at
from stlspec.tools.lsp.navigation import occurrence_at
from stlspec.tools.lsp.occurrences import Declaration, Scope
from stlspec.tools.lsp.words import Word
from stlspec.tools.lsp.workspace import Reviewed

_LONGEST = 400
_CODE = re.compile(r"[A-Za-z]\d{3}")
_SPACE = re.compile(r"\s+")


@dataclass(frozen=True, slots=True)
class Hover:
    """Markdown about a stretch of the text."""

    span: Span
    markdown: str


def hover(reviewed: Reviewed, offset: int) -> Hover | None:
    """Return what is said of the word at an offset; None if there is nothing to say."""
    syntax = reviewed.syntax
    if syntax is None or reviewed.model is None:
        return None
    comment = next((c for c in syntax.comments if c.span.start <= offset <= c.span.end), None)
    if comment is not None:
        return _code(syntax.source, comment.span, offset)
    found = occurrence_at(syntax, offset)
    if found is not None and found.target.kind == "argument":
        return Hover(found.span, _shown(f"{found.target.name}", "An argument of the template."))
    if found is not None:
        file, statement = Scope.of(syntax).declared[found.target.name]
        return Hover(found.span, _declaration(reviewed, reviewed.model, file, statement))
    return _operator(reviewed.model, syntax, offset) or _word(token_at(syntax.source, offset))


def _shown(form: str, *paragraphs: str) -> str:
    return "\n\n".join([f"```stlspec\n{form}\n```", *filter(None, paragraphs)])


def _code(source: SourceText, span: Span, offset: int) -> Hover | None:
    """Say what a code in a comment means."""
    for match in _CODE.finditer(source.text, span.start, span.end):
        row = CATALOGUE.get(match[0].upper())
        if row is not None and match.start() <= offset <= match.end():
            return Hover(Span(*match.span()), f"**{row.code}**: {row.title}\n\n{row.explanation}")
    return None


def _operator(model: Model, syntax: Syntax, offset: int) -> Hover | None:
    """Say what an operator of a good statement means, and what its interval comes to."""
    for statement in syntax.statements:
        if not statement.span.start <= offset <= statement.span.end:
            continue
        pending = list(_expressions(statement))
        while pending:
            for node in post_order(pending.pop()):
                pending += bounds(node)
                for operator in operators(node):
                    if operator.span.start <= offset <= operator.span.end:
                        word, interval = words.OPERATORS[operator.word], operator.interval
                        return Hover(operator.span, _shown(word.form, word.meaning, _interval(model, interval)))
    return None


def _expressions(statement: object) -> tuple[Expression, ...]:
    match statement:
        case LetStatement(body=body):
            return (body,)
        case RequirementStatement(formula=formula):
            return (formula,)
        case SignalStatement(range=Interval(low=low, high=high)):
            return (low, high)
    return ()


def _interval(model: Model, interval: Interval | None) -> str:
    ticks = model.intervals.get(id(interval)) if interval is not None else None
    if ticks is None:
        return ""
    low, high = (_time(bound, model.declared.time) for bound in ticks)
    return f"Here from {low} to {high}." if ticks[1] is not None else f"Here from {low} on."


def _time(ticks: int | None, time: TimeBase) -> str:
    text = ticks_text(ticks, time)
    return text if time.kind != "step" or ticks is None else f"{text} {'step' if ticks == 1 else 'steps'}"


def _word(token: Token | None) -> Hover | None:
    """Say what a word means that is no declared name and no operator of a good statement."""
    if token is None or token.kind in ("STRING", "BAD_STRING", "NUMBER"):
        return None
    tables = (words.STATEMENTS, words.FUNCTIONS, words.CONSTANTS, words.OPERATORS, words.VALUES)
    word: Word | None = words.CLAUSES.get(token.kind)
    word = word or next((table[token.text] for table in tables if token.text in table), None)
    if word is None and token.text == "t":
        word = Word("t", "Read as `now`: " + words.CONSTANTS["now"].meaning)
    return Hover(token.span, _shown(word.form, word.meaning)) if word is not None else None


def _declaration(reviewed: Reviewed, model: Model, file: Syntax, statement: Declaration) -> str:
    """Describe what a name stands for."""
    head = _SPACE.sub(" ", _bare(file, statement)).strip().replace(" :", ":")
    head = head if len(head) <= _LONGEST else head[: _LONGEST - 1] + "…"
    elsewhere = f"Declared in `{file.source.name}`." if file is not reviewed.syntax else ""
    match statement:
        case SignalStatement():
            return _shown(head, _doc(statement), _signal(model, statement), elsewhere)
        case ParamStatement():
            return _shown(head, _doc(statement), _param(model, statement), elsewhere)
        case LetStatement():
            return _shown(head, _let(reviewed, model, statement), elsewhere)
        case RequirementStatement():
            return _shown(head, _doc(statement), _requirement(reviewed, model, statement), elsewhere)


def _bare(file: Syntax, statement: Declaration) -> str:
    """Return the text of a statement without its comments and its doc."""
    doc = None if isinstance(statement, LetStatement) else statement.doc
    text, start = "", statement.span.start
    for left_out in sorted([comment.span for comment in file.comments] + ([doc.span] if doc else [])):
        if start <= left_out.start < statement.span.end:
            text += file.source.text[start : left_out.start]
            start = left_out.end
    return text + file.source.text[start : statement.span.end]


def _doc(statement: SignalStatement | ParamStatement | RequirementStatement) -> str:
    """Return the doc of a statement as Markdown that shows it as it is written."""
    text = statement.doc.text if statement.doc is not None else ""
    return re.sub(r"([\\`*_{}\[\]<>()#+!|&~-])", r"\\\1", text)


def _signal(model: Model, statement: SignalStatement) -> str:
    signal = model.signals.get(statement.name.text)
    if signal is None:
        return ""
    unit = f" in `{signal.unit}`" if signal.unit else ""
    facts = ["True or false." if signal.type == "bool" else f"A number{unit}."]
    if signal.low is not None and signal.high is not None:
        facts.append(f"Every sample lies in [{number_text(signal.low)}, {number_text(signal.high)}].")
    facts.append(f"Read from `{signal.source}`." if signal.source else "")
    return " ".join(filter(None, facts))


def _param(model: Model, statement: ParamStatement) -> str:
    name = statement.name.text
    param = model.params.get(name)
    if param is None:
        return f"Without a value: bind it with `-p {name}=VALUE`."
    return f"Value: {number_text(param.value)}{' ' + param.unit if param.unit else ''}; `-p {name}=...` replaces it."


def _let(reviewed: Reviewed, model: Model, statement: LetStatement) -> str:
    if statement.arguments:
        return "A template: its arguments are understood where it is called."
    typing = model.let_typings.get(statement.name.text)
    if typing is None or typing.kind == "broken":
        return ""
    if typing.kind == "formula":
        return f"A formula. {_horizon(reviewed, model, statement.body)}".strip()
    unit = f" in `{spell(typing.unit)}`" if typing.unit else ""
    return f"A number{unit}{f', {number_text(typing.value)}' if typing.value is not None else ''}."


def _requirement(reviewed: Reviewed, model: Model, statement: RequirementStatement) -> str:
    """Return weight and horizon of a requirement; both need a spec without errors."""
    name = statement.name.text
    if reviewed.errors or model.declared.requirements.get(name) is not statement:
        return "Weight and horizon are known once the spec has no errors."
    edges = {n: [d.text for d in r.depends_on] for n, r in model.declared.requirements.items()}
    raw = dict(zip(edges, dependency_weights(list(ancestors(edges).values())), strict=True))
    share = dict(zip(edges, softmax(list(raw.values())), strict=True))[name]
    weight = f"Weight {raw[name]} → {share:.3f}."
    return f"{weight} {_horizon(reviewed, model, statement.formula)}".strip()


def _horizon(reviewed: Reviewed, model: Model, formula: Expression) -> str:
    """Say how far ahead a formula looks."""
    if reviewed.errors:
        return ""
    drawn: Sketch = sketch(model)
    node = drawn.made.get(id(formula))
    if node is None:
        return ""
    ahead = horizons(drawn.nodes, model.declared.time)[node]
    if ahead == 0:
        return "Horizon: 0, the sample itself."
    if node in drawn.open and ahead is None:
        return "Horizon: to the end, or set by a param without a value."
    return f"Horizon: {_time(ahead, model.declared.time) if ahead is not None else 'to the end of the trace'}."
