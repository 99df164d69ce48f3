"""From a place where the parser cannot go on to the diagnostic that a person needs.

In: a `Failure`: the tokens, where it stopped, what the automaton would have taken, which brackets are open.
Out: one diagnostic. Each habit or slip that can be told from the tokens has a function of its own, and
`describe` asks them in a fixed order; the last one only names what was found and what was expected.
"""

import re
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

from lark import Token

from stlspec.errors import Diagnostic, Edit, Label
from stlspec.lang.expected import expected, quoted
from stlspec.lang.failure import TEMPORAL, Failure
from stlspec.lang.habits import bars, dotted, one_bound, other_brackets, round_range, sign_of
from stlspec.lang.headers import blank_in_name, glued_type, no_name, priority
from stlspec.lang.measures import unit_of_number, unit_of_param, unit_of_signal
from stlspec.lang.phrases import PHRASES, for_all, within
from stlspec.lang.spelling import closest
from stlspec.lang.statements import RESERVED, STATEMENT_WORDS, first_on_line, is_word
from stlspec.lang.tree import span_of
from stlspec.lang.units import NANOSECONDS, is_unit_word
from stlspec.source import Span

OPERATOR_WORDS = (
    "always eventually historically once until since unless release next prev wnext wprev not "
    "and or xor implies iff globally finally"
).split()
PREFIX_WORDS = "always eventually historically once globally finally".split()
"""Operators of one formula that are long enough to be told from the name of a function."""
_CLOSING = {"LPAR": (")", "RPAR"), "LSQB": ("]", "RSQB"), "LBRACE": ("}", "RBRACE")}
"""For each opening bracket the closing one, and its terminal."""
_CLOSES = frozenset(terminal for _, terminal in _CLOSING.values())
_CLAUSE_WORDS = {"depends": "on", "scale": "NUMBER", "bound": "NAME"}
_FOREIGN = frozenset({"input", "output", "const", "float", "specification"})
"""Words with which statements of RTAMT begin."""
_COMPLETE = frozenset("NAME NUMBER STRING UNIT TRUE FALSE INF RPAR RSQB RBRACE COLON".split())
"""Terminals behind which a line may well end."""
_PATH = re.compile(r"(?<![^\s{])[A-Za-z0-9_./~-]+\.[A-Za-z]\w*(?![^\s},])")
"""What looks like the path of a file."""


def describe(failure: Failure) -> Diagnostic:
    """Return the one diagnostic for a statement that cannot be parsed."""
    for recognise in _RECOGNISERS:
        found = recognise(failure)
        if found is not None:
            return found
    return _plain(failure)


def _bare_path(failure: Failure) -> Diagnostic | None:
    """`use signals.stl`, `expect a holds on d1.csv`: a path without quotes."""
    if failure.token is None or failure.tokens[0].type not in ("USE", "EXPECT"):
        return None
    at, text = failure.span.start, failure.source.text
    begin, end = text.rfind("\n", 0, at) + 1, text.find("\n", at)
    paths = _PATH.finditer(text, begin, end if end >= 0 else len(text))
    found = next((m for m in paths if m.start() <= at < m.end()), None)
    if found is None:
        return None
    span = Span(found.start(), found.end())
    return failure.error("S045", at=span, edits=(Edit(span, f'"{found[0]}"'),), path=found[0])


def _unreadable(failure: Failure) -> Diagnostic | None:
    """A character or a text that the language does not have."""
    token = failure.token
    if token is None:
        return None
    if token.type == "BAD_STRING":
        return failure.error("S006")
    braces = token.type in ("LBRACE", "RBRACE") and failure.tokens[0].type != "EXPECT"
    if token.type == "BAD_CHARACTER" or braces:
        name = dotted(failure)
        if name:
            return failure.error("S005", character="`.`", help=f"a name has no dots: write `{name}`")
        return failure.error("S005", character=quoted(str(token)), help=sign_of(failure, str(token)))
    if token.type == "WALRUS":
        name = str(failure.tokens[failure.at - 1]) if failure.at else "p"
        return failure.error("S012", name=name)
    return None


def _no_statement(failure: Failure) -> Diagnostic | None:
    """A line that begins with no word of a statement."""
    if not failure.beginning or failure.token is None:
        return None
    word = str(failure.token)
    if failure.at + 1 < len(failure.tokens) and failure.tokens[failure.at + 1].type == "WALRUS":
        return failure.error("S012", at=span_of(failure.tokens[failure.at + 1]), name=word)
    if failure.token.type in ("RPAR", "RSQB"):
        return failure.error("S019", bracket=word)
    close = closest(word, STATEMENT_WORDS) if is_word(failure.token) else None
    if word in _FOREIGN or (is_word(failure.token) and _assigns(failure)):
        way = f"write `let {word} = ...`" if word not in _FOREIGN and close is None else "declare it with `signal`"
        way += "; a whole spec of RTAMT is translated by `stlspec import FILE`"
        return failure.error("S003", word=quoted(word), help=way)
    way = f"did you mean `{close}`?" if close else f"begin with one of: {', '.join(STATEMENT_WORDS)}"
    return failure.error("S003", word=quoted(word), help=way)


def _assigns(failure: Failure) -> bool:
    after = failure.tokens[failure.at + 1 : failure.at + 2]
    return bool(after) and after[0].type == "ASSIGN"


def _glued_statement(failure: Failure) -> Diagnostic | None:
    """A second statement on the same line."""
    token = failure.token
    if token is None or str(token) not in STATEMENT_WORDS or token.type == "NAME" or failure.brackets:
        return None
    if "$END" not in failure.expected:
        return None
    return failure.error("S011", word=str(token))


def _reserved_name(failure: Failure) -> Diagnostic | None:
    """A reserved word where a name is declared."""
    token = failure.token
    if token is None or str(token) not in RESERVED or failure.expected != {"NAME"}:
        return None
    return failure.error("S017", word=str(token))


def _misspelt_operator(failure: Failure) -> Diagnostic | None:
    """A name right before the failure, or before the open `[`, that is nearly an operator."""
    candidates = []
    if failure.at and failure.tokens[failure.at - 1].type == "NAME":
        candidates.append(failure.at - 1)
    if failure.brackets and failure.brackets[-1].type == "LSQB":
        candidates.append(failure.place(failure.brackets[-1]) - 1)
    if failure.token is not None and is_word(failure.token):
        candidates.append(failure.at)
    for i in candidates:
        word = str(failure.tokens[i])
        header = 3 if str(failure.tokens[0]) in STATEMENT_WORDS else 0
        if i < header or failure.tokens[i].type != "NAME" or word in failure.names:
            continue
        if word == "if":
            found = failure.error("S001", at=span_of(failure.tokens[i]), found="`if`", expected="a formula")
            return replace(found, help="write `p implies q` for: if p then q")
        close = closest(word, OPERATOR_WORDS, 0.75)
        if close:
            span = span_of(failure.tokens[i])
            return failure.error("S018", at=span, edits=(Edit(span, close),), word=word, meant=close)
    return None


def _misspelt_clause(failure: Failure) -> Diagnostic | None:
    """A word that is nearly one of the words that fit."""
    token = failure.token
    words = [t.lower().removesuffix("_word") for t in failure.expected if t.isalpha() or t == "UNIT_WORD"]
    # A single letter is no slip of another: `S` would be proposed for `s`.
    words = [w for w in words if len(w) > 1 and w not in ("name", "number", "string")]
    if token is None or not is_word(token):
        return None
    close = closest(str(token), words, 0.7)
    return failure.error("S018", word=str(token), meant=close) if close else None


def _late_clause(failure: Failure) -> Diagnostic | None:
    """A clause after the formula."""
    token, tokens = failure.token, failure.tokens
    if (
        token is None
        or tokens[0].type not in ("HARD", "SOFT")
        or not any(t.type == "COLON" for t in tokens[: failure.at])
    ):
        return None
    if token.type == "STRING":
        return failure.error("S010", clause="the quoted text")
    after = tokens[failure.at + 1] if failure.at + 1 < len(tokens) else None
    wanted = _CLAUSE_WORDS.get(str(token))
    if wanted is not None and after is not None and wanted in (str(after), after.type):
        return failure.error("S010", clause=f"`{token} {after}`")
    return None


def _open_interval(failure: Failure) -> Diagnostic | None:
    """`(0, 5]` or `[0, 5)` behind a temporal word."""
    token, tokens = failure.token, failure.tokens
    if token is None or not failure.brackets:
        return None
    opening = failure.place(failure.brackets[-1])
    if not opening or tokens[opening - 1].type not in TEMPORAL:
        return None
    inside = tokens[opening + 1 :]
    ends = next((i for i, t in enumerate(inside) if t.type in ("RPAR", "RSQB")), None)
    comma = next((i for i, t in enumerate(inside) if t.type in ("COMMA", "COLON")), None)
    if ends is None or comma is None or not 0 < comma < ends - 1 or any(_compares(t) for t in inside[:ends]):
        return None
    closed = {tokens[opening].type, inside[ends].type} == {"LSQB", "RSQB"}
    elsewhere = token is not inside[comma] and token is not inside[ends]
    if closed or elsewhere or (tokens[opening].type == "LSQB" and _last_bound(failure, opening) is not None):
        return None
    low, high = failure.text(inside[:comma]), failure.text(inside[comma + 1 : ends])
    whole = span_of(tokens[opening]).to(span_of(inside[ends]))
    edits = (Edit(whole, f"[{low}, {high}]"),)
    return failure.error("S025", at=whole, edits=edits, low=low, high=high)


def _compares(token: Token) -> bool:
    return token.type in ("LT", "LE", "GT", "GE", "EQ", "NE", "ASSIGN")


def _stray_interval(failure: Failure) -> Diagnostic | None:
    """An interval behind something that takes none: `next[0, 5]`, `d[0, 5]`."""
    token, tokens = failure.token, failure.tokens
    if token is None or tokens[0].type in ("EXPECT", "SIGNAL"):
        return None
    if token.type == "LSQB":
        opening = failure.at
    elif token.type in ("COMMA", "COLON") and failure.brackets and failure.brackets[-1].type == "LSQB":
        opening = failure.place(failure.brackets[-1])
    else:
        return None
    before = tokens[opening - 1]
    if not opening or not is_word(before) or before.type in TEMPORAL or before.type == "IN":
        return None
    return failure.error("S024", at=span_of(tokens[opening]), word=str(before))


def _open_bracket(failure: Failure) -> Diagnostic | None:
    """A bracket that is never closed, or closed by one of the other kind."""
    if not failure.brackets:
        return _stray_bracket(failure)
    opening = failure.brackets[-1]
    closing, wanted = _CLOSING[opening.type]
    if wanted not in failure.expected or (failure.token is not None and failure.token.type == "COMMA"):
        return None
    label = Label(span_of(opening), "opened here", failure.source)
    if failure.token is not None and failure.token.type in _CLOSES:
        way = f"write `{closing}` in place of `{failure.token}`"
        return failure.error("S004", labels=(label,), closing=closing, help=way)
    last = _last_bound(failure, failure.place(opening)) if closing == "]" else None
    before = last if last is not None else failure.tokens[failure.at - 1]
    at = Span(span_of(last).end, span_of(last).end) if last is not None else None
    way = f"write `{closing}` after {quoted(str(before))}"
    return failure.error("S004", at=at, labels=(label,), closing=closing, help=way)


def _last_bound(failure: Failure, opening: int) -> Token | None:
    """Return the last bound of an open interval that ran into the formula, None if the failure comes first.

    `[0, T (d > 1)` reads as a call of T, and `[0, 5 d > 1` as 5 in a unit d.
    """
    for token, after in pairwise(failure.tokens[opening + 1 : failure.at]):
        if str(token) in failure.names and after.type == "LPAR":
            return token
        if token.type == "NUMBER" and is_word(after) and not is_unit_word(str(after)):
            return token
    return None


def _stray_bracket(failure: Failure) -> Diagnostic | None:
    token = failure.token
    if token is None or token.type not in _CLOSES:
        return None
    return failure.error("S019", bracket=str(token))


def _no_comma(failure: Failure) -> Diagnostic | None:
    """`[a b]`: bounds without a comma."""
    if "COMMA" not in failure.expected or "RSQB" in failure.expected or not failure.brackets:
        return None
    if failure.token is None or failure.token.type not in ("NUMBER", "NAME", "INF"):
        return None
    tokens, opening = failure.tokens, failure.place(failure.brackets[-1])
    ends = next((i for i in range(failure.at, len(tokens)) if tokens[i].type == "RSQB"), failure.at + 1)
    low, high = failure.text(tokens[opening + 1 : failure.at]), failure.text(tokens[failure.at : ends])
    # `[0..5]` reads as the numbers `0.` and `.5`.
    dotted = low.endswith(".") and high.startswith(".")
    return failure.error("S021", low=low[:-1] if dotted else low, high=high[1:] if dotted else high)


def _listed_names(failure: Failure) -> Diagnostic | None:
    """`signal x, y`, as in a spec of Breach."""
    token, tokens = failure.token, failure.tokens
    if token is None or token.type != "COMMA" or failure.brackets or tokens[0].type not in ("SIGNAL", "PARAM"):
        return None
    word = str(tokens[0])
    following = tokens[failure.at + 1] if failure.at + 1 < len(tokens) else None
    name = str(following) if following is not None and is_word(following) else "..."
    return failure.error("S044", word=word, name=name)


def _unit_behind(failure: Failure) -> Diagnostic | None:
    """`[0, 5] s x > 1`: the unit of the bounds behind the interval."""
    at, tokens = failure.at, failure.tokens
    if at < 2 or tokens[at - 2].type != "RSQB" or str(tokens[at - 1]) not in NANOSECONDS:
        return None
    unit = tokens[at - 1]
    found = failure.error("S001", at=span_of(unit), found=quoted(str(unit)), expected="a formula")
    return replace(found, help=f"a unit stands behind each bound, inside the interval, as in `[0, 5 {unit}]`")


def _cut_line(failure: Failure) -> Diagnostic | None:
    """A line that ends where something must follow, before one that is no continuation: `depends on`, `a and`."""
    at, tokens = failure.at, failure.tokens
    if failure.token is None or at < 2 or not first_on_line(tokens, at) or "$END" in failure.expected:
        return None
    last = tokens[at - 1]
    if last.type in _COMPLETE:
        return None
    fits, end = expected(failure.expected), span_of(last).end
    way = f"write {fits} after {quoted(str(last))}"
    return failure.error("S002", at=Span(end, end), what="line", last=quoted(str(last)), expected=fits, help=way)


def _cut_off(failure: Failure) -> Diagnostic | None:
    """A statement that ends where something must follow."""
    if failure.token is not None:
        return None
    last, way = quoted(str(failure.tokens[-1])), "complete the statement here"
    return failure.error("S002", what="statement", last=last, expected=expected(failure.expected), help=way)


def _plain(failure: Failure) -> Diagnostic:
    return failure.error("S001", found=quoted(str(failure.token)), expected=expected(failure.expected))


_RECOGNISERS: tuple[Callable[[Failure], Diagnostic | None], ...] = (
    _bare_path,
    other_brackets,
    _unreadable,
    priority,
    no_name,
    unit_of_number,
    unit_of_param,
    unit_of_signal,
    _late_clause,
    _no_statement,
    _glued_statement,
    _unit_behind,
    _cut_line,
    _reserved_name,
    for_all,
    within,
    _misspelt_operator,
    _misspelt_clause,
    blank_in_name,
    *PHRASES,
    bars,
    _no_comma,
    one_bound,
    round_range,
    _open_interval,
    _stray_interval,
    _open_bracket,
    _listed_names,
    glued_type,
    _cut_off,
)
