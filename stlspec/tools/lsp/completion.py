"""What may be written at the cursor.

In: a reviewed buffer and an offset. Out: `Item`s. The grammar's own automaton, fed with the statement up to the cursor,
says which kinds of words fit; where a name fits, what stands before it says which. A statement that is broken already
is offered all names of formulas.
"""

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from stlspec.compiler.checks import BOUNDINGS
from stlspec.compiler.expectations import LABELS, TIME
from stlspec.compiler.inference import ARITHMETIC
from stlspec.errors import CATALOGUE
from stlspec.lang.nodes import (
    Group,
    LetStatement,
    RequirementStatement,
    SignalStatement,
    SpecStatement,
    TimeStatement,
    Truth,
    operators,
)
from stlspec.lang.parse import Syntax
from stlspec.lang.statements import RESERVED, STATEMENT_WORDS, TIME_UNITS
from stlspec.lang.units import KNOWN, STEP, dimension
from stlspec.lang.using import resolve
from stlspec.source import Span
from stlspec.tools.lsp import words
from stlspec.tools.lsp.cursor import Typed, typed
from stlspec.tools.lsp.occurrences import KINDS, Declaration, Scope
from stlspec.tools.lsp.words import Word
from stlspec.tools.lsp.workspace import Reviewed

_MOST_FILES = 500
_SPECS = (".stl", ".stlspec")
_DATA = (".csv", ".json", ".jsonl", ".npz", ".parquet")
_HEADS = ("HARD", "SOFT")
_OPERATORS = tuple(word for word in words.OPERATORS if word in RESERVED)
_FORMULA = frozenset({"NAME", "NOT", *(word.upper() for word in _OPERATORS)})
_SHOWN = 120


@dataclass(frozen=True, slots=True)
class Item:
    """One thing that may be written in place of a stretch of the text.

    kind: of declared names as they are declared, else word, function, unit, value, file, folder or code. order: the
    lower, the further up in the list.
    """

    span: Span
    text: str
    kind: str
    detail: str = ""
    doc: str = ""
    order: int = 0


@dataclass(frozen=True, slots=True)
class _Place:
    """Where the cursor is."""

    reviewed: Reviewed
    syntax: Syntax
    scope: Scope
    typed: Typed

    @property
    def head(self) -> str:
        return self.typed.tokens[0].kind if self.typed.tokens else ""

    @property
    def before(self) -> str:
        """The terminal before the cursor."""
        return self.typed.tokens[-1].kind if self.typed.tokens else ""

    def has(self, kind: str) -> bool:
        return any(token.kind == kind for token in self.typed.tokens)

    def begins_line(self) -> bool:
        text, start = self.syntax.source.text, self.typed.span.start
        return not text[text.rfind("\n", 0, start) + 1 : start].strip()

    def inside(self) -> str:
        """Return the terminal of the innermost bracket that is open; none outside brackets."""
        pending: list[str] = []
        for token in self.typed.tokens:
            if token.kind in ("LPAR", "LSQB", "LBRACE"):
                pending.append(token.kind)
            elif token.kind in ("RPAR", "RSQB", "RBRACE") and pending:
                pending.pop()
        return pending[-1] if pending else ""


def completion(reviewed: Reviewed, offset: int) -> list[Item]:
    """Return what may be written at an offset, in place of the word that ends there."""
    syntax = reviewed.syntax
    if syntax is None:
        return []
    comment = next((c for c in syntax.comments if c.span.start < offset <= c.span.end), None)
    if comment is not None:
        return _codes(syntax, comment.span, offset)
    names = syntax.names.union(*(file.names for file in syntax.used))
    place = _Place(reviewed, syntax, Scope.of(syntax), typed(syntax.source, offset, names))
    if place.before == "BAD_STRING":
        return _in_quotes(place, offset)
    span = place.typed.span
    found = [*_names(place), *_words(place), *_units(place), *_statements(place)]
    return [Item(span, i.text, i.kind, i.detail, i.doc, i.order) for i in dict.fromkeys(found)]


def _item(text: str, kind: str, word: Word | None = None, order: int = 0) -> Item:
    return Item(Span(0, 0), text, kind, word.form if word else "", word.meaning if word else "", order)


def _codes(syntax: Syntax, span: Span, offset: int) -> list[Item]:
    """Offer the codes of warnings in a comment that ignores some."""
    text = syntax.source.text[span.start : offset]
    if "stlspec" not in text or "ignore" not in text:
        return []
    word = len(text) - len(text.rstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"))
    at = Span(offset - word, offset)
    rows = [row for row in CATALOGUE.values() if row.level == "warning" and row.kind == "spec"]
    return [Item(at, row.code, "code", row.title, row.explanation) for row in rows]


def _statements(place: _Place) -> Iterator[Item]:
    """Offer the words with which statements begin, where a line does."""
    if not place.begins_line():
        return
    kinds = {type(statement) for statement in place.syntax.statements}
    once = {"spec": SpecStatement, "time": TimeStatement}
    for word in STATEMENT_WORDS:
        if once.get(word) not in kinds:
            yield _item(word, "word", words.STATEMENTS[word], 3)


def _words(place: _Place) -> Iterator[Item]:
    """Offer the words of clauses and operators that fit."""
    fits = place.typed.fits or (_FORMULA if _in_formula(place) else frozenset())
    for terminal, word in words.CLAUSES.items():
        if terminal in fits:
            text = {"DEPENDS": "depends on", "UNIT_WORD": "unit"}.get(terminal, terminal.lower())
            yield _item(text, "word", word, 1)
    for operator in _OPERATORS:
        if operator.upper() in fits:
            yield _item(operator, "word", words.OPERATORS[operator], 2)
    for constant in ("true", "false", "inf"):
        if constant.upper() in fits:
            yield _item(constant, "value", words.CONSTANTS[constant], 2)


def _units(place: _Place) -> Iterator[Item]:
    """Offer units behind a number on its line."""
    if "UNIT" not in place.typed.fits or place.before != "NUMBER":
        return
    between = place.syntax.source.text[place.typed.tokens[-1].span.end : place.typed.span.start]
    if "\n" in between:
        return
    statements = place.syntax.statements
    time = next((s.unit.text for s in statements if isinstance(s, TimeStatement)), STEP)
    times = (STEP,) if time == STEP and place.inside() == "LSQB" else TIME_UNITS
    units = times if place.inside() == "LSQB" and place.head != "SIGNAL" else (*times, *_declared_units(place))
    for unit in dict.fromkeys(units):
        yield _item(unit, "unit", order=0 if unit == time else 1)


def _declared_units(place: _Place) -> Iterator[str]:
    for _, statement in place.scope.declared.values():
        if isinstance(statement, SignalStatement) and statement.unit is not None and dimension(statement.unit.text):
            yield statement.unit.text


def _in_formula(place: _Place) -> bool:
    return (place.head in _HEADS and place.has("COLON")) or (place.head == "LET" and place.has("ASSIGN"))


def _names(place: _Place) -> Iterator[Item]:
    """Offer the names that fit where a name does."""
    fits = place.typed.fits
    if not fits and _in_formula(place):
        yield from _formula_names(place, numbers_only=False)
    if "NAME" not in fits:
        return
    match place.head:
        case "TIME":
            yield from (_item(unit, "unit") for unit in (STEP, *TIME_UNITS))
        case "SIGNAL" if place.before == "COLON":
            yield from _values(("real", "bool"))
        case "EXPECT":
            yield from _expected(place)
        case "HARD" | "SOFT" if not place.has("COLON"):
            yield from _header(place)
        case _ if "NUMBER" in fits:
            yield from _formula_names(place, numbers_only="NOT" not in fits)


def _values(texts: Iterable[str]) -> Iterator[Item]:
    return (_item(text, "value", words.VALUES[text]) for text in texts)


def _expected(place: _Place) -> Iterator[Item]:
    if place.before == "IS":
        yield from _values(LABELS)
    elif place.inside() == "LBRACE":
        yield from _declared(place, ("signal",))
        yield _item(TIME, "value")
    elif len(place.typed.tokens) == 1:
        yield from _declared(place, ("requirement",))


def _header(place: _Place) -> Iterator[Item]:
    if place.before == "BOUND":
        yield from _values(BOUNDINGS)
    elif place.has("DEPENDS"):
        given = {token.text for token in place.typed.tokens}
        yield from (item for item in _declared(place, ("requirement",)) if item.text not in given)


def _declared(place: _Place, kinds: tuple[str, ...]) -> Iterator[Item]:
    for name, (file, statement) in place.scope.declared.items():
        if KINDS[type(statement)] in kinds:
            doc = None if isinstance(statement, LetStatement) else statement.doc
            detail = " ".join(file.source.slice(_beginning(statement)).split())
            yield Item(Span(0, 0), name, KINDS[type(statement)], detail[:_SHOWN], doc.text if doc else "")


def _beginning(statement: Declaration) -> Span:
    if isinstance(statement, RequirementStatement):
        return Span(statement.span.start, statement.formula.span.start)
    return statement.span


def _formula_names(place: _Place, *, numbers_only: bool) -> Iterator[Item]:
    """Offer what formulas are made of; inside an interval or a range only what is constant."""
    constant = place.inside() == "LSQB"
    for argument in _arguments(place):
        yield _item(argument, "argument")
    for item in _declared(place, ("param", "let") if constant else ("signal", "param", "let")):
        if not (numbers_only and _is_formula(place.scope.declared[item.text][1])):
            yield item
    for name, word in words.FUNCTIONS.items():
        if not constant or name not in ("delta", "rate"):
            yield _item(name, "function", word, 1)
    if not constant:
        yield _item("now", "value", words.CONSTANTS["now"], 1)


def _is_formula(statement: Declaration) -> bool:
    """Tell whether a name stands for a formula, as far as its own statement shows."""
    match statement:
        case SignalStatement(type=kind):
            return kind is not None and kind.text == "bool"
        case LetStatement(arguments=(), body=body):
            while isinstance(body, Group):
                body = body.inner
            return isinstance(body, Truth) or any(o.word not in ARITHMETIC | {"neg"} for o in operators(body))
    return False


def _arguments(place: _Place) -> Iterator[str]:
    """Yield the arguments of the template that is being written."""
    tokens = place.typed.tokens
    if place.head == "LET" and len(tokens) > 2 and tokens[2].kind == "LPAR" and place.has("ASSIGN"):
        for token in tokens[3:]:
            if token.kind == "RPAR":
                break
            if token.kind != "COMMA":
                yield token.text


def _in_quotes(place: _Place, offset: int) -> list[Item]:
    """Offer paths, or units, in a quoted text that is open."""
    *before, text = place.typed.tokens
    last = before[-1].kind if before else ""
    written = place.syntax.source.text[text.span.start + 1 : offset]
    if last == "UNIT_WORD":
        at = Span(text.span.start + 1, offset)
        units = sorted({*KNOWN, *_declared_units(place)})
        return [Item(at, unit, "unit") for unit in units]
    if last == "USE":
        return _paths(place, written, offset, _SPECS)
    if place.head == "EXPECT" and last in ("EXPECT", "ON", "OUTRANKS"):
        return _paths(place, written, offset, _DATA)
    return []


def _paths(place: _Place, written: str, offset: int, endings: tuple[str, ...]) -> list[Item]:
    """Offer the folders and files of the folder that a path has led to so far."""
    if not place.reviewed.document.is_file or "\0" in written:
        return []
    folder, slash, name = written.rpartition("/")
    at = Span(offset - len(name), offset)
    try:
        entries = sorted(os.scandir(resolve(place.syntax.source.name, folder + slash or ".")), key=lambda e: e.name)
        found = [(entry.name, entry.is_dir()) for entry in entries[:_MOST_FILES] if not entry.name.startswith(".")]
    except OSError:
        return []
    own = os.path.basename(place.syntax.source.name)  # noqa: PTH119 - no path, a name to leave out
    items = [Item(at, f"{name}/", "folder", order=1) for name, is_folder in found if is_folder]
    files = [name for name, is_folder in found if not is_folder and name.endswith(endings)]
    return [Item(at, name, "file") for name in files if slash or name != own] + items
