"""Ways out of mistakes of names, types and units: what was probably meant, written as it would be here.

In: expressions, their typings, and pieces of the text. Out: the words of a help, and the edits that do it; none
where only the author knows.
"""

import re
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction

from stlspec.compiler.model import FORMULA, Typing
from stlspec.errors import Edit
from stlspec.lang.hints import OPERATOR_WORDS
from stlspec.lang.nodes import Call, Expression, Group, Infix, Name, Number, Truth
from stlspec.lang.spelling import closest
from stlspec.lang.units import NANOSECONDS, SCALES, Dimension, spell
from stlspec.source import Span

Advice = tuple[str, tuple[Edit, ...]]
Operand = tuple[Expression, Typing]
Text = Callable[[Span], str]

FOR_FORMULAS = {
    **dict.fromkeys(("==", "!="), "use `iff` to say that two formulas agree"),
    **dict.fromkeys(("=>", "<="), "for `implies` write `->`; to compare, both sides are numbers"),
    "-": "`-` takes a number; to negate a formula write `not`",
}
_FOREIGN = {"infinity": "inf", "infty": "inf", "oo": "inf"}
"""Names of other languages, in small letters, and the word for them here."""
_MULTIPLIED = re.compile(r"(?P<sign>[-<>=(,*/+]\s*)?(?P<word>\w[\w.]*)(?:\*\*\d)?\s*[*/]\s*$")
LONGEST_UNIT = 60
"""Characters before a name that are looked at."""
_LONGEST_NUMBER = 9
"""Digits of a factor that is worth a suggestion."""


def short(text: str) -> str:
    """Cut a piece of source to what fits into a message."""
    flat = " ".join(text.split())
    return flat if len(flat) <= 30 else flat[:29] + "…"


def for_unknown(name: str, span: Span, known: Iterable[str], *, constant: bool = False) -> Advice:
    """Say what to do about a name that nothing declares; `known` are those that may have been meant.

    constant: the name stands where no signal may, in the bound of a window or of a range.
    """
    foreign = _FOREIGN.get(name.casefold())
    if foreign is not None:
        return f"write `{foreign}`", (Edit(span, foreign),)
    close = closest(name, known)
    if close is not None:
        return f"did you mean `{close}`?", (Edit(span, close),)
    if name in OPERATOR_WORDS:
        return f"`{name}` is an operator: it needs an operand", ()
    if constant:
        return f"declare it: `param {name} = ...` or `let {name} = ...`", ()
    return f"declare it: `signal {name}`, `param {name} = ...` or `let {name} = ...`", ()


def first_of_unit(before: str) -> str | None:
    """Return the word that is multiplied with or divided by what stands behind `before`; None if there is none.

    The unit of a number is a word that was read, which gives the empty text: in `3 N*m` only `m` is a name.
    """
    found = _MULTIPLIED.search(before)
    return None if found is None else found["word"] if found["sign"] else ""


def for_truth(node: Infix, below: Sequence[Typing], text: Text) -> Advice | None:
    """Return the formula that `p == true` or `p != 1` means, `p` or `not p`; None for other comparisons."""
    word = node.operators[0].word
    if len(node.operands) != 2 or word not in ("eq", "ne") or FORMULA not in below:
        return None
    for constant, other, typing in zip(node.operands, reversed(node.operands), reversed(below), strict=True):
        value, formula = _truth(constant), text(other.span)
        if isinstance(constant, Truth) and typing.kind == "real":
            return f"`{short(formula)}` is a number: compare it with one, as in `{short(formula)} > 0`", ()
        if value is None or typing != FORMULA:
            continue
        if value != (word == "eq"):
            formula = f"not {formula}" if isinstance(other, Name | Group | Call | Truth) else f"not ({formula})"
        return f"write `{short(formula)}`", (Edit(node.span, formula),)
    return None


def _truth(node: Expression) -> bool | None:
    if isinstance(node, Truth):
        return node.value
    return bool(node.value) if isinstance(node, Number) and node.unit is None and node.value in (0, 1) else None


def for_units(first: Operand, second: Operand, text: Text, *, pair: bool) -> Advice:
    """Say how two operands come to one unit: the second in the first's, or if they are a `pair` the other way round.

    Times are converted without a word, so that the factor is one between the other units.
    """
    if not first[1].unit or not second[1].unit:
        return "declare the unit of both sides", ()
    ways = [_literal(second, first[1].unit), _literal(first, second[1].unit) if pair else None]
    factors = [_factor(second, first[1].unit, text), _factor(first, second[1].unit, text) if pair else None]
    # Of two factors, the one that is at least 1 reads better.
    factors.sort(key=lambda way: way is None or "* 0." in way[0])
    found = next((way for way in (*ways, *factors) if way is not None), None)
    return found or ("convert one side by a factor with a unit", ())


def _literal(operand: Operand, unit: Dimension) -> Advice | None:
    """Return a number with its unit in another unit, if it is a short one: `10 m/s` for `36 km/h`."""
    node, typing = operand
    assert typing.unit is not None
    ratio = _ratio(typing.unit, unit)
    if not isinstance(node, Number) or ratio is None or not _writable(unit):
        return None
    number = _decimal(Fraction(repr(node.value)) * ratio)
    written = f"{number} {spell(unit)}"
    return (f"write `{written}`", (Edit(node.span, written),)) if number else None


def _factor(operand: Operand, unit: Dimension, text: Text) -> Advice | None:
    """Return the operand times a factor between the units that are no times: `d * 1000 m/km`."""
    node, typing = operand
    assert typing.unit is not None
    if _ratio(typing.unit, unit) is None:
        return None
    powers: dict[str, int] = {}
    for sign, exponents in ((1, unit), (-1, typing.unit)):
        for word, power in exponents.items():
            if word not in NANOSECONDS:
                powers[word] = powers.get(word, 0) + sign * power
    powers = {word: power for word, power in powers.items() if power}
    number = _decimal(_ratio({w: -p for w, p in powers.items()}, {}) or Fraction(0))
    if not number or not _writable(powers):
        return None
    inner = text(node.span)
    inner = inner if isinstance(node, Name | Number | Call | Group) else f"({inner})"
    times = [{w: p for w, p in d.items() if w in NANOSECONDS} for d in (unit, typing.unit)]
    also = "; times are converted already" if times[0] != times[1] else ""
    written = f"{inner} * {number} {spell(powers)}"
    return f"write `{written}`{also}", (Edit(node.span, written),)


def _writable(unit: Dimension) -> bool:
    """Tell whether a unit can stand behind a number: one that begins with a word, and has no `*`."""
    return sum(power > 0 for power in unit.values()) == 1


def _ratio(unit: Dimension, to: Dimension) -> Fraction | None:
    """Return the factor from `unit` to `to` if each word is a multiple of the same base; None otherwise."""
    factor, bases = Fraction(1), dict[str, int]()
    for sign, exponents in ((1, unit), (-1, to)):
        for word, power in exponents.items():
            if abs(power) > 4:
                return None
            base, scale = SCALES.get(word, (word, Fraction(1)))
            bases[base] = bases.get(base, 0) + sign * power
            factor *= scale ** (sign * power)
    return None if any(bases.values()) else factor


def _decimal(value: Fraction) -> str:
    """Return a number as a short decimal; the empty text if it is none."""
    if not abs(value) < 10**_LONGEST_NUMBER:
        return ""
    text = f"{float(value):.12g}"
    return text if "e" not in text and len(text) <= _LONGEST_NUMBER and value and Fraction(text) == value else ""
