"""Units: the words that the language knows, and what a compound such as `m/s**2` is made of.

In: a unit as text. Out: its dimension as a mapping from word to exponent. Only time units are ever converted,
and others only suggested (`SCALES`);
other words are compared as they stand, so any word may be declared for a signal.
"""

import re
from collections.abc import Mapping
from fractions import Fraction

NANOSECONDS = {
    "ns": 1,
    "us": 1_000,
    "ms": 1_000_000,
    "s": 1_000_000_000,
    "min": 60_000_000_000,
    "h": 3_600_000_000_000,
}
"""Ticks in one of each time unit."""

SCALES = {
    **{time: ("s", Fraction(ticks, 1_000_000_000)) for time, ticks in NANOSECONDS.items()},
    **{
        word: (base, Fraction(factor))
        for base, words in {
            "m": "km 1000,cm 0.01,mm 0.001,um 0.000001,nm 0.000000001,inch 0.0254,ft 0.3048,mi 1609.344",
            "g": "kg 1000,t 1000000",
            "V": "mV 0.001",
            "A": "mA 0.001",
            "W": "kW 1000",
            "J": "kJ 1000",
            "Hz": "kHz 1000,MHz 1000000",
            "Pa": "kPa 1000,bar 100000",
            "byte": "bit 0.125",
            "rev": "deg 1/360",
        }.items()
        for word, factor in (pair.split() for pair in words.split(","))
    },
}
"""Units that are multiples of one another: the common one, and how much of it one of each is. For suggestions only."""

STEP = "step"
KNOWN = frozenset(
    (
        "m mm cm km um nm inch ft mi rad deg rev g kg t N Nm V mV A mA Ah W kW Wh J kJ Hz kHz MHz "
        "rpm K degC Pa kPa bar L mol cd lx dB percent px bit byte"
    ).split()
) | {*NANOSECONDS, STEP}
SPELLINGS = {
    "sec": "s",
    "secs": "s",
    "second": "s",
    "seconds": "s",
    "msec": "ms",
    "usec": "us",
    "minute": "min",
    "minutes": "min",
    "mins": "min",
    "hour": "h",
    "hours": "h",
    "hr": "h",
    "steps": "step",
    "meter": "m",
    "meters": "m",
    "metre": "m",
    "metres": "m",
}
"""What people write for a unit, and the word that the language has for it."""
COMPOUNDS = {"mps": "m/s", "kph": "km/h", "kmh": "km/h", "kmph": "km/h", "mph": "mi/h"}
"""Words that people write for a unit of several."""
_WRITTEN = {
    "^": "**", "²": "**2", "³": "**3", "⁻¹": "**-1", "·": "*", "×": "*", "°C": "degC", "°": "deg", "µ": "u", "μ": "u",
    "%": "percent",
}  # fmt: skip
"""Signs of units that people write, and what the language has for them."""
_PART = re.compile(r"(?P<sign>[*/])?(?P<word>[A-Za-z_%][A-Za-z_0-9%]*|1)(?:\*\*(?P<power>-?[0-9]{1,3}))?")

Dimension = Mapping[str, int]


def is_unit_word(word: str) -> bool:
    """Tell whether `word` is a unit that the language knows by itself."""
    return word in KNOWN


def dimension(unit: str) -> dict[str, int] | None:
    """Return the exponents of `unit`'s words, `m/s**2` as {m: 1, s: -2}; None if it cannot be read."""
    exponents: dict[str, int] = {}
    at = 0
    unit = unit.strip()
    while at < len(unit):
        part = _PART.match(unit, at)
        if part is None or (part["sign"] is None) != (at == 0):
            return None
        power = int(part["power"] or 1)
        if part["word"] != "1":
            word = "percent" if part["word"] == "%" else part["word"]
            exponents[word] = exponents.get(word, 0) + (-power if part["sign"] == "/" else power)
        at = part.end()
    return {word: power for word, power in exponents.items() if power}


def respelt(unit: str) -> str | None:
    """Return a unit as the language writes it: `m^2` as `m**2`, `N m` as `N*m`; None if it cannot be read.

    Not in the paper: the language.
    """
    for sign, written in _WRITTEN.items():
        unit = unit.replace(sign, written)
    unit = re.sub(r"\s*(/|\*+)\s*", r"\1", unit.strip().removeprefix("[").removesuffix("]").strip())
    unit = re.sub(r"\s+", "*", unit)
    return unit if dimension(unit) is not None else None


def spell(exponents: Dimension) -> str:
    """Write a dimension the way a user would: {m: 1, s: -2} as `m/s**2`; none as the empty text."""
    above = [_power(w, p) for w, p in exponents.items() if p > 0]
    below = [_power(w, -p) for w, p in exponents.items() if p < 0]
    text = "*".join(above) or ("1" if below else "")
    return text + "".join(f"/{part}" for part in below)


def _power(word: str, power: int) -> str:
    return word if power == 1 else f"{word}**{power}"
