"""Relaxation: whether any values at given samples could flip a verdict.

In: a requirement's values on one trace. Out: for sets of samples yes or no, where no is a proof. A predicate at
a freed sample is given whatever truth value helps, each occurrence for itself, which is more than any values
of the signals can do; and freeing more samples never hurts, so samples are tested in halves, as groups.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import COMPARISONS, REAL, Node
from stlspec.semantics.chains import Values
from stlspec.semantics.robustness import evaluate_at
from stlspec.traces import Trace

Bools = NDArray[np.bool_]
Block = tuple[int, int]
"""Samples from the first up to the second, exclusive."""

_LARGEST_BATCH = 2**21
_LARGEST_TEST = 2**26


class Relaxation:
    """The requirement over freed truth values; `goal` is the verdict that would be the other one."""

    def __init__(self, found: Values, trace: Trace, ranges: Mapping[int, tuple[float, float]]) -> None:
        """Take `ranges`: what each predicate may be, by `value_ranges`; a tie is a bound that is not 0."""
        self.goal = not found.wanted > 0
        self.n_samples = trace.n_samples
        self._trace, self._at = trace, found.at
        self._memory = memory(found.nodes)
        used = signal_nodes(found.nodes)
        self._truth = {i: v > 0 for i, v in found.values.items() if _is_predicate(found.nodes[i])}
        # Whether a predicate may be false, and true, on some values of its signals.
        self._may = {i: (ranges[i][0] < 0, ranges[i][1] > 0) if i in ranges else (True, True) for i in self._truth}
        self._may |= {i: (False, False) for i in self._truth if not used[i]}
        self._nodes: list[Node] = []
        self._predicates: list[tuple[str, int, int]] = []
        self._root = self._copy(found)

    def _copy(self, found: Values) -> int:
        """Copy the formulas, once for each sign that they occur under, predicates as Boolean signals."""
        wanted = {(found.root, 1)}
        for index in sorted(found.values, reverse=True):
            node = found.nodes[index]
            for sign in (1, -1):
                if (index, sign) in wanted and index not in self._truth:
                    wanted.update((c, -sign if node.op == "not" else sign) for c in node.children)
        made: dict[tuple[int, int], int] = {}
        for index, sign in sorted(wanted):
            node = found.nodes[index]
            if index in self._truth:
                name = f"{index}{sign:+d}"
                self._predicates.append((name, index, sign))
                copy = Node("bool", value=name)
            else:
                below = -sign if node.op == "not" else sign
                copy = replace(node, children=tuple(made[c, below] for c in node.children))
            made[index, sign] = len(self._nodes)
            self._nodes.append(copy)
        return made[found.root, 1]

    def can_flip(self, blocks: Sequence[Block], *, outside: bool = False) -> list[bool]:
        """Test whether the verdict could be the other one if the samples of a block were free.

        Args:    blocks: one test each. outside: free all samples but those of the block.
        Returns: for each block; False is a proof, True is not.
        """
        per_batch = max(1, _LARGEST_BATCH // self.n_samples)
        answers: list[bool] = []
        for first in range(0, len(blocks), per_batch):
            answers += self._batch(blocks[first : first + per_batch], outside)
        return answers

    def _batch(self, blocks: Sequence[Block], outside: bool) -> list[bool]:
        free = {d: self._free(blocks, d, outside) for d in {self._memory[i] for _, i, _ in self._predicates}}
        signals = {}
        for name, index, sign in self._predicates:
            truth = np.broadcast_to(self._truth[index][:, None], (self.n_samples, len(blocks)))
            helpful = self.goal == (sign > 0)
            if self._may[index][helpful]:
                truth = np.where(free[self._memory[index]], helpful, truth)
            signals[name] = truth.astype(np.float64)
        batch = replace(self._trace, signals=signals, numbers=tuple(range(len(blocks))))
        (values,) = evaluate_at(self._nodes, [self._root], batch, self._at)
        return [bool(v > 0) == self.goal for v in values]

    def _free(self, blocks: Sequence[Block], depth: int, outside: bool) -> Bools:
        """Mark where a predicate that looks back over `depth` samples is free, (n_samples, n_blocks)."""
        n = self.n_samples
        freed = np.zeros((n, len(blocks)), dtype=np.bool_)
        for column, (first, end) in enumerate(blocks):
            freed[first:end, column] = True
        if outside:
            freed = ~freed
        free = freed.copy()
        for back in range(1, min(depth, n - 1) + 1):
            free[back:] |= freed[:-back]
        return free

    def single_samples(self, limit: int = 32) -> list[int] | None:
        """Find the samples that could flip the verdict alone: by halves, as long as there are few.

        Returns: the samples; [] is a proof that there is none; None if there may be more than `limit`.
        """
        level: list[Block] = [(0, self.n_samples)]
        singles: list[int] = []
        tested = 0
        while level:
            tested += len(level)
            if len(level) + len(singles) > limit or tested * self.n_samples > _LARGEST_TEST:
                return None
            onward: list[Block] = []
            for (first, end), possible in zip(level, self.can_flip(level), strict=True):
                if possible and end - first == 1:
                    singles.append(first)
                elif possible:
                    middle = (first + end) // 2
                    onward += [(first, middle), (middle, end)]
            level = onward
        return sorted(singles)

    def indispensable(self, samples: Sequence[int]) -> list[int] | None:
        """Find those of `samples` without which no change flips the verdict; None where that takes too long."""
        if len(samples) * self.n_samples > _LARGEST_TEST // 4:
            return None
        possible = self.can_flip([(k, k + 1) for k in samples], outside=True)
        return [k for k, can in zip(samples, possible, strict=True) if not can]


def memory(nodes: Sequence[Node]) -> list[int]:
    """Return how many samples back each real expression and predicate looks (`delta`, `rate`); 0 for formulas."""
    depth: list[int] = []
    for node in nodes:
        below = max((depth[c] for c in node.children), default=0)
        real = node.op in REAL or node.op in COMPARISONS
        depth.append(below + (node.op in ("delta", "rate")) if real else 0)
    return depth


def signal_nodes(nodes: Sequence[Node]) -> list[frozenset[str]]:
    """Return the signals that each node depends on."""
    used: list[frozenset[str]] = []
    for node in nodes:
        own = {str(node.value)} if node.op in ("signal", "bool") else set()
        used.append(frozenset(own).union(*(used[c] for c in node.children)))
    return used


def _is_predicate(node: Node) -> bool:
    return node.op in COMPARISONS or node.op == "bool"
