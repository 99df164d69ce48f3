"""Changes that an editor is offered: the canonical form, and ways out of what is reported.

In: a reviewed buffer. Out: edits of its source.
"""

import re
from dataclasses import dataclass

from stlspec.errors import CATALOGUE, Diagnostic, Edit
from stlspec.lang.formatting.text import format_syntax
from stlspec.source import SourceText, Span
from stlspec.tools.lsp.workspace import Reviewed

_ABOUT_COMMENTS = ("L618", "L619")
_IGNORES = re.compile(r"(?:#|//)\s*stlspec\s*:\s*ignore\b", re.IGNORECASE)
_LINE = re.compile(r"[^\n]*(?:\n|\Z)")


def formatting(reviewed: Reviewed) -> tuple[Edit, ...]:
    """Return the edits that bring a text into canonical form; none if it is, or has errors of syntax.

    Lines at the beginning and at the end that stay as they are are left alone, so that cursors there stay too.
    Raises: SpecError: X902, the canonical text would not say the same.
    """
    syntax = reviewed.syntax
    if syntax is None or any(problem.severity == "error" for problem in syntax.diagnostics):
        return ()
    before, after = syntax.source.text, format_syntax(syntax)
    old, new = _lines(before), _lines(after)
    first = _same(old, new)
    last = _same(old[first:][::-1], new[first:][::-1])
    start = sum(map(len, old[:first]))
    end = len(before) - sum(map(len, old[len(old) - last :]))
    text = "".join(new[first : len(new) - last])
    return (Edit(Span(start, end), text),) if before[start:end] != text else ()


def _lines(text: str) -> list[str]:
    return [line for line in _LINE.findall(text) if line]


def _same(left: list[str], right: list[str]) -> int:
    """Return how many lines two lists share from their beginning."""
    pairs = enumerate(zip(left, right, strict=False))
    return next((i for i, (a, b) in pairs if a != b), min(len(left), len(right)))


@dataclass(frozen=True, slots=True)
class Action:
    """A way out of a diagnostic: edits of the text that it is about, under a title."""

    title: str
    found: Diagnostic
    source: SourceText
    edits: tuple[Edit, ...]
    likely: bool


def actions(reviewed: Reviewed, start: int, end: int) -> tuple[Action, ...]:
    """Return the ways out of what is reported on the lines from `start` to `end`: fixes, then what ignores warnings."""
    if reviewed.syntax is None:
        return ()
    source = reviewed.syntax.source
    first, last = source.position(min(start, end)).line, source.position(max(start, end)).line
    here = [
        (found, found.span)
        for found in reviewed.diagnostics
        if found.source is source and found.span is not None and _touches(source, found.span, first, last)
    ]
    fixes = [
        # An editor takes what is likely without asking, which between several ways out is not its choice.
        Action(fix.title, found, source, fix.edits, likely=len(found.fixes) == 1)
        for found, _ in here
        for fix in found.fixes
    ]
    hiding = [_ignored(reviewed, found, source, span) for found, span in here]
    return (*fixes, *(action for action in hiding if action is not None))


def _touches(source: SourceText, span: Span, first: int, last: int) -> bool:
    return source.position(span.start).line <= last and source.position(span.end).line >= first


def _ignored(reviewed: Reviewed, found: Diagnostic, source: SourceText, span: Span) -> Action | None:
    """Return what hides a warning by a comment on its line; None for an error, or what such a comment gave rise to."""
    row = CATALOGUE.get(found.code)
    if row is None or row.level == "error" or found.code in _ABOUT_COMMENTS or reviewed.syntax is None:
        return None
    line = source.position(span.start).line
    text = source.line(line)
    start = span.start - source.position(span.start).column + 1
    end = start + len(text.rstrip())
    there = next((c.span for c in reviewed.syntax.comments if start <= c.span.start < start + len(text)), None)
    if there is None:
        edit = Edit(Span(end, end), f"  # stlspec: ignore {found.code}")
    else:
        match = _IGNORES.match(source.slice(there))
        if match is None:
            return None  # a remark of another kind, which the line would have to share
        at = there.start + match.end()
        edit = Edit(Span(at, at), f" {found.code},")
    return Action(f"Ignore {found.code} on this line", found, source, (edit,), likely=False)
