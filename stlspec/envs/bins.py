"""Bins: numbers for observations that are not numbers of states.

In: the bounds of every entry of an observation, and into how many bins to cut it. Out: `Bins`, which numbers
observations. What lies outside the bounds counts as the bin at the border: an environment may leave them a
little, and a policy must have an action everywhere.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

MOST_BINS = 1_000_000


@dataclass(frozen=True, slots=True)
class Bins:
    """A box cut into equal bins along each axis.

    low, high: (n_axes,), finite, low < high. counts: (n_axes,), >= 1; the last axis varies fastest. squashed:
    (n_axes,), or () = none: axes without bounds, on which x / (1 + |x|) is cut, between -1 and 1.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    counts: tuple[int, ...]
    squashed: tuple[bool, ...] = ()

    @property
    def size(self) -> int:
        """How many bins there are."""
        return math.prod(self.counts)

    def number(self, observation: Any) -> int:
        """Return the number of the bin that an observation lies in.

        Not in the paper: it says "discretize" only.

        Args:    observation: (n_axes,) numbers, or a number where there is one axis.
        Returns: from 0 to `size` - 1.
        Raises:  ValueError: it is of another shape, or not finite.
        """
        values = observation.tolist() if hasattr(observation, "tolist") else observation
        values = values if isinstance(values, list | tuple) else [values]
        if len(values) != len(self.counts) or not all(type(x) in (int, float) and math.isfinite(x) for x in values):
            raise ValueError(observation)
        return self.numberer()(values)

    def numberer(self) -> Callable[[Sequence[float]], int]:
        """Return a fast function from a list of finite numbers to the number of their bin."""
        axes = [
            (low, count / (high - low), count - 1)
            for low, high, count in zip(self.low, self.high, self.counts, strict=True)
        ]
        if any(self.squashed):
            cut = Bins(self.low, self.high, self.counts).numberer()
            which = self.squashed
            return lambda values: cut([x / (1 + abs(x)) if far else x for x, far in zip(values, which, strict=True)])
        if len(axes) == 2:
            (low0, scale0, last0), (low1, scale1, last1) = axes

            def pair(values: Sequence[float]) -> int:
                row, column = int((values[0] - low0) * scale0), int((values[1] - low1) * scale1)
                # int() rounds towards 0: what is below the bounds by less than a bin is in the first one already
                row = 0 if row < 0 else min(row, last0)
                return row * (last1 + 1) + (0 if column < 0 else min(column, last1))

            return pair

        def general(values: Sequence[float]) -> int:
            number = 0
            for value, (low, scale, last) in zip(values, axes, strict=True):
                place = int((value - low) * scale)
                number = number * (last + 1) + (0 if place < 0 else min(place, last))
            return number

        return general

    def text(self, *, ranges: bool = False) -> str:
        """Write the counts as `--bins` takes them, and where asked for, what is cut into them."""
        counts = ",".join(map(str, self.counts))
        ends = zip(self.low, self.high, strict=True)
        return counts + (" of " + " x ".join(f"[{low:g}, {high:g}]" for low, high in ends) if ranges else "")

    def to_json(self) -> dict[str, Any]:
        """Return the form that a policy file keeps."""
        squashed = {"squashed": list(self.squashed)} if any(self.squashed) else {}
        return {"low": list(self.low), "high": list(self.high), "counts": list(self.counts), **squashed}


def read_bins(document: Any) -> Bins:
    """Read what `Bins.to_json` wrote. Raises: ValueError: it is damaged."""
    low, high, counts = (tuple(document[key]) for key in ("low", "high", "counts"))
    numbers = all(type(x) in (int, float) and math.isfinite(x) for x in (*low, *high))
    whole = all(type(n) is int and 1 <= n <= MOST_BINS for n in counts)
    if not counts or not len(low) == len(high) == len(counts) or not numbers or not whole:
        raise ValueError("bins")
    if not all(a < b for a, b in zip(low, high, strict=True)) or math.prod(counts) > MOST_BINS:
        raise ValueError("bins")
    squashed = tuple(map(bool, document.get("squashed", ())))
    if len(squashed) not in (0, len(counts)):
        raise ValueError("bins")
    return Bins(tuple(map(float, low)), tuple(map(float, high)), counts, squashed)
