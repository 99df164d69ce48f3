"""Units of real expressions: which may be joined, and what their product is measured in.

In: operators with their operands' typings. Out: the unit of the result, or BROKEN after a diagnostic. A unit of
None (a literal, a param without a unit) takes the unit of the other side; times alone are converted.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

from stlspec.compiler.advice import for_units
from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.model import Typing
from stlspec.lang.nodes import Expression, Group, Number, Prefix
from stlspec.lang.spelling import closest
from stlspec.lang.units import COMPOUNDS, KNOWN, NANOSECONDS, SPELLINGS, Dimension, spell
from stlspec.source import Span

Operand = tuple[Expression, Typing]
Unit = Dimension | Typing | None
"""A dimension, None for "any", or BROKEN."""


SAME = Fraction(1)
"""The factor between equal units."""
_HIGHEST_POWER = 4
"""Powers of time above this are compared, not converted: the factors would be no numbers that one can read."""
_WORD = re.compile(r"[A-Za-z_%][A-Za-z_0-9%]*")
_POWER = re.compile(r"([A-Za-z_%]+)([2-9])\Z")
"""A power as `m/s2` has it."""


def conversion(unit: Dimension | None, to: Dimension | None) -> Fraction | None:
    """Return the factor from `unit` to `to`: 1 if equal or open, a ratio between their times, None if there is none.

    `m/s/ms`, the rate of a speed sampled in ms, is 1000 times `m/s**2`: all but the times must be equal.
    """
    if unit is None or to is None or unit == to:
        return SAME
    one, other = _without_times(unit), _without_times(to)
    if one != other or abs(one[1]) > _HIGHEST_POWER:
        return None
    return _nanoseconds(unit) / _nanoseconds(to)


def scaled(value: float, factor: Fraction) -> float:
    """Return a constant in another unit, rounded once from the decimal that is written: 1.001 s is 1001 ms."""
    if factor == SAME or not math.isfinite(value):
        return value
    try:
        return float(Fraction(repr(float(value))) * factor)
    except OverflowError:
        return math.copysign(math.inf, value)


def _without_times(unit: Dimension) -> tuple[dict[str, int], int]:
    """Return what is left of a unit without its times, and the power of time in it."""
    rest = {word: power for word, power in unit.items() if word not in NANOSECONDS}
    return rest, sum(power for word, power in unit.items() if word in NANOSECONDS)


def _nanoseconds(unit: Dimension) -> Fraction:
    """Return how much of the unit in nanoseconds one of `unit` is, whatever else is in it."""
    product = Fraction(1)
    for word, power in unit.items():
        if word in NANOSECONDS:
            product *= Fraction(NANOSECONDS[word]) ** power
    return product


def _shown(unit: Dimension | None) -> str:
    return f"`{spell(unit)}`" if unit else "a plain number"


class Quantities:
    """The rules of units; `report(code, span, **fields)` receives what is wrong, `text(span)` is what stands there."""

    def __init__(self, report: Callable[..., Typing], text: Callable[[Span], str]) -> None:
        self._report, self._text = report, text
        self.known: set[str] = set(KNOWN)

    def meant(self, unit: str) -> str | None:
        """Return a unit with the words that nothing declares replaced by those that were meant; None if one is open."""
        if unit in COMPOUNDS:
            return COMPOUNDS[unit]
        words = {word: self._word(word) for word in _WORD.findall(unit)}
        return None if None in words.values() else _WORD.sub(lambda match: words[match[0]] or "", unit)

    def _word(self, word: str) -> str | None:
        if word in self.known:
            return word
        power = _POWER.match(word)
        if power is not None and power[1] in self.known:
            return f"{power[1]}**{power[2]}"
        return SPELLINGS.get(word) or closest(word, sorted(self.known))

    def value_in(self, typing: Typing, unit: Unit) -> float | None:
        """Return a constant's value in `unit`; None if it is not known."""
        if typing.value is None or isinstance(unit, Typing):
            return None
        return scaled(typing.value, conversion(typing.unit, unit) or SAME)

    def joined(self, operands: Sequence[Operand], verb: str) -> Unit:
        """Return the common unit of operands that are added or compared."""
        unit: Dimension | None = None
        first: Expression | None = None
        for node, typing in operands:
            if typing.unit is None:
                continue
            if unit is None:
                unit, first = typing.unit, node
            elif conversion(typing.unit, unit) is None:
                assert first is not None
                # A range's bound stands for both sides, the other being the signal.
                pair = len(operands) == 2 and first is not node
                way, edits = for_units((first, Typing("real", unit)), (node, typing), self._text, pair=pair)
                fields = {"left": _shown(unit), "right": _shown(typing.unit), "joined": verb, "help": way}
                return self._report("U301", node.span, edits=edits, **fields)
        return unit

    def of_operators(self, words: Sequence[str], operands: Sequence[Operand]) -> Unit:
        """Return the unit of a sum, a product or a power."""
        if words[0] in ("add", "sub"):
            return self.joined(operands, "added")
        if words[0] == "pow":
            return self._power(operands[0], operands[1])
        if all(typing.unit is None for _, typing in operands):
            return None
        unit: dict[str, int] = dict(operands[0][1].unit or {})
        for word, (_, typing) in zip(words, operands[1:], strict=True):
            for part, power in (typing.unit or {}).items():
                unit[part] = unit.get(part, 0) + (power if word == "mul" else -power)
        return {part: power for part, power in unit.items() if power}

    def _power(self, base: Operand, exponent: Operand) -> Unit:
        if exponent[1].unit:
            return self._plain(exponent, "an exponent")
        if not base[1].unit:
            return base[1].unit
        node = exponent[0]
        while isinstance(node, Group | Prefix):
            node = node.inner if isinstance(node, Group) else node.operand
        value = exponent[1].value
        if not isinstance(node, Number) or value is None or value != int(value):
            what = f"a value in {_shown(base[1].unit)} needs a whole number as exponent"
            way = "write the exponent as a whole number, or divide the base by its unit"
            return self._report("U306", exponent[0].span, what=what, help=way)
        return {part: power * int(value) for part, power in base[1].unit.items() if value}

    def _plain(self, operand: Operand, what: str) -> Typing:
        node, typing = operand
        return self._report(
            "U306",
            node.span,
            what=f"{what} is a plain number, but this is in {_shown(typing.unit)}",
            help="divide by the unit first, as in `x / 1 m`",
        )

    def of_call(self, name: str, arguments: Sequence[Operand], time: TimeBase) -> Unit:
        """Return the unit of a function of `arguments`."""
        unit = arguments[0][1].unit
        if name in ("min", "max", "hypot"):
            return self.joined(arguments, "compared" if name != "hypot" else "added")
        if name == "rate" and unit is not None and time.kind != "step":
            return self.of_operators(["div"], [arguments[0], (arguments[0][0], Typing("real", {time.unit: 1}))])
        if name in ("exp", "log", "sin", "cos"):
            angle = unit in ({"rad": 1},) and name in ("sin", "cos")
            return self._plain(arguments[0], f"the argument of `{name}`") if unit and not angle else None
        if name == "sqrt" and unit:
            return self._root(arguments[0], unit)
        return unit

    def _root(self, operand: Operand, unit: Mapping[str, int]) -> Unit:
        if any(power % 2 for power in unit.values()):
            what = f"the square root of a value in {_shown(unit)} has no unit"
            return self._report("U306", operand[0].span, what=what, help="divide by the unit first")
        return {part: power // 2 for part, power in unit.items()}
