"""The open samples where samples are counted: which they are follows from their number.

In: a compiled spec. Out: `Counted`. Whoever asks for all enclosures at every sample is answered by a few passes over
the arrays of the last answer, where a requirement is one window (`suffixes`).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.horizon import horizons
from stlspec.semantics.online.arrays import Columns
from stlspec.semantics.online.opening import Opening
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.suffixes import Suffixes, make_suffixes

Floats = NDArray[np.float64]

_NOTHING = np.empty(0)


class Counted(Opening):
    """A requirement is known as late as its horizon; late: in samples, None without end.

    Suffixes and numbers are made anew where they are missing: they are not saved.
    """

    __slots__ = ("_from", "_late", "_numbers", "_slots", "_suffixes", "_times")

    def __init__(self, bundle: BundleData, plan: Plan) -> None:
        super().__init__(bundle, plan)
        roots = [r.root for r in bundle.requirements]
        ahead = horizons(plan.nodes, plan.base)
        self._late = [0 if plan.settled[root] else ahead[root] for root in roots]
        slots = {index: slot for slot, index in enumerate(self._inputs)}
        self._slots = [[slots[c] for c in plan.nodes[root].children if c in slots] for root in roots]
        self._forget()

    def _forget(self) -> None:
        self._suffixes: list[Suffixes | None] = [make_suffixes(self._plan, r.root) for r in self._bundle.requirements]
        self._from, self._numbers, self._times = 0, np.arange(0), _NOTHING

    def first_open(self, n: int) -> list[int]:
        """Return for each requirement the first of n samples at which it is not known."""
        return [0 if late is None else max(0, n - late) for late in self._late]

    def shown_samples(self, n: int) -> list[tuple[int, Columns]]:
        """Return for each requirement its first open sample, and low, high and current from there on, ties as 0."""
        columns, others = self.tape.columns, None
        found: list[tuple[int, Columns]] = []
        for i, first in enumerate(self.first_open(n)):
            suffixes = self._suffixes[i]
            if first >= n:
                found.append((first, (_NOTHING, _NOTHING, _NOTHING)))
            elif suffixes is not None:
                found.append((first, suffixes.columns([columns[slot] for slot in self._slots[i]], first, n)))
            else:
                others = super().shown_samples(n) if others is None else others
                found.append(others[i])
        return found

    def positions(self, first: int, n: int) -> tuple[NDArray[np.int64], Floats]:
        """Return numbers and times of the samples from `first` to before `n`; not to be written to."""
        if not self._from <= first <= n <= self._from + len(self._numbers):
            self._from = first
            self._numbers = np.arange(first, n + max(1000, n - first))
            self._times = self._numbers / self._plan.base.ticks_per_unit
            self._numbers.flags.writeable = self._times.flags.writeable = False
        row = slice(first - self._from, n - self._from)
        return self._numbers[row], self._times[row]

    def load(self, state: Any) -> None:
        """Take over a saved state."""
        super().load(state)
        self._forget()
