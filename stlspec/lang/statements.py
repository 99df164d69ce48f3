"""From text to statements: lexing, and cutting the tokens where a statement begins.

In: a source text. Out: the tokens of each statement, the comments, and the names that the text declares, broken
statements included. A statement begins at a reserved word first on its line, whatever the brackets around it,
so that a missing bracket never swallows the next statement; indentation has no meaning.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from lark import Lark, Token

from stlspec.lang.nodes import Text
from stlspec.lang.spelling import closest
from stlspec.lang.tree import span_of
from stlspec.source import SourceText

STATEMENT_WORDS = ("spec", "use", "time", "signal", "param", "let", "hard", "soft", "expect")
DECLARING = frozenset({"SIGNAL", "PARAM", "LET"})
_RESERVED_STARTS = frozenset({"SIGNAL", "PARAM", "LET", "HARD", "SOFT", "EXPECT"})
TIME_UNITS = ("ns", "us", "ms", "s", "min", "h")
RESERVED = frozenset(
    (
        "signal param let hard soft expect always eventually historically once until since unless "
        "release next prev wnext wprev not and or xor implies iff true false inf"
    ).split()
)
_HEADER_WORDS = frozenset({"unit", "in", "from", "depends", "on", "scale", "bound"})
"""Words of headers: in the place of a name that was lost, they are hardly names."""
_WORD = re.compile(r"[A-Za-z_][A-Za-z_0-9]*\Z")


@dataclass(frozen=True, slots=True)
class Cut:
    """A text as tokens, one tuple a statement; `names` maps each declared name to its token."""

    statements: tuple[tuple[Token, ...], ...]
    comments: tuple[Text, ...]
    names: frozenset[str]
    requirement_names: frozenset[str]


def is_word(token: Token) -> bool:
    """Tell whether a token is spelled like a name, keyword or not."""
    return _WORD.match(token) is not None


def lexed(text: str, lark: Lark) -> tuple[list[Token], list[Text]]:
    """Return the tokens of a text, and apart the comments. No token goes over the end of a line."""
    tokens: list[Token] = []
    comments: list[Text] = []
    for token in lark.parse_interactive(text, start="lexicon").lexer_thread.lex(None):  # type: ignore[no-untyped-call]
        if token.type == "COMMENT":
            comments.append(Text(span_of(token), str(token)))
        else:
            tokens.append(token)
    return tokens, comments


def cut(source: SourceText, lark: Lark) -> Cut:
    """Lex `source` and cut it into statements."""
    tokens, comments = lexed(source.text, lark)
    pieces = tuple(_pieces(tokens))
    declared = frozenset(name for piece in pieces for name in declared_by(piece))
    required = frozenset(name for piece in pieces for name in required_by(piece))
    return Cut(pieces, tuple(comments), declared, required)


def declared_by(tokens: Sequence[Token]) -> tuple[str, ...]:
    """Return the name that a statement declares for formulas, whole or broken; none if it declares none."""
    return (str(tokens[1]),) if len(tokens) > 1 and tokens[0].type in DECLARING else ()


def required_by(tokens: Sequence[Token]) -> tuple[str, ...]:
    """Return the name of a requirement, whole or broken; none if it is another statement."""
    return (str(tokens[1]),) if len(tokens) > 1 and tokens[0].type in ("HARD", "SOFT") else ()


def _pieces(tokens: Sequence[Token]) -> Iterator[tuple[Token, ...]]:
    begin = 0
    for i in range(1, len(tokens)):
        if first_on_line(tokens, i) and begins_statement(tokens, i):
            yield tuple(tokens[begin:i])
            begin = i
    if tokens:
        yield tuple(tokens[begin:])


def first_on_line(tokens: Sequence[Token], i: int) -> bool:
    """Tell whether the token before token `i` ends on an earlier line."""
    return i == 0 or (tokens[i - 1].end_line or 0) < (tokens[i].line or 0)


def begins_statement(tokens: Sequence[Token], i: int) -> bool:
    """Tell whether token `i`, the first on its line, begins a statement; that and the next one on the line decide."""
    token = tokens[i]
    if token.type in _RESERVED_STARTS:
        return True
    if i + 1 == len(tokens) or tokens[i + 1].line != token.line:
        return False
    after = tokens[i + 1]
    match token.type:
        case "TIME":
            return after.type == "NUMBER" or str(after) in (*TIME_UNITS, "step")
        case "SPEC":
            return after.type == "NAME"
        case "USE":
            return after.type == "STRING"
    return False


def begins_like_statement(tokens: Sequence[Token], i: int, names: frozenset[str]) -> bool:
    """Tell whether token `i` looks like a misspelt beginning of a statement: `hrad safe`, or `time` and no more.

    Asked only inside a statement that is broken anyway, so that it does not swallow the next one.
    """
    token = tokens[i]
    if not first_on_line(tokens, i) or not is_word(token) or str(token) in names:
        return False
    if i + 1 == len(tokens) or tokens[i + 1].line != token.line:
        return token.type == "TIME"
    meant = closest(str(token), STATEMENT_WORDS, 0.7)
    if tokens[i + 1].type == "STRING":
        return meant in ("expect", "use")
    return meant == "time" if tokens[i + 1].type == "NUMBER" else meant is not None and is_word(tokens[i + 1])


def stands_before_statement(tokens: Sequence[Token], i: int) -> bool:
    """Tell whether token `i` is the first on its line and the second begins a statement: `) signal d`."""
    if not first_on_line(tokens, i) or i + 1 >= len(tokens) or tokens[i + 1].line != tokens[i].line:
        return False
    return begins_statement(tokens, i + 1)


@dataclass(frozen=True, slots=True)
class Lost:
    """What broken statements may have been meant to say.

    names: that they may declare. nameless: one of them lost its name altogether. time: one of them may be the
    `time` statement. units: the quoted texts of broken signals, of which one may be its unit.
    """

    names: frozenset[str] = frozenset()
    nameless: bool = False
    time: bool = False
    units: frozenset[str] = frozenset()


NOTHING_LOST = Lost()


def merged(parts: Sequence[Lost]) -> Lost:
    """Return what all parts together may have been meant to say."""
    return Lost(
        frozenset[str]().union(*(part.names for part in parts)),
        any(part.nameless for part in parts),
        any(part.time for part in parts),
        frozenset[str]().union(*(part.units for part in parts)),
    )


def lost(broken: Sequence[Sequence[Token]]) -> Lost:
    """Return what the tokens of broken statements may have been meant to declare.

    That is what stands near a statement's word, every word of a broken `signal` or `param`, and the first words
    of lines that begin with no statement's word (`sginal d`, or `d` where the word was lost).
    """
    names: set[str] = set()
    for tokens in broken:
        words = list(tokens) if tokens[0].type in ("SIGNAL", "PARAM") else list(tokens[:3])
        if tokens[0].type not in _RESERVED_STARTS:
            words += [t for i in range(1, len(tokens)) if first_on_line(tokens, i) for t in tokens[i : i + 2]]
        for left, right in pairwise(tokens):
            words += [right] if left.type in _RESERVED_STARTS else [left] if right.type in _RESERVED_STARTS else []
        names.update(str(token) for token in words if is_word(token))
        # `signal alarmbool :` lost the gap between a name and its type.
        names.update(str(t).removesuffix(kind) for t in words for kind in ("bool", "real") if is_word(t))
    return Lost(
        frozenset(names - {""}),
        any(tokens[0].type in _RESERVED_STARTS and not _has_name(tokens) for tokens in broken),
        any(tokens[0].type not in _RESERVED_STARTS for tokens in broken),
        frozenset(
            str(token)[1:-1]
            for tokens in broken
            if tokens[0].type not in ("HARD", "SOFT", "LET", "EXPECT")
            for token in tokens
            if token.type == "STRING"
        )
        | frozenset(str(b) for tokens in broken for a, b in pairwise(tokens) if a.type == "UNIT_WORD"),
    )


def _has_name(tokens: Sequence[Token]) -> bool:
    """Tell whether a broken declaration still has its name, perhaps behind something that does not belong there."""
    words = [is_word(token) and str(token) not in RESERVED | _HEADER_WORDS for token in tokens[1:3]]
    fits = len(tokens) > 1 and tokens[1].type not in ("COLON", "STRING", "ASSIGN", "LPAR")
    return words[:1] == [True] or (fits and words[1:] == [True])
