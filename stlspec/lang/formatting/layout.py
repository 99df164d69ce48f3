"""Documents that break into lines where they are too long, with comments woven in.

In: a `Doc`, a tree of texts, places where a line may break, and groups that break together, and the comments of
the source. Out: lines. A leaf knows where it stood in the source, and the comments before that place are written
first: so comments keep their order whatever happens to the text around them, and what stands behind a comment
begins a new line without the document knowing.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

WIDTH = 100
STEP = 4


@dataclass(frozen=True, slots=True)
class Leaf:
    """A text, and where the source has it."""

    text: str
    at: int


@dataclass(frozen=True, slots=True)
class Break:
    """A place where a line may end: a blank if it does not, nothing for "soft"; "hard" always ends it."""

    kind: Literal["blank", "soft", "hard"]


@dataclass(frozen=True, slots=True)
class Indent:
    """What begins its lines `width` further to the right."""

    inner: "Doc"
    width: int = STEP


@dataclass(frozen=True, slots=True)
class Fold:
    """What stands on one line if it fits there; else, or with a comment between start and end, all of it breaks."""

    inner: "Doc"
    start: int
    end: int


Doc = str | Leaf | Break | Indent | Fold | tuple["Doc", ...]
LINE, SOFT, HARD = Break("blank"), Break("soft"), Break("hard")


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment: its place, whether it stands behind something on its line, whether a blank line is above it."""

    text: str
    at: int
    trailing: bool
    blank_above: bool


class Lines:
    """Writes documents below one another; `comments` is those of the whole source, in order."""

    def __init__(self, comments: Sequence[Comment]) -> None:
        self._comments = comments
        self._starts = [comment.at for comment in comments]
        self._next = 0
        self._lines: list[str] = []
        self._commented = False
        """The last line ends with a comment."""
        self._pending: Literal["", "blank", "line"] = ""
        self._indent = 0
        """How far the pending line is indented."""

    def text(self) -> str:
        """Return all lines, the last one with its end."""
        return "".join(f"{line.rstrip()}\n" for line in self._lines)

    def begin(self, *, blank_above: bool) -> None:
        """Begin a line at the left margin."""
        if blank_above and self._lines:
            self._lines.append("")
        self._lines.append("")
        self._commented, self._pending = False, ""

    def write(self, doc: Doc) -> None:
        """Write a document behind what is on the last line."""
        pending: list[tuple[int, bool, Doc]] = [(0, False, doc)]
        while pending:
            indent, flat, top = pending.pop()
            match top:
                case str():
                    self._put(top, indent)
                case Leaf(text, at):
                    self.comments_before(at, indent)
                    self._put(text, indent)
                case Break(kind):
                    self._break(kind, indent, flat=flat)
                case Indent(inner, width):
                    pending.append((indent + width, flat, inner))
                case Fold(inner, start, end):
                    self.comments_before(start, indent)
                    fits = flat or (not self._has_comment(start, end) and self._fits(inner, indent, pending))
                    pending.append((indent, fits, inner))
                case tuple():
                    pending.extend((indent, flat, part) for part in reversed(top))

    def comments_before(self, at: int, indent: int) -> None:
        """Write the comments that stand before place `at` and are not written yet."""
        while self._next < len(self._comments) and self._starts[self._next] < at:
            comment = self._comments[self._next]
            self._next += 1
            if comment.trailing and self._lines and not self._commented:
                self._lines[-1] = f"{self._lines[-1].rstrip()}  {comment.text}"
            else:
                if comment.blank_above and self._lines:
                    self._lines.append("")
                margin = self._indent if self._pending == "line" else indent
                self._lines.append(" " * margin + comment.text)
            self._commented = True

    def _break(self, kind: str, indent: int, *, flat: bool) -> None:
        if kind == "hard" or not flat:
            self._pending, self._indent = "line", indent
        elif kind == "blank":
            self._pending = "blank"

    def _put(self, text: str, indent: int) -> None:
        if self._pending == "line" or self._commented:
            margin = self._indent if self._pending == "line" else indent
            self._lines.append(" " * margin + text)
            self._commented = False
        else:
            self._lines[-1] += (" " if self._pending == "blank" else "") + text
        self._pending = ""

    def _column(self, indent: int) -> int:
        """Return where the next text begins."""
        if self._pending == "line":
            return self._indent
        return indent if self._commented else len(self._lines[-1]) + (self._pending == "blank")

    def _has_comment(self, start: int, end: int) -> bool:
        return bisect_right(self._starts, start) < bisect_right(self._starts, end - 1)

    def _fits(self, doc: Doc, indent: int, rest: Sequence[tuple[int, bool, Doc]]) -> bool:
        """Tell whether `doc` on one line, and what follows up to where that may break, stay within the width."""
        room = WIDTH - self._column(indent)
        waiting: list[tuple[bool, Doc]] = [(True, doc)]
        following = len(rest)
        while room >= 0:
            if not waiting:
                if not following:
                    return True
                following -= 1
                _, flat, doc = rest[following]
                waiting.append((flat, doc))
            flat, top = waiting.pop()
            match top:
                case str():
                    room -= len(top)
                case Leaf(text):
                    room -= len(text)
                case Break(kind):
                    if kind == "hard" or not flat:
                        return True
                    room -= kind == "blank"
                case Indent(inner) | Fold(inner):
                    waiting.append((flat, inner))
                case tuple():
                    waiting.extend((flat, part) for part in reversed(top))
        return False
