"""Parsing of a text that changes a little at a time, as in an editor: only what was touched is read again.

In: one text after the other. Out: what `parse` says of each, new in every place, at the cost of what changed.
Three facts make that possible. No token goes over the end of a line, so that lexing may begin at any line. Whether
a line begins a statement depends on its first two tokens. And what a statement says depends on its own text, on
which of its words are declared as names, and, if it is broken, on whether a way out is still looked for. So what
is known of a stretch is kept under its text, with places counted from its beginning, and moved to where it stands.
"""

import re
from dataclasses import dataclass
from itertools import pairwise

from stlspec.lang.automaton import automaton
from stlspec.lang.moving import moved
from stlspec.lang.parse import MOST_REPAIRS, Piece, Syntax, assembled, parse_piece
from stlspec.lang.statements import STATEMENT_WORDS, begins_statement, declared_by, lexed, required_by
from stlspec.source import SourceText

_MAY_BEGIN = re.compile(rf"^[ \t\r\f]*(?:{'|'.join(STATEMENT_WORDS)})(?![A-Za-z_0-9])", re.MULTILINE)
"""A line whose first word may begin a statement; its next word decides, see `begins_statement`."""
_MOST_READINGS = 4
"""How many readings of a stretch are kept: one for each choice of its words as names."""


@dataclass(slots=True)
class Work:
    """How many stretches of text the last call lexed, and how many it parsed; most stretches are one statement."""

    lexed: int = 0
    parsed: int = 0


@dataclass(slots=True)
class _Reading:
    """What a stretch says. repairs: for how many broken statements a way out was looked for."""

    piece: Piece
    repairs: int

    def serves(self, repairs: int) -> bool:
        return self.repairs == repairs or min(self.repairs, repairs) >= len(self.piece.problems)


class _Stretch:
    """A text that begins a line and ends with one; its places count from its beginning."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens, self.comments = lexed(text, automaton().lark)
        self.words = frozenset(map(str, self.tokens))
        self.readings: dict[frozenset[str], _Reading] = {}


class Incremental:
    """Parses one text after the other, each at the cost of what differs from the one before.

    Not in the paper: for editors. Not for several threads at once.

    work: what the last call read anew.
    """

    def __init__(self) -> None:
        self.work = Work()
        self._name = ""
        self._known: dict[str, _Stretch] = {}
        self._placed: dict[int, tuple[Piece, Piece]] = {}

    def parse(self, source: SourceText, names: frozenset[str] = frozenset()) -> Syntax:
        """Return what `stlspec.lang.parse.parse` returns of the same arguments."""
        self.work = Work()
        if source.name != self._name:  # it stands in every diagnostic
            self._name, self._known, self._placed = source.name, {}, {}
        stretches = self._stretches(source.text)
        declared = frozenset(name for _, stretch in stretches for name in declared_by(stretch.tokens))
        required = frozenset(name for _, stretch in stretches for name in required_by(stretch.tokens))
        comments = tuple(moved(note, start, source) for start, stretch in stretches for note in stretch.comments)
        return assembled(source, self._pieces(source, stretches, names | declared), comments, declared, required)

    def _stretches(self, text: str) -> list[tuple[int, _Stretch]]:
        """Return where each statement begins, and its stretch, which goes on to the next; only new ones are lexed."""
        before, self._known = self._known, {}
        lines = [0, *(match.start() for match in _MAY_BEGIN.finditer(text) if match.start())]
        starts = [
            start
            for start, end in pairwise((*lines, len(text)))
            if not start or begins_statement(self._stretch(text[start:end], before).tokens, 0)
        ]
        return [(start, self._stretch(text[start:end], before)) for start, end in pairwise((*starts, len(text)))]

    def _stretch(self, text: str, before: dict[str, _Stretch]) -> _Stretch:
        """Return what is known of a text, and keep it for the next call."""
        found = self._known.get(text) or before.get(text)
        if found is None:
            found = _Stretch(text)
            self.work.lexed += 1
        self._known[text] = found
        return found

    def _pieces(self, source: SourceText, stretches: list[tuple[int, _Stretch]], names: frozenset[str]) -> list[Piece]:
        """Return what each statement says where it stands; a good one that stands where it stood stays as it is."""
        before, self._placed = self._placed, {}
        repairs = MOST_REPAIRS
        for start, stretch in stretches:
            if stretch.tokens:
                piece = self._read(source, stretch, names, max(repairs, 0))
                repairs -= len(piece.problems)
                same, placed = before.get(start, (None, piece))
                if same is not piece or piece.problems:
                    placed = moved(piece, start, source)
                self._placed[start] = (piece, placed)
        return [placed for _, placed in self._placed.values()]

    def _read(self, source: SourceText, stretch: _Stretch, names: frozenset[str], repairs: int) -> Piece:
        """Return what a stretch says, with places counted from its beginning; parse it only if need be."""
        known = names & stretch.words
        reading = stretch.readings.get(known)
        if reading is None or not reading.serves(repairs):
            text = SourceText(source.name, stretch.text)
            reading = _Reading(parse_piece(text, stretch.tokens, known, repairs), repairs)
            if len(stretch.readings) >= _MOST_READINGS:
                stretch.readings.clear()
            stretch.readings[known] = reading
            self.work.parsed += 1
        return reading.piece
