"""Flips: the least change of a trace that turns a verdict round.

In: a requirement's values on one trace, and its chain. Out: a `Flip`. Nothing is claimed unproven: a change is
written into the trace and the requirement evaluated again, and that no single sample suffices is shown by
`relaxation`, which frees samples altogether.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.bundle import BundleData, Signal
from stlspec.compiler.ir import COMPARISONS, Node
from stlspec.compiler.ranges import value_ranges
from stlspec.errors import DataError
from stlspec.semantics.chains import Link, Values, bearing_samples
from stlspec.semantics.changes import Change, direction, flipping_changes
from stlspec.semantics.relaxation import Relaxation, memory, signal_nodes
from stlspec.semantics.robustness import evaluate_nodes
from stlspec.traces import Trace

Kind = Literal["single", "sample", "several", "impossible", "unknown"]

_MOST_TRIALS = 64
_MOST_WORK = 2**26
_MOST_SINGLES = 16
_MOST_TOGETHER = 256


@dataclass(frozen=True, slots=True)
class Flip:
    """What would turn a verdict round.

    kind: "single": one sample of one signal, `changes` has it; "sample": one sample of two signals, likewise;
    "several": no change of one sample suffices; "impossible": no values of the signals do, on these times;
    "unknown": nothing was found, nothing proven.
    least: the least number of samples that must change; None where it is not known.
    changes: each was made, all at once, and the verdict turned.
    """

    kind: Kind
    least: int | None = None
    changes: tuple[Change, ...] = ()


def find_flip(bundle: BundleData, found: Values, chain: Sequence[Link], trace: Trace) -> Flip:
    """Find what would turn the verdict of a requirement round.

    Not in the paper: it says what a demonstration should have done.

    Args:    bundle: its declared ranges are kept to. found: the values. chain: from the root to
             the deciding predicate. trace: one trace.
    Returns: the flip; of single changes the smallest at the witness sample, else the one nearest to it.
    """
    search = _Search({s.name: s for s in bundle.signals}, found, trace)
    last = chain[-1]
    decided = _is_predicate(found.nodes[last.index])
    if decided:
        change = search.at_sample(last.sample, search.uses[last.index])
        if change is not None:
            return Flip("single", 1, (change,))
    relaxation = Relaxation(found, trace, value_ranges(found.nodes, bundle.signals, bundle.time))
    if not relaxation.can_flip([(0, trace.n_samples)])[0]:
        return Flip("impossible")
    singles = relaxation.single_samples()
    near = sorted(singles if singles is not None else [last.sample], key=lambda k: abs(k - last.sample))
    for sample in near[:_MOST_SINGLES]:
        change = search.at_sample(sample, frozenset(search.declared))
        if change is not None:
            return Flip("single", 1, (change,))
    for sample in near[:_MOST_SINGLES]:
        pair = search.pair_at_sample(sample)
        if pair:
            return Flip("sample", 1, pair)
    if singles != [] or not decided:
        return Flip("unknown")
    samples = np.flatnonzero(bearing_samples(found, chain, fewest=True)).tolist()
    return search.together(relaxation, samples, last.index)


def _is_predicate(node: Node) -> bool:
    return node.op in COMPARISONS or node.op == "bool"


class _Search:
    """Tries changes on the trace; gives up after a bounded amount of work."""

    def __init__(self, declared: Mapping[str, Signal], found: Values, trace: Trace) -> None:
        self.found, self.trace = found, trace
        self.uses = signal_nodes(found.nodes)
        self.declared = {name: s for name, s in declared.items() if name in self.uses[found.root]}
        self._memory = memory(found.nodes)
        self._ways = {name: direction(found.nodes, found.root, name) for name in self.declared}
        self._trials = min(_MOST_TRIALS, max(8, _MOST_WORK // (trace.n_samples * len(found.values))))

    def at_sample(self, sample: int, names: frozenset[str]) -> Change | None:
        """Return the smallest change of one of some signals at a sample that turns the verdict, if there is one.

        The verdict depends on nothing but the truth of predicates, so the values to try are those at which one
        of them changes.
        """
        for change in sorted(self._at(sample, names), key=_size):
            if self._turns([change]):
                return self._finished(change)
        return None

    def pair_at_sample(self, sample: int) -> tuple[Change, ...]:
        """Return the smallest changes of two signals at a sample that turn the verdict together; () if none do."""
        changes = self._at(sample, frozenset(self.declared))
        pairs = (pair for pair in combinations(changes, 2) if pair[0].signal != pair[1].signal)
        for pair in sorted(pairs, key=lambda p: _size(p[0]) + _size(p[1])):
            if self._turns(pair):
                return tuple(self._finished(change) for change in pair)
        return ()

    def _at(self, sample: int, names: frozenset[str]) -> list[Change]:
        """Return the changes of a sample that turn some predicate round, each once."""
        found = {(c.signal, c.value): c for name in sorted(names) for c in self._of_signal(sample, name)}
        return list(found.values())

    def _of_signal(self, sample: int, name: str) -> list[Change]:
        signal = self.declared[name]
        found: list[Change] = []
        for index in self.found.values:
            node = self.found.nodes[index]
            if name not in self.uses[index] or not _is_predicate(node):
                continue
            last = min(sample + self._memory[index], self.trace.n_samples - 1)
            for at in range(sample, last + 1):
                found += flipping_changes(self.found.nodes, index, self.trace, at, signal, sample)
                if len(found) > _MOST_TRIALS:
                    return found
        return found

    def _finished(self, change: Change) -> Change:
        """Say whether values farther off do as well, because the signal works one way only."""
        way = self._ways[change.signal]
        wanted = -1 if self.found.wanted > 0 else 1
        beyond = way is not None and way * wanted == (1 if change.value > change.before else -1)
        return replace(change, beyond=beyond)

    def _turns(self, changes: Sequence[Change]) -> bool:
        """Evaluate the requirement with changes made; an expression without a value turns nothing."""
        if self._trials <= 0:
            return False
        self._trials -= 1
        columns: dict[str, NDArray[np.float64]] = {}
        for change in changes:
            if change.signal not in columns:
                columns[change.signal] = self.trace.signals[change.signal].copy()
            columns[change.signal][change.sample] = change.value
        changed = replace(self.trace, signals={**self.trace.signals, **columns})
        try:
            (values,) = evaluate_nodes(self.found.nodes, [self.found.root], changed)
        except DataError:
            return False
        return bool(values[self.found.at] > 0) != (self.found.wanted > 0)

    def together(self, relaxation: Relaxation, samples: list[int], predicate: int) -> Flip:
        """Change the deciding predicate wherever it bears out the verdict; count what cannot be left out."""
        if len(samples) > _MOST_TOGETHER:
            return Flip("several")
        needed = relaxation.indispensable(samples)
        self._trials = max(self._trials, 1)
        changes = self._one_each(samples, predicate)
        if not changes or not self._turns(changes):
            return Flip("several")
        exact = needed is not None and len(needed) == len(samples)
        return Flip("several", len(samples) if exact else None, tuple(self._finished(c) for c in changes))

    def _one_each(self, samples: Sequence[int], predicate: int) -> list[Change]:
        """Return a change of the same signal at every sample, the smallest in all; [] if there is none."""
        best: list[Change] = []
        size = math.inf
        for name in sorted(self.uses[predicate]):
            changes = []
            for sample in samples:
                found = flipping_changes(self.found.nodes, predicate, self.trace, sample, self.declared[name], sample)
                changes += sorted(found, key=_size)[:1]
            total = sum(_size(c) for c in changes)
            if len(changes) == len(samples) and (not best or total < size):
                best, size = changes, total
        return best


def _size(change: Change) -> float:
    return abs(change.value - change.before)
