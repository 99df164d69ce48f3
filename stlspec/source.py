"""Source text and places in it.

In: the bytes or the text of a spec as the user wrote it. Out: a `SourceText` that turns offsets into lines
and columns and draws an excerpt with carets. Lines end at LF only (a lone CR counts as LF, one for one, so
that no offset moves); columns count code points from 1; ends are exclusive.
"""

import re
from bisect import bisect_right
from dataclasses import dataclass, field

_LONE_CR = re.compile(r"\r(?!\n)")
_SURROGATE = re.compile("[\ud800-\udfff]")
_LONGEST_LINE_SHOWN = 160


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A stretch of a source text, in code points from its beginning; `end` is exclusive."""

    start: int
    end: int

    def to(self, other: "Span") -> "Span":
        """Return the smallest span that holds this one and `other`."""
        return Span(min(self.start, other.start), max(self.end, other.end))


@dataclass(frozen=True, slots=True)
class Position:
    """A line and a column, both counted from 1."""

    line: int
    column: int


@dataclass(frozen=True, slots=True)
class SourceText:
    """The text of one file (or of a string handed to the compiler) under the name shown to the user."""

    name: str
    text: str
    _line_starts: tuple[int, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        starts = [0]
        at = self.text.find("\n")
        while at >= 0:
            starts.append(at + 1)
            at = self.text.find("\n", at + 1)
        object.__setattr__(self, "_line_starts", tuple(starts))

    @classmethod
    def of(cls, name: str, text: str) -> "SourceText":
        """Normalise `text` as it comes from a file: no byte-order mark, lone CR as LF; CRLF stays.

        Half surrogate pairs, which no file can hold, become replacement characters, one for one.
        """
        text = _LONE_CR.sub("\n", text.removeprefix("\ufeff"))
        return cls(_SURROGATE.sub("\ufffd", name), _SURROGATE.sub("\ufffd", text))

    def position(self, offset: int) -> Position:
        """Return the line and column of `offset`."""
        line = bisect_right(self._line_starts, offset)
        return Position(line, offset - self._line_starts[line - 1] + 1)

    def line(self, number: int) -> str:
        """Return line `number` (from 1) without its end."""
        start = self._line_starts[number - 1]
        end = self._line_starts[number] - 1 if number < len(self._line_starts) else len(self.text)
        return self.text[start:end].rstrip("\r")

    def slice(self, span: Span) -> str:
        """Return the text that `span` covers."""
        return self.text[span.start : span.end]

    def excerpt(self, span: Span, note: str = "") -> list[str]:
        """Draw the line where `span` begins, with carets under the span and `note` beside them.

        Returns: two lines, `  12 | text` and the carets; tabs become one blank so that carets stay aligned.
        """
        first = self.position(span.start)
        text = self.line(first.line).replace("\t", " ")
        begin = first.column - 1
        width = max(1, min(span.end - span.start, len(text) - begin))
        if len(text) > _LONGEST_LINE_SHOWN:
            cut = max(0, begin - _LONGEST_LINE_SHOWN // 2)
            text = text[cut : cut + _LONGEST_LINE_SHOWN]
            begin -= cut
            width = max(1, min(width, len(text) - begin))
        printable = "".join(c if c.isprintable() else "?" for c in text)
        number = f"{first.line:>4}"
        carets = " " * begin + "^" * width + (f" {note}" if note else "")
        return [f"{number} | {printable}", f"{' ' * len(number)} | {carets}"]
