"""The canonical text of a spec.

In: the syntax of a text without errors. Out: its canonical text: one spelling of every operator, brackets where
tools disagree, one blank at most, lines of at most 100 columns, comments and single blank lines where they were.
The result is read again each time, and given back only if it says the same: the same tree, spans and redundant
brackets left out, and the same comments in the same order.
"""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

from stlspec.errors import SpecError, diagnostic
from stlspec.lang.formatting.expressions import HABIT, NOW, Expressions, bare, reads_as_name
from stlspec.lang.formatting.layout import STEP, Comment, Lines
from stlspec.lang.formatting.places import Places
from stlspec.lang.formatting.statements import statement_doc
from stlspec.lang.nodes import Group, Index, Name, Statement
from stlspec.lang.parse import Syntax, parse
from stlspec.source import SourceText, Span

_ROUNDS = 4
"""How often a text is formatted at most until nothing changes; comments in odd places may need two."""


def format_text(text: str, name: str = "<text>") -> str:
    """Return the canonical text of a spec that uses no other files; see `format_syntax`."""
    return format_syntax(parse(SourceText.of(name, text)))


def format_syntax(syntax: Syntax) -> str:
    """Return the canonical text of a spec.

    Not in the paper: the language.

    Args:    syntax: what `parse`, or `using.parse_with_uses` for one that uses files, makes of its text.
    Returns: the text, its lines ended as the first line of the source is; formatting it again changes nothing.
    Raises:  SpecError: the text has syntax errors, or X902: its canonical text would not say the same.
    """
    errors = [problem for problem in syntax.diagnostics if problem.severity == "error"]
    if errors:
        raise SpecError(errors)
    names = frozenset[str]().union(*(file.names for file in syntax.used))
    said = _said(syntax)
    current, text = syntax, ""
    for _ in range(_ROUNDS):
        before, text = text, _formatted(current)
        if text == before:
            break
        current = replace(parse(SourceText.of(syntax.source.name, text), names), used=syntax.used)
        if current.diagnostics or _said(current) != said:
            raise SpecError([diagnostic("X902", source=syntax.source, span=Span(0, 0))])
    crlf = syntax.source.text.find("\r\n")
    return text.replace("\n", "\r\n") if 0 <= crlf < syntax.source.text.find("\n") else text


def _formatted(syntax: Syntax) -> str:
    source = syntax.source
    places = Places.of(source, syntax.comments)
    writer = Writer(places)
    made = Expressions(places, _habit(syntax))
    for statement in syntax.statements:
        writer.statement(made, statement)
    return writer.finished()


def _habit(syntax: Syntax) -> bool:
    """Tell whether `t` may be read as `now`: nothing declares it, here or in a used file."""
    files = (syntax, *syntax.used)
    declared = any(HABIT in file.names or HABIT in file.requirement_names for file in files)
    arguments = any(name.text == HABIT for s in syntax.statements for name in getattr(s, "arguments", ()))
    return not declared and not arguments


class Writer:
    """Writes statements and the comments between them, blank lines kept, one at most."""

    def __init__(self, places: Places) -> None:
        self._places = places
        self._lines = Lines(places.comments)
        self._comment = 0
        self._end = 0
        """Where the last statement or comment that was written ends in the source."""

    def statement(self, made: Expressions, statement: Statement) -> None:
        """Write the comments before a statement, and the statement."""
        start, end = statement.span.start, statement.span.end
        self._between(start)
        self._lines.begin(blank_above=self._blank(start))
        self._lines.write(statement_doc(made, statement))
        self._lines.comments_before(end, STEP)
        comments = self._places.comments
        while self._comment < len(comments) and comments[self._comment].at < end:
            self._comment += 1
        self._end = end

    def finished(self) -> str:
        """Write the comments that remain, and return the text."""
        self._between(len(self._places.source.text) + 1)
        return self._lines.text()

    def _between(self, at: int) -> None:
        """Write the comments up to `at`: those indented below a statement stay so, up to a blank line."""
        inside = self._end > 0
        while self._comment < len(self._places.comments) and self._places.comments[self._comment].at < at:
            comment = self._places.comments[self._comment]
            inside = inside and self._stays_inside(comment)
            self._lines.comments_before(comment.at + 1, STEP if inside else 0)
            self._end = comment.at + len(comment.text)
            self._comment += 1

    def _stays_inside(self, comment: Comment) -> bool:
        column = self._places.source.position(comment.at).column
        return comment.trailing or (column > 1 and not self._blank(comment.at))

    def _blank(self, at: int) -> bool:
        return self._places.source.text.count("\n", self._end, at) > 1


def _said(syntax: Syntax) -> list[Any]:
    """Return what a text says, to be compared: its tree without spans and brackets, and its comments."""
    habit = _habit(syntax)
    said: list[Any] = [comment.text.rstrip() for comment in syntax.comments]
    for statement in syntax.statements:
        said += _flat(statement, habit)
    return said


def _flat(root: Any, habit: bool) -> Iterator[Any]:
    pending = [root]
    while pending:
        node = pending.pop()
        if isinstance(node, Group):
            node = bare(node)
        if isinstance(node, Index) and habit and reads_as_name(node):
            node = node.name
        if isinstance(node, Name):
            yield ("Name", NOW if habit and node.text == HABIT else node.text)
        elif isinstance(node, tuple):
            yield len(node)
            pending += reversed(node)
        elif is_dataclass(node) and not isinstance(node, type):
            yield type(node).__name__
            pending += [getattr(node, field.name) for field in reversed(fields(node)) if field.name != "span"]
        else:
            yield node
