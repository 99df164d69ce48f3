"""Where the tokens and comments of a text stand.

In: a source text. Out: `Places`, which finds the word before a place, the words within a span, and the comments,
each with what decides how it is written: behind something on its line or on a line of its own.
"""

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass

from stlspec.lang.formatting.layout import Comment
from stlspec.lang.nodes import Text
from stlspec.lang.parse import tokens_of
from stlspec.source import SourceText, Span


@dataclass(frozen=True, slots=True)
class Places:
    """The tokens and comments of one text, in order."""

    source: SourceText
    starts: tuple[int, ...]
    ends: tuple[int, ...]
    comments: tuple[Comment, ...]

    @classmethod
    def of(cls, source: SourceText, comments: Sequence[Text]) -> "Places":
        """Find the places of a text whose comments are known."""
        tokens = tokens_of(source)
        starts = tuple(token.start_pos or 0 for token in tokens)
        ends = tuple(token.end_pos or 0 for token in tokens)
        return cls(source, starts, ends, tuple(_comment(source, comment) for comment in comments))

    def before(self, at: int, count: int) -> int:
        """Return where the token begins that stands `count` tokens before the one at `at`."""
        return self.starts[bisect_left(self.starts, at) - count]

    def words(self, span: Span) -> list[str]:
        """Return the tokens within a span."""
        first, last = bisect_left(self.starts, span.start), bisect_left(self.starts, span.end)
        return [self.source.text[self.starts[i] : self.ends[i]] for i in range(first, last)]

    def has_comment(self, span: Span) -> bool:
        """Tell whether a comment stands within a span."""
        return any(span.start <= comment.at < span.end for comment in self.comments)


def _comment(source: SourceText, comment: Text) -> Comment:
    start = comment.span.start
    line = source.position(start).line
    above = source.line(line - 1).strip() if line > 1 else ""
    trailing = bool(source.line(line)[: source.position(start).column - 1].strip())
    return Comment(comment.text.rstrip(), start, trailing, line > 1 and not above)
