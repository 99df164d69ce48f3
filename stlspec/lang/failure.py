"""Where a statement cannot be parsed, and all that is known there.

In: what the parser saw when it stopped. Out: a `Failure`, from which `hints` and `repairs` make one diagnostic.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from lark import Token

from stlspec.errors import Diagnostic, Edit, Label, diagnostic
from stlspec.lang.tree import span_of
from stlspec.source import SourceText, Span

TEMPORAL = frozenset(
    (
        "ALWAYS G GLOBALLY ALW ALW_ EVENTUALLY F FINALLY EV EV_ HISTORICALLY H HIST HIST_ ONCE O ONCE_ "
        "UNTIL U UNTIL_ SINCE S SINCE_ UNLESS W RELEASE R"
    ).split()
)
"""Terminals of the words that take an interval."""


@dataclass(frozen=True, slots=True)
class Failure:
    """A statement that cannot be parsed.

    at: index of the token that does not fit; len(tokens) if the statement ends too early. expected: terminals
    that fit there. brackets: the opening brackets still open. beginning: nothing before the token belongs to
    its statement. names: what the text declares.
    """

    source: SourceText
    tokens: tuple[Token, ...]
    at: int
    expected: frozenset[str]
    brackets: tuple[Token, ...]
    beginning: bool
    names: frozenset[str]

    @property
    def token(self) -> Token | None:
        """The token that does not fit; None at the end."""
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    def place(self, token: Token) -> int:
        """Return the index of a token; equal ones, such as two brackets, are told apart."""
        return next(i for i, other in enumerate(self.tokens) if other is token)

    @property
    def span(self) -> Span:
        """Where to point: at the token, or just behind the last one."""
        if self.token is not None:
            return span_of(self.token)
        end = span_of(self.tokens[-1]).end
        return Span(end, end)

    def text(self, tokens: Sequence[Token]) -> str:
        """Return the text from the first of `tokens` to the last."""
        return self.source.slice(Span(span_of(tokens[0]).start, span_of(tokens[-1]).end))

    def error(
        self,
        code: str,
        *,
        at: Span | None = None,
        labels: tuple[Label, ...] = (),
        edits: tuple[Edit, ...] = (),
        **fields: str,
    ) -> Diagnostic:
        """Make the diagnostic `code` at `at`, or at the token that does not fit."""
        return diagnostic(code, source=self.source, span=at or self.span, labels=labels, edits=edits, **fields)
