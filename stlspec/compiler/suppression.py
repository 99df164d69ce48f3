"""Comments that ignore warnings: `# stlspec: ignore L603` on their line, or alone on the line above.

In: the comments of a text and its diagnostics. Out: those that are left, with L618 for what hides nothing and L619
for what cannot be followed. Errors are left whatever a comment says.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from stlspec.compiler.selection import problem_with
from stlspec.errors import Diagnostic, Edit, diagnostic
from stlspec.lang.parse import Syntax
from stlspec.source import SourceText, Span

_COMMENT = re.compile(r"(?:#|//)\s*stlspec\s*:\s*ignore\b(?P<codes>.*)", re.IGNORECASE)
_CODE = re.compile(r"[^\s,]+")
_LOOKS_LIKE_CODE = re.compile(r"[A-Za-z]+\d*\Z")


@dataclass(frozen=True, slots=True)
class _Ignore:
    """One code in a comment: where it stands, and the line whose warnings it hides."""

    name: str
    span: Span
    line: int
    edit: Edit


def suppressed(syntax: Syntax, diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Leave out the warnings that comments ignore; see the module.

    Not in the paper: a linter that cannot be overruled is switched off.
    """
    source = syntax.source
    problems: list[Diagnostic] = []
    ignores = [i for comment in syntax.comments for i in _read(source, comment.span, problems)]
    if not ignores and not problems:
        return tuple(diagnostics)
    used: set[Span] = set()
    kept = []
    for found in diagnostics:
        hiding = [i for i in ignores if _hides(i, found, source)]
        used.update(i.span for i in hiding)
        if not hiding:
            kept.append(found)
    # With errors the lints have not run, so nothing is known of what they would report.
    if not any(found.severity == "error" for found in kept):
        problems += [
            diagnostic("L618", source=source, span=i.span, edits=(i.edit,), what=i.name)
            for i in ignores
            if i.span not in used
        ]
    return tuple(sorted((*kept, *problems), key=Diagnostic.sort_key))


def _hides(ignore: _Ignore, found: Diagnostic, source: SourceText) -> bool:
    if found.severity == "error" or found.span is None or found.source is not source:
        return False
    return found.code.startswith(ignore.name) and source.position(found.span.start).line == ignore.line


def _read(source: SourceText, span: Span, problems: list[Diagnostic]) -> list[_Ignore]:
    """Read one comment; what cannot be followed is added to `problems`."""
    match = _COMMENT.match(source.slice(span))
    if match is None:
        return []
    line = source.position(span.start).line
    if not source.line(line)[: source.position(span.start).column - 1].strip():
        line = _next_line(source, line)
    offset = span.start + match.start("codes")
    found: list[_Ignore] = []
    before = len(problems)
    for code in _CODE.finditer(match["codes"]):
        if not _LOOKS_LIKE_CODE.match(code[0]):
            break  # a reason, such as `- the sensor saturates`
        place = Span(offset + code.start(), offset + code.end())
        wrong = problem_with(code[0].upper(), hides=True)
        if wrong is None:
            found.append(_Ignore(code[0].upper(), place, line, Edit(place, "")))
        else:
            problems.append(diagnostic("L619", source=source, span=place, problem=wrong[0]))
    if not found and len(problems) == before:
        problems.append(diagnostic("L619", source=source, span=span, problem="it names no code"))
    if len(found) == 1:
        (only,) = found
        found = [_Ignore(only.name, only.span, only.line, Edit(span, ""))]
    return found


def _next_line(source: SourceText, line: int) -> int:
    """Return the next line that holds more than a comment."""
    last = source.position(len(source.text)).line
    for number in range(line + 1, last + 1):
        text = source.line(number).strip()
        if text and not text.startswith(("#", "//")):
            return number
    return line
