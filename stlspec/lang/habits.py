"""Habits of other languages that fit nowhere in this one, and what is written here.

In: a `Failure`. Out: the one diagnostic with its edits, or None where the habit is not what stopped the parser.
"""

from dataclasses import replace

from stlspec.errors import Diagnostic, Edit
from stlspec.lang.expected import expected, quoted
from stlspec.lang.failure import TEMPORAL, Failure
from stlspec.lang.statements import is_word
from stlspec.lang.tree import span_of
from stlspec.source import Span

_BEFORE_OPERATOR = frozenset("NAME NUMBER UNIT RPAR TRUE FALSE".split())
"""Terminals that end an operand: a `|` behind one of them closes."""
_OTHER_BRACKETS = {"LBRACE": "RBRACE", "LT": "GT", "BAR": "BAR"}
_SIGNS = {
    "^": "**",
    "%": "percent",
    "≥": ">=",
    "≤": "<=",
    "≠": "!=",
    "¬": "not",
    "∧": "and",
    "∨": "or",
    "→": "->",
    "⇒": "->",
    "↔": "<->",
    "⇔": "<->",
    "□": "always",
    "◻": "always",
    "◇": "eventually",
    "⊤": "true",
    "⊥": "false",
    "∀": "always",
    "∃": "eventually",
    "∞": "inf",
    "·": "*",
    "°": "deg",
    "µ": "u",
    "μ": "u",
    "²": "**2",
    "³": "**3",
    "×": "*",
    "−": "-",
    "–": "-",
    "'": '"',
    "“": '"',
    "”": '"',
}
"""Characters that the language does not have, and what is written for them."""


def habit(failure: Failure, way: str, *edits: Edit, at: Span | None = None, wanted: str = "") -> Diagnostic:
    """Return the diagnostic of a habit; what is pointed at does not fit, and `way` says what does.

    Not in the paper: the language.
    """
    span = at or failure.span
    found = failure.error(
        "S001",
        at=span,
        found=quoted(failure.source.slice(span)),
        expected=wanted or expected(failure.expected),
        edits=edits,
    )
    return replace(found, help=way, fixes=tuple(replace(fix, title=way) for fix in found.fixes))


def bars(failure: Failure) -> Diagnostic | None:
    """Describe `|x|`, the absolute value. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if failure.token is None or failure.token.type != "BAR" or "LPAR" not in failure.expected:
        return None
    opened: int | None = None
    edits: list[Edit] = []
    first = ""
    for i in range(at, len(tokens)):
        if tokens[i].type != "BAR":
            continue
        if opened is None and (i == at or tokens[i - 1].type not in _BEFORE_OPERATOR):
            opened = i
        elif opened is not None and i > opened + 1:
            edits += [Edit(span_of(tokens[opened]), "abs("), Edit(span_of(tokens[i]), ")")]
            first = first or failure.text(tokens[opened + 1 : i])
            opened = None
    if not first:
        return None
    return habit(failure, f"write `abs({shortened(first)})`", *edits, wanted="a formula")


def shortened(text: str) -> str:
    """Return a text as `quoted` would, without the backticks. Not in the paper: it serves the messages."""
    return quoted(" ".join(text.split()))[1:-1]


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
    bound = failure.text(failure.tokens[opening + 1 : failure.at])
    start = span_of(failure.tokens[opening]).end
    edits = (Edit(Span(start, start), "0, "),)
    found = failure.error("S001", found="`]`", expected="a second bound", edits=edits)
    return replace(found, help=f"write `[0, {bound}]`", fixes=(replace(found.fixes[0], title=f"write `[0, {bound}]`"),))


def sign_of(failure: Failure, character: str) -> str:
    """Say what to do about a character that no word and no sign has. Not in the paper: the language."""
    before = failure.tokens[failure.at - 1] if failure.at else None
    if before is not None and before.type == "UNIT_WORD":
        return f'write `"{character}"`: a unit that is no word stands in quotes'
    glued = before is not None and failure.token is not None and before.end_pos == failure.token.start_pos
    if character == "'" and glued and before is not None and is_word(before):
        return f"write `rate({before})` for a derivative; names have no `{character}`"
    sign = "," if character == ";" and failure.brackets else _SIGNS.get(character)
    if sign:
        return f"write `{sign}` in its place"
    return "remove it" if character.isascii() else "remove it; words and signs of the language are plain ASCII"


def other_brackets(failure: Failure) -> Diagnostic | None:
    """Describe `always{0, 5}`, `always<0, 5>` and `always|0, 5|`. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if failure.token is None or at < 1 or tokens[at - 1].type not in TEMPORAL:
        return None
    closing = _OTHER_BRACKETS.get(failure.token.type)
    ends = next((i for i in range(at + 1, len(tokens)) if tokens[i].type == closing), None)
    comma = next((i for i in range(at, len(tokens)) if tokens[i].type in ("COMMA", "COLON")), None)
    if ends is None or comma is None or not at + 1 < comma < ends - 1:
        return None
    whole = span_of(tokens[at]).to(span_of(tokens[ends]))
    window = f"[{failure.text(tokens[at + 1 : comma])}, {failure.text(tokens[comma + 1 : ends])}]"
    return habit(failure, f"write `{window}`", Edit(whole, window), at=whole, wanted="an interval or a formula")


def round_range(failure: Failure) -> Diagnostic | None:
    """Describe `signal x in (0, 5)`, a range in round brackets. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if failure.token is None or failure.token.type != "LPAR" or failure.expected != {"LSQB"}:
        return None
    ends = next((i for i in range(at, len(tokens)) if tokens[i].type in ("RPAR", "RSQB")), None)
    comma = next((i for i in range(at, len(tokens)) if tokens[i].type in ("COMMA", "COLON")), None)
    if ends is None or comma is None or not at + 1 < comma < ends - 1:
        return None
    low, high = failure.text(tokens[at + 1 : comma]), failure.text(tokens[comma + 1 : ends])
    whole = span_of(tokens[at]).to(span_of(tokens[ends]))
    return failure.error("S025", at=whole, edits=(Edit(whole, f"[{low}, {high}]"),), low=low, high=high)
