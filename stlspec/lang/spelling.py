"""The word that a person probably meant.

In: a word that does not fit, and the words that would. Out: the nearest one, or None. Long lists are thinned
out first, so that a file with thousands of names and thousands of slips still costs little.
"""

from bisect import bisect_left
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

_MANY = 100
_NEIGHBOURS = 10


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


def _beginning_like(word: str, known: Sequence[str]) -> list[str]:
    """Return the neighbours of `word` in alphabetical order: they share the most letters at the beginning."""
    ordered = sorted(known)
    at = bisect_left(ordered, word)
    return ordered[max(0, at - _NEIGHBOURS) : at + _NEIGHBOURS]
