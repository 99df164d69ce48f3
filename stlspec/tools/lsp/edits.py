"""Changes that an editor is offered: the canonical form, and ways out of what is reported.

In: a reviewed buffer. Out: edits of its source.
"""

import re

from stlspec.errors import Edit, SpecError
from stlspec.lang.formatting.text import format_syntax
from stlspec.source import Span
from stlspec.tools.lsp.workspace import Reviewed

_LINE = re.compile(r"[^\n]*(?:\n|\Z)")


def formatting(reviewed: Reviewed) -> tuple[Edit, ...]:
    """Return the edits that bring a text into canonical form; none if it is, or has errors of syntax.

    Lines at the beginning and at the end that stay as they are are left alone, so that cursors there stay too.
    """
    if reviewed.syntax is None:
        return ()
    before = reviewed.syntax.source.text
    try:
        after = format_syntax(reviewed.syntax)
    except SpecError:
        return ()
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
