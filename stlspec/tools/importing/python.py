"""Specs of RTAMT inside the Python programs that run them.

In: the text of a program; it is parsed, never run. Out: the text of its spec at the places where it stands in the
program, all else blank, so that diagnostics point into the program; with the constants, the sampling period and the
unit that the program sets beside it.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NoReturn

from stlspec.errors import SpecError, diagnostic
from stlspec.source import SourceText, Span

_STRING = re.compile(
    r"(?P<prefix>[rRuUbB]*)(?P<quote>\"\"\"|'''|\"|')(?P<text>(?:\\.|(?!(?P=quote)).)*)(?P=quote)", re.S
)
_ESCAPE = re.compile(r"\\.", re.S)


@dataclass(frozen=True, slots=True)
class Embedded:
    """A spec found in a program.

    source: of the program's length, blank outside the spec. constants: by name, with place and value. period: as after
    `time` in a spec, where the program sets one; unit: of bounds without one.
    """

    source: SourceText
    constants: tuple[tuple[str, Span, float], ...]
    period: str | None
    unit: str | None


def looks_like_program(source: SourceText) -> bool:
    """Tell whether a text is a Python program that uses RTAMT. Not in the paper: other tools' languages."""
    return source.name.endswith(".py") or re.search(r"^\s*(?:import|from)\s+rtamt\b", source.text, re.M) is not None


def embedded(source: SourceText) -> Embedded:
    """Find the spec in a program.

    Not in the paper: other tools' languages.

    Raises: SpecError: the program cannot be parsed, has no spec, several, or one that is made when it runs.
    """
    try:
        tree = ast.parse(source.text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        _refuse(source, None, "S043", what="this is no Python program", help="give the text of the spec in a file")
    specs: list[ast.expr] = []
    parts: list[ast.expr] = []
    constants: list[tuple[str, Span, float]] = []
    period = unit = None
    for node in ast.walk(tree):
        match node:
            case ast.Assign(targets=[ast.Attribute(attr="spec")], value=value):
                specs.append(value)
            case ast.Assign(targets=[ast.Attribute(attr="unit")], value=ast.Constant(value=str(word))):
                unit = word
            case ast.Call(func=ast.Attribute(attr="add_sub_spec"), args=[value]):
                parts.append(value)
            case ast.Call(
                func=ast.Attribute(attr="set_sampling_period"), args=[ast.Constant(n), ast.Constant(word), *_]
            ):
                period = f"{n!s} {word!s}"
            case ast.Call(func=ast.Attribute(attr="declare_const"), args=[ast.Constant(name), _, ast.Constant(value)]):
                constants.append((str(name), _span(source, node), _number(source, node, value)))
    if len(specs) != 1:
        what = f"this program sets {len(specs)} specs" if specs else "no spec is set in this program"
        _refuse(source, specs[1] if specs else None, "S043", what=what, help="give the text of one spec in a file")
    masked = [c if c == "\n" else " " for c in source.text]
    for node in (*parts, specs[0]):
        for start, text in _written(source, node):
            masked[start : start + len(text)] = text
    return Embedded(SourceText(source.name, "".join(masked)), tuple(constants), period, unit)


def _refuse(source: SourceText, node: ast.expr | None, code: str, **fields: Any) -> NoReturn:
    span = _span(source, node) if node is not None else None
    raise SpecError([diagnostic(code, source=source if span else None, file=source.name, span=span, **fields)])


def _number(source: SourceText, node: ast.expr, value: object) -> float:
    try:
        return float(str(value))
    except ValueError:
        what, way = f"the constant {str(value)[:20]!r}", "write a number"
        _refuse(source, node, "S040", what=what, why="it is no number", help=way)


def _span(source: SourceText, node: ast.expr) -> Span:
    return Span(
        _offset(source, node.lineno, node.col_offset),
        _offset(source, node.end_lineno or node.lineno, node.end_col_offset or node.col_offset),
    )


def _offset(source: SourceText, line: int, column: int) -> int:
    """Return the offset of a place; Python counts its columns in bytes."""
    start = sum(len(text) + 1 for text in source.text.split("\n")[: line - 1])
    return start + len(source.text.split("\n")[line - 1].encode()[:column].decode(errors="ignore"))


def _written(source: SourceText, node: ast.expr) -> Iterator[tuple[int, str]]:
    """Yield the pieces of a text with their offsets; escapes, such as a line end, become blanks."""
    if not (isinstance(node, ast.Constant) and isinstance(node.value, str)):
        what, why = "a spec that is made when the program runs", "the program is not run"
        _refuse(source, node, "S040", what=what, why=why, help="give the text of the spec in a file")
    span = _span(source, node)
    for match in _STRING.finditer(source.text, span.start, span.end):
        text = match["text"]
        yield match.start("text"), text if "r" in match["prefix"].lower() else _ESCAPE.sub("  ", text)
