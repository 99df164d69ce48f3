"""The words around a place, whether or not the statement there can be parsed.

In: a text and an offset. Out: the tokens of the statement around it, or of its part before it and what fits behind
them. Only that statement is lexed: the text is cut at lines that begin as a statement does.
"""

import re
import string
from dataclasses import dataclass

from stlspec.lang.parse import following, tokens_of
from stlspec.lang.statements import STATEMENT_WORDS
from stlspec.lang.tree import span_of
from stlspec.source import SourceText, Span

_RESERVED = "|".join(word for word in STATEMENT_WORDS if word not in ("spec", "use", "time"))
_BEGINNING = re.compile(
    rf"^[ \t]*(?:(?:{_RESERVED})\b|time[ \t]*(?:$|[\d.]|(?:step|[num]?s|min|h)\b)"
    r"|spec[ \t]*(?:$|[A-Za-z_])|use[ \t]*(?:$|\"))",
    re.MULTILINE,
)
_LETTERS = frozenset(string.ascii_letters + string.digits + "_")


@dataclass(frozen=True, slots=True)
class Token:
    """A token of the lexer: its terminal, its text, and where it stands in the whole text."""

    kind: str
    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Typed:
    """What is being typed.

    word: the word that ends at the cursor, as far as it goes; span: where. tokens: those of its statement before it.
    fits: the terminals that may stand behind them; none if they are broken already.
    """

    word: str
    span: Span
    tokens: tuple[Token, ...]
    fits: frozenset[str]


def statement_at(text: str, offset: int) -> Span:
    """Return the stretch from the last line that begins a statement, up to the next one."""
    start, end = 0, len(text)
    for match in _BEGINNING.finditer(text):
        if match.start() > offset:
            end = match.start()
            break
        start = match.start()
    return Span(start, end)


def tokens_in(source: SourceText, span: Span) -> tuple[Token, ...]:
    """Return the tokens of a stretch of a text, comments left out."""
    found = tokens_of(SourceText(source.name, source.slice(span)))
    return tuple(Token(token.type, str(token), _moved(span_of(token), span.start)) for token in found)


def token_at(source: SourceText, offset: int) -> Token | None:
    """Return the token at an offset, or that which ends there; None in a comment or between tokens."""
    tokens = tokens_in(source, statement_at(source.text, offset))
    touching = [token for token in tokens if token.span.start <= offset <= token.span.end]
    return touching[-1] if touching else None


def typed(source: SourceText, offset: int, names: frozenset[str]) -> Typed:
    """Return what is being typed at an offset. names: what the text and the files that it uses declare."""
    start = statement_at(source.text, offset).start
    word = _word_before(source.text, start, offset)
    found = tokens_of(SourceText(source.name, source.text[start : offset - len(word)]))
    tokens = tuple(Token(token.type, str(token), _moved(span_of(token), start)) for token in found)
    return Typed(word, Span(offset - len(word), offset), tokens, following(found, names))


def _word_before(text: str, least: int, offset: int) -> str:
    """Return the word that ends at an offset, sought backwards; digits before its first letter are a number."""
    start = offset
    while start > least and text[start - 1] in _LETTERS:
        start -= 1
    return text[start:offset].lstrip(string.digits)


def _moved(span: Span, by: int) -> Span:
    return Span(span.start + by, span.end + by)
