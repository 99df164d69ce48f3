"""Habits of other languages that fit nowhere in this one, and what is written here.

In: a `Failure`. Out: the one diagnostic with its edits, or None where the habit is not what stopped the parser.
"""

from collections.abc import Sequence
from dataclasses import replace

from lark import Token

from stlspec.errors import Diagnostic, Edit
from stlspec.lang.failure import Failure
from stlspec.lang.statements import is_word
from stlspec.lang.tree import span_of
from stlspec.source import Span


def dotted(failure: Failure) -> str | None:
    """Return `ego_speed` at the dot of `ego.speed`; None elsewhere. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if str(failure.token) != "." or not 0 < at < len(tokens) - 1:
        return None
    before, dot, after = tokens[at - 1 : at + 2]
    glued = before.end_pos == dot.start_pos and dot.end_pos == after.start_pos
    return f"{before}_{after}" if glued and is_word(before) and is_word(after) else None


def one_bound(failure: Failure) -> Diagnostic | None:
    """Describe `eventually[5] p`, an interval with one bound. Not in the paper: the language."""
    if failure.token is None or failure.token.type != "RSQB" or not {"COMMA", "COLON"} <= failure.expected:
        return None
    if not failure.brackets or failure.brackets[-1].type != "LSQB":
        return None
    opening = failure.place(failure.brackets[-1])
    bound = _text(failure, failure.tokens[opening + 1 : failure.at])
    start = span_of(failure.tokens[opening]).end
    edits = (Edit(Span(start, start), "0, "),)
    found = failure.error("S001", found="`]`", expected="a second bound", edits=edits)
    return replace(found, help=f"write `[0, {bound}]`", fixes=(replace(found.fixes[0], title=f"write `[0, {bound}]`"),))


def round_range(failure: Failure) -> Diagnostic | None:
    """Describe `signal x in (0, 5)`, a range in round brackets. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if failure.token is None or failure.token.type != "LPAR" or failure.expected != {"LSQB"}:
        return None
    ends = next((i for i in range(at, len(tokens)) if tokens[i].type in ("RPAR", "RSQB")), None)
    comma = next((i for i in range(at, len(tokens)) if tokens[i].type in ("COMMA", "COLON")), None)
    if ends is None or comma is None or not at + 1 < comma < ends - 1:
        return None
    low, high = _text(failure, tokens[at + 1 : comma]), _text(failure, tokens[comma + 1 : ends])
    whole = span_of(tokens[at]).to(span_of(tokens[ends]))
    return failure.error("S025", at=whole, edits=(Edit(whole, f"[{low}, {high}]"),), low=low, high=high)


def _text(failure: Failure, tokens: Sequence[Token]) -> str:
    return failure.source.slice(Span(span_of(tokens[0]).start, span_of(tokens[-1]).end))
