"""Elements of HTML and SVG, written so that nothing a user named can become markup.

In: names, attributes and children. Out: `Markup`. Children and attributes that are not `Markup` are escaped where
they are put in, so that forgetting to escape is not possible; only `trusted` text, which this package ships, is
taken as it is.
"""

import math
import re
from collections.abc import Iterable
from html import escape

_VOID = frozenset({"meta", "br", "hr", "input", "link", "img"})
_UNPRINTABLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff\u202a-\u202e\u2066-\u2069]")
_LARGEST_WHOLE = 1e7
_LONGEST_NAME = 120


class Markup(str):
    """Text that is markup already."""

    __slots__ = ()


def trusted(text: str) -> Markup:
    """Take a text that this package ships, such as a style sheet, as markup."""
    return Markup(text)


def text(value: object) -> Markup:
    """Return anything as the text of an element: markup as it is, the rest escaped.

    Not in the paper: packaging. Characters that HTML and XML cannot hold, and those that turn the direction of
    writing, become U+FFFD.
    """
    if isinstance(value, Markup):
        return value
    return Markup(escape(_UNPRINTABLE.sub("�", _word(value)), quote=True))


def _word(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)


def join(parts: Iterable[object], between: str = "") -> Markup:
    """Put several children one after another."""
    return Markup(between.join(text(part) for part in parts))


def element(name: str, /, *children: object, **attributes: object) -> Markup:
    """Write an element.

    Not in the paper: packaging.

    Args:    children: markup, or text to be escaped; None is left out. attributes: `class_` is class, `aria_label`
             is aria-label; None and False are left out, True stands alone.
    """
    written = "".join(_attribute(key, value) for key, value in attributes.items() if value not in (None, False))
    if name in _VOID:
        return Markup(f"<{name}{written}>")
    inside = "".join(text(child) for child in children if child is not None)
    return Markup(f"<{name}{written}>{inside}</{name}>")


def _attribute(key: str, value: object) -> str:
    name = key.rstrip("_").replace("_", "-")
    return f" {name}" if value is True else f' {name}="{text(value)}"'


def number(value: float | None) -> str:
    """Write a number for people: four digits, whole ones in full, infinities as ∞, – where there is none."""
    if value is None:
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    whole = abs(value) < _LARGEST_WHOLE and value == int(value)
    return f"{int(value)}" if whole else f"{value + 0.0:.4g}"


def short(name: str, at_most: int = _LONGEST_NAME) -> str:
    """Return a name on one line, its middle left out where it is too long: both ends tell names apart."""
    line = " ".join(name.split())
    if len(line) <= at_most:
        return line
    head = at_most // 2
    return f"{line[:head]}…{line[head + 1 - at_most :]}"
