"""Medians and quartiles, where some runs never came to an end.

In: numbers, or None for what did not happen. Out: three quartiles; what did not happen counts as later than all.
"""

from collections.abc import Iterable, Sequence
from math import inf
from typing import NamedTuple

import numpy as np


class Spread(NamedTuple):
    """Quartiles of some numbers; inf = did not happen."""

    low: float
    median: float
    high: float

    def __str__(self) -> str:
        """Write median and quartiles: 12 (10 to 15)."""
        return f"{short(self.median)} ({short(self.low)} to {short(self.high)})"


def spread(values: Iterable[float | None]) -> Spread:
    """Return the quartiles; between two numbers the outer one, so that no average with inf is made.

    Not in the paper. The median of an even count is the lower of the two in the middle.

    Raises: ValueError: there are no values.
    """
    found = sorted(inf if value is None else float(value) for value in values)
    if not found:
        raise ValueError("no values")
    low, median = np.quantile(found, (0.25, 0.5), method="lower").tolist()
    return Spread(low, median, float(np.quantile(found, 0.75, method="higher")))


def ratios(above: Sequence[float | None], below: Sequence[float | None]) -> list[float]:
    """Return above / below seed by seed: how many times fewer the second needs.

    Returns: one for each pair in which at least one happened: inf or 0 where the other never did.
    """
    pairs = [(inf if a is None else a, inf if b is None else b) for a, b in zip(above, below, strict=True)]
    return [inf if a == inf else a / max(b, 1e-9) for a, b in pairs if not a == b == inf]


def short(value: float) -> str:
    """Write a number with three significant digits, whole ones from 1000 on with a space between thousands."""
    if value == inf:
        return "never"
    if abs(value) >= 999.5:
        return f"{value:,.0f}".replace(",", " ")
    return f"{value:.3g}"


def duration(seconds: float) -> str:
    """Write a time in seconds up to two minutes, in minutes from there on."""
    return f"{short(seconds)} s" if seconds < 120 else f"{short(seconds / 60)} minutes"
