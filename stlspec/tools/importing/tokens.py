"""The tokens of foreign specs, and a cursor over them.

In: a text. Out: words, numbers, signs and quoted texts with their places, comments apart. The dialects differ in
their signs and in how comments look, and are near enough in all else to share this.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NoReturn, Protocol

from stlspec.errors import Diagnostic, diagnostic
from stlspec.source import SourceText, Span

Kind = Literal["word", "number", "sign", "text", "end"]
_PARTS = {
    "blank": r"[ \t\r\n\f]+",
    "number": r"(?:0[xX][0-9a-fA-F]+|0[bB][01]+|(?:[0-9][0-9_]*(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)",
    "text": r"\"[^\"\n]*\"|'[^'\n]*'",
}


class Unreadable(Exception):  # noqa: N818 - no error of the program: what is wrong with one statement
    """A statement cannot be read or carried over; holds the diagnostic."""

    def __init__(self, problem: Diagnostic) -> None:
        self.problem = problem
        super().__init__(problem.message)


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of text; begins_line: no other token stands before it on its line."""

    kind: Kind
    text: str
    span: Span
    begins_line: bool = False


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment without its signs, a line each; trails: something stands before it on its line."""

    span: Span
    lines: tuple[str, ...]
    trails: bool


def lex(source: SourceText, word: str, signs: Sequence[str], comment: str) -> tuple[list[Token], list[Comment]]:
    """Cut a text into tokens; a character that fits nowhere becomes a sign, which the parser will not take.

    Not in the paper: other tools' languages.

    Args:    word, comment: regular expressions. signs: longest first.
    Returns: the tokens, an "end" last; the comments.
    """
    kinds = {"comment": comment, **_PARTS, "word": word, "sign": "|".join(map(re.escape, signs)), "other": r"."}
    pattern = re.compile("|".join(f"(?P<{kind}>{part})" for kind, part in kinds.items()), re.S)
    tokens: list[Token] = []
    comments: list[Comment] = []
    fresh = True
    for match in pattern.finditer(source.text):
        kind, text, span = match.lastgroup, match[0], Span(match.start(), match.end())
        if kind == "comment":
            lines = [line.strip(" \t\r*#/") for line in text.split("\n")]
            comments.append(Comment(span, tuple(line for line in lines if line), not fresh))
        if kind in ("comment", "blank"):
            fresh = fresh or "\n" in text
            continue
        name: Kind = kind if kind in ("word", "number", "text") else "sign"  # type: ignore[assignment]
        tokens.append(Token(name, text, span, fresh))
        fresh = False
    end = len(source.text.rstrip())
    tokens.append(Token("end", "", Span(end, end), True))
    return tokens, comments


def number_of(text: str) -> float:
    """Return the value of a number, hexadecimal and binary ones included. Not in the paper: other tools' languages."""
    plain = text.replace("_", "")
    if plain[:2] in ("0x", "0X", "0b", "0B"):
        return float(int(plain, 0))
    return float(plain)


class Cursor:
    """A place among the tokens of a text; tool: whose language it is, for messages."""

    def __init__(self, source: SourceText, tokens: Sequence[Token], tool: str) -> None:
        self.source = source
        self.tool = tool
        self._tokens = tokens
        self._at = 0

    @property
    def token(self) -> Token:
        """The token at hand."""
        return self._tokens[self._at]

    @property
    def after(self) -> Token:
        """The token after the one at hand."""
        return self._tokens[min(self._at + 1, len(self._tokens) - 1)]

    @property
    def before(self) -> Token:
        """The token before the one at hand."""
        return self._tokens[max(self._at - 1, 0)]

    @property
    def at_end(self) -> bool:
        """Whether all tokens are taken."""
        return self.token.kind == "end"

    def take(self) -> Token:
        """Take the token at hand."""
        token = self.token
        self._at = min(self._at + 1, len(self._tokens) - 1)
        return token

    def takes(self, *texts: str) -> Token | None:
        """Take the token at hand if it is one of `texts`, as it stands outside quotes."""
        return self.take() if self.token.kind != "text" and self.token.text in texts else None

    def need(self, text: str) -> Token:
        """Take the token at hand, which must be `text`."""
        return self.takes(text) or self.misfit(f"`{text}`")

    def need_word(self, what: str = "a name") -> Token:
        """Take the token at hand, which must be a word."""
        return self.take() if self.token.kind == "word" else self.misfit(what)

    def misfit(self, expected: str) -> NoReturn:
        """Refuse the token at hand."""
        token = self.token
        shown = "the end of the text" if token.kind == "end" else f"`{token.text[:30]}`"
        self.refuse("S041", token.span, found=shown, tool=self.tool, expected=expected)

    def refuse(self, code: str, span: Span, **fields: Any) -> NoReturn:
        """Give up the statement at hand."""
        raise Unreadable(diagnostic(code, source=self.source, span=span, **fields))

    def cannot_carry(self, span: Span, what: str, why: str, way: str) -> NoReturn:
        """Give up the statement at hand, whose construct this language does not have."""
        self.refuse("S040", span, what=what, why=why, help=way)


class Reader(Protocol):
    """Reads the statements of one language."""

    cursor: Cursor

    def statement(self) -> None:
        """Read the next statement. Raises: Unreadable."""

    def skip(self, first: Token) -> None:
        """Go on to the statement after the broken one that begins with `first`."""


def read_statements(reader: Reader, problems: list[Diagnostic]) -> None:
    """Read statement by statement, whatever is wrong with some of them.

    Not in the paper: other tools' languages.

    Args: problems: takes what is wrong, one diagnostic for each broken statement, in order.
    """
    while not reader.cursor.at_end:
        first = reader.cursor.token
        try:
            reader.statement()
        except Unreadable as error:
            problems.append(error.problem)
            reader.skip(first)
