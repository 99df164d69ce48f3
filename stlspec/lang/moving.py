"""The same nodes and diagnostics at another place of a text.

In: a statement, a comment or a diagnostic. Out: a new one, equal but for its places. New nodes throughout, since
passes keep what they find out of a node under its identity; no recursion, since a refused text may nest deeply.
"""

from collections.abc import Callable
from dataclasses import fields
from operator import attrgetter
from typing import Any, TypeVar

from stlspec.source import SourceText, Span

Movable = TypeVar("Movable")

_LEAVES = frozenset({str, int, float, bool, type(None), frozenset, Span})


class _Parts(dict[type, Callable[[Any], tuple[Any, ...]]]):
    """For each class a function that gives the parts of an instance, as its constructor takes them."""

    def __missing__(self, kind: type) -> Callable[[Any], tuple[Any, ...]]:
        first, *others = [field.name for field in fields(kind)]
        self[kind] = attrgetter(first, *others) if others else lambda value: (getattr(value, first),)
        return self[kind]


_PARTS = _Parts({tuple: tuple, SourceText: lambda _: ()})


def moved(root: Movable, by: int, source: SourceText) -> Movable:
    """Return `root` with every span moved `by` characters on, and every source replaced.

    Not in the paper: for editors.

    Args:    root: made of the classes of `nodes` and of diagnostics, and tuples of them.
    """
    order: list[Any] = [root]
    for value in order:  # grows on the way: every part stands behind what holds it
        order += [part for part in _PARTS[value.__class__](value) if part.__class__ not in _LEAVES]
    new: dict[int, Any] = {}
    for value in reversed(order):
        kind = value.__class__
        if kind is SourceText:
            new[id(value)] = source
            continue
        parts = [
            Span(part.start + by, part.end + by) if part.__class__ is Span else new.get(id(part), part)
            for part in _PARTS[kind](value)
        ]
        new[id(value)] = tuple(parts) if kind is tuple else kind(*parts)
    result: Movable = new[id(root)]
    return result
