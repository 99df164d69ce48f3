"""The samples at which a requirement is not known yet, with the reading `every`: their enclosures, on demand.

In: the settled values of the samples that are still open, kept on a tape. Out: low, high and current value at each
of them. Nothing is computed before somebody asks.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.horizon import horizons
from stlspec.semantics.online.arrays import Columns, enclosures, needed, stretch
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.saving import Remembering, Unsound
from stlspec.semantics.online.tape import CountedTape, Tape, reach_back
from stlspec.semantics.robustness import shown

Floats = NDArray[np.float64]


def deferred(bundle: BundleData, plan: Plan) -> tuple[str, ...]:
    """Return the names of the requirements whose values are known at the end only: they look ahead without end.

    Not in the paper: it evaluates complete traces only.
    """
    ahead = horizons(plan.nodes, plan.base)
    return tuple(r.name for r in bundle.requirements if ahead[r.root] is None)


class Opening(Remembering):
    """The open samples. tape: settled values, and as its last column time stamps as given, where there are any."""

    __slots__ = ("_bundle", "_inputs", "_others", "_plan", "_reach", "_timed", "tape")

    def __init__(self, bundle: BundleData, plan: Plan) -> None:
        self._bundle, self._plan = bundle, plan
        roots = [r.root for r in bundle.requirements]
        self._inputs, self._others = needed(plan, roots)
        self._reach = None if deferred(bundle, plan) else reach_back(plan, self._others, roots)
        self._timed = not plan.counted
        width = len(self._inputs) + self._timed
        self.tape: Tape | CountedTape = Tape(width) if self._timed else CountedTape(width)

    @property
    def inputs(self) -> tuple[int, ...]:
        """The settled formulas that are kept."""
        return self._inputs

    def first_open(self, _: int) -> Sequence[int]:
        """Return for each requirement the first sample, of so many, at which it is not known."""
        raise NotImplementedError

    def trim(self, n: int) -> None:
        """Forget what no open sample looks at."""
        self.tape.drop(min(self.first_open(n)), self._reach)

    def open_samples(self, n: int) -> list[tuple[int, Columns]]:
        """Return for each requirement its first open sample, and low, high and current from there on."""
        firsts = self.first_open(n)
        base = self.tape.needed(min(*firsts, n - 1), self._reach)
        times, columns = self.tape.arrays(base)
        found = enclosures(stretch(self._plan, times), self._inputs, self._others, columns[: len(self._inputs)])
        result = []
        for requirement, first in zip(self._bundle.requirements, firsts, strict=True):
            low, high, current = (column[first - base :] for column in found[requirement.root])
            result.append((first, (low, high, current)))
        return result

    def shown_samples(self, n: int) -> list[tuple[int, Columns]]:
        """Return the same, ties as 0."""
        result = []
        for first, (low, high, current) in self.open_samples(n):
            result.append((first, (shown(low), shown(high), shown(current))))
        return result

    def positions(self, first: int, n: int) -> tuple[NDArray[np.int64], Floats]:
        """Return numbers and times of the samples from `first` to before `n`, times as given if they were given."""
        stamps = np.frombuffer(self.tape.columns[-1], dtype=np.float64)
        return np.arange(first, n), stamps[first - self.tape.base :][: n - first].copy()

    def parts(self) -> list[Remembering]:
        """Return the objects that it consists of."""
        return [self.tape]

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        firsts = self.first_open(n)
        fits = self.tape.base + len(self.tape) == n and len(firsts) == len(self._bundle.requirements)
        if not fits or not all(self.tape.base <= first <= n for first in firsts):
            raise Unsound("the tape does not fit")
