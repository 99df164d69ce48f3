"""The word, or the column of data, that a person probably meant.

In: a word that does not fit, and the words that would. Out: the nearest one, or None. Long lists are thinned
out first, so that a file with thousands of names and thousands of slips still costs little.
"""

import re
from bisect import bisect_left
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

_MANY = 100
_NEIGHBOURS = 10
_UNIT = re.compile(
    r"(?P<name>.*?\S)\s*(?:\[(?P<square>[^\[\]]*[^\W\d][^\[\]]*|%)\]|\((?P<round>[^()]*[^\W\d][^()]*|%)\))\s*"
)
_SHORTEST, _LONGEST_TIMES = 3, 3
"""A beginning of three letters or more stands for a name of up to three times its length: `alt` for `altitude`."""


def closest(word: str, candidates: Iterable[str], cutoff: float = 0.6) -> str | None:
    """Return the candidate nearest to `word`; one that differs in case, or in the order of letters, comes first.

    Args:    cutoff: how alike they must be at least, from 0 to 1.
    """
    known = list(dict.fromkeys(candidates))
    folded, letters = word.casefold(), sorted(word)
    others = [other for other in known if len(other) == len(word) and other != word]
    for other in others:
        if other.casefold() == folded or (len(word) > 2 and sorted(other) == letters):
            return other
    if len(known) > _MANY:
        known = _beginning_like(word, known) + [x[::-1] for x in _beginning_like(word[::-1], [x[::-1] for x in known])]
    found = get_close_matches(word, known, 1, cutoff)
    return found[0] if found else None


def split_unit(column: str) -> tuple[str, str | None]:
    """Split the name of a column from the unit in brackets behind it, as in `alt [m]`; None: there is none.

    Not in the paper: data. `obs[0]` is a name, since no unit is a number.
    """
    match = _UNIT.fullmatch(column)
    return (match["name"], match["square"] or match["round"]) if match else (column, None)


def closest_column(name: str, columns: Iterable[str]) -> str | None:
    """Return the column that a signal of this name is probably read from, None if none is like it.

    Case, `_`, blanks and dots, and a unit in brackets make no difference; then come the last part of a dotted name, a
    name that begins with the other, and names that differ by a few letters.
    """
    plain = {column: _letters(split_unit(column)[0]) for column in columns}
    wanted = _letters(name)
    if not wanted:
        return None
    same = [column for column, letters in plain.items() if letters == wanted]
    same += [c for c in plain if _letters(re.split(r"[./]", split_unit(c)[0])[-1]) == wanted]
    begun = [column for column, letters in plain.items() if _begins(wanted, letters) or _begins(letters, wanted)]
    if same or begun:
        return (same or sorted(begun, key=lambda column: abs(len(plain[column]) - len(wanted))))[0]
    near = get_close_matches(wanted, list(plain.values()), 1)
    return next((column for column, letters in plain.items() if letters in near), None)


def _letters(name: str) -> str:
    return re.sub(r"[_\s.-]+", "", name).casefold()


def _begins(short: str, long: str) -> bool:
    return _SHORTEST <= len(short) <= len(long) <= _LONGEST_TIMES * len(short) and long.startswith(short)


def _beginning_like(word: str, known: Sequence[str]) -> list[str]:
    """Return the neighbours of `word` in alphabetical order: they share the most letters at the beginning."""
    ordered = sorted(known)
    at = bisect_left(ordered, word)
    return ordered[max(0, at - _NEIGHBOURS) : at + _NEIGHBOURS]
