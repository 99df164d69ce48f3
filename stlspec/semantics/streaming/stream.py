"""The whole line: blocks of samples in, the values of all requirements at sample 0 out.

In: a compiled spec, then columns, some thousand samples at a time. Out: for each requirement an `Outcome`, which is
what `evaluate` says of the whole recording. Boolean operators at the top are computed at the end, from the parts
under them. What is kept are the samples that operands of parts still look at, and one value for each operator that
looks back without end; a requirement for which that is not enough is refused before the first sample.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import REAL
from stlspec.errors import DataError, Diagnostic, UsageError, diagnostic
from stlspec.semantics.evaluation import Verdict, Witness, check_length
from stlspec.semantics.reasons import CONSTANT, VACUOUS
from stlspec.semantics.robustness import needed_nodes, shown
from stlspec.semantics.streaming.parts import Part, part_of
from stlspec.semantics.streaming.pieces import Pieces
from stlspec.semantics.streaming.regions import unending_past, wanted_from
from stlspec.semantics.streaming.views import Finding, Past, View, reason

BLOCK = 2**16
"""Samples that are evaluated at a time."""
NUMBERS_AT_MOST = 2**25
"""Values that are kept at most: samples times nodes."""

_MIX = ("not", "and", "or")


@dataclass(frozen=True, slots=True)
class Outcome:
    """One requirement at sample 0; the fields are as in `RequirementResult`."""

    robustness: float
    verdict: Verdict
    vacuous: bool
    witness: Witness | None

    @property
    def reason(self) -> str:
        """Why the requirement has its value, in one line."""
        if self.witness is not None:
            return self.witness.reason
        return VACUOUS if self.vacuous else CONSTANT


class Stream:
    """Follows one recording. Use `take` for each block, then `finish`."""

    def __init__(self, bundle: BundleData, file: str | None = None, block: int = BLOCK) -> None:
        """Begin. Raises: UsageError D896: a requirement needs all samples."""
        problems = refusals(bundle)
        if problems:
            raise UsageError(problems)
        self._bundle, self._file, self._block = bundle, file, block
        self._nodes = bundle.nodes
        roots = [r.root for r in bundle.requirements]
        self._parts = {i: part_of(i, bundle.nodes[i]) for root in roots for i in _leaves(bundle, root)}
        self._real = [i for i in needed_nodes(bundle.nodes, roots) if bundle.nodes[i].op in REAL]
        self._pieces = Pieces(bundle, file)
        self._pasts: dict[int, Past] = {}

    def take(self, signals: Mapping[str, ArrayLike], time: ArrayLike | None, n: int) -> None:
        """Take the next samples.

        Not in the paper: scale.

        Args:   signals: for each signal that the formulas use (n,) values. time: (n,) stamps; None if there are never
                any. n: how many, >= 1.
        Raises: DataError D801 to D813: they cannot be used; D808: an expression has no value; D897: more samples
                than fit would have to be kept.
        """
        self._pieces.add(signals, time, n)
        waiting = self._pieces.waiting
        if waiting >= max(self._block, self._pieces.kept - waiting):
            self._advance(ended=False)

    def finish(self, end: str = "clip") -> dict[str, Outcome]:
        """Return what the requirements are worth, now that all samples have come.

        Args:   end: "clip", or "strict", which refuses a recording shorter than a horizon.
        Raises: DataError D803, D809: there were no samples, or not enough; else as `take`.
        """
        self._pieces.check_begun()
        view = self._advance(ended=True)
        if end == "strict":
            check_length(self._bundle, int(view.times[-1]), self._file)
        return {r.name: self._outcome(r.root) for r in self._bundle.requirements}

    def _advance(self, ended: bool) -> View:
        """Evaluate what has come, and let go of what is no longer looked at."""
        trace = self._pieces.joined()
        open_parts = [part for part in self._parts.values() if not part.closed]
        watched = [index for part in open_parts for index in part.watched]
        needed = needed_nodes(self._nodes, [*watched, *self._real])
        pasts = {index: past for index, past in self._pasts.items() if index in set(needed)}
        view = View(self._nodes, needed, trace, pasts, ended)
        for part in open_parts:
            part.take(view)
        if not ended:
            self._drop(view, [part for part in open_parts if not part.closed])
        return view

    def _drop(self, view: View, open_parts: list[Part]) -> None:
        wanted = dict.fromkeys(self._real, view.trace.n_samples)
        for part in open_parts:
            for index in part.watched:
                wanted[index] = min(wanted.get(index, view.trace.n_samples), max(0, part.done - view.first))
        found, remembering = wanted_from(self._nodes, wanted, view.times)
        count = max(0, min(found.values(), default=view.trace.n_samples) - 1)
        kept = view.trace.n_samples - count
        if kept * len(found) > NUMBERS_AT_MOST:
            raise DataError([diagnostic("D897", file=self._file, kept=f"{kept:,}", nodes=len(found))])
        # What lies before the first sample of a piece is remembered only once a piece begins later than that.
        if count == 0:
            return
        self._pasts = {index: self._remembered(view, index, until) for index, until in remembering.items()}
        self._pieces.drop(count)

    def _remembered(self, view: View, index: int, until: int) -> Past:
        """Extend what an operator remembers of its operand by the samples before `until`."""
        node, before = self._nodes[index], view.pasts.get(index)
        begin = 0 if before is None else before.until - view.first
        (child,) = node.children
        values = view.values[child][begin:until]
        if not len(values):
            assert before is not None
            return before
        extremum = float(values.max() if node.op == "once" else values.min())
        if before is not None and extremum != before.value and (extremum > before.value) == (node.op == "historically"):
            return Past(view.first + until, before.value, before.finding)
        same = before is not None and extremum == before.value
        if same and before is not None and view.decided_before(before.finding):
            return Past(view.first + until, extremum, before.finding)
        start = np.zeros(view.trace.n_samples, dtype=np.bool_)
        start[begin:until] = values == extremum
        finding = view.deciding(child, start, extremum)
        if same and before is not None:
            finding = before.finding.merged(finding)
        return Past(view.first + until, extremum, finding)

    def _outcome(self, root: int) -> Outcome:
        values: dict[int, float] = {}
        mix = _mix(self._bundle, root)
        for index in mix:
            node = self._nodes[index]
            if index in self._parts:
                values[index] = self._parts[index].value
            elif node.op == "not":
                values[index] = -values[node.children[0]]
            else:
                values[index] = (min if node.op == "and" else max)(values[c] for c in node.children)
        finding = self._deciding(root, mix, values)
        value, label = values[root], finding.label
        witness = None
        if label is not None:
            witness = Witness(label.sample, label.time, label.predicate, reason(self._bundle, label))
        vacuous = bool(np.isinf(value)) and label is None and finding.ran_out
        verdict = Verdict.SATISFIED if value > 0 else Verdict.VIOLATED
        return Outcome(float(shown(np.array([value]))[0]), verdict, vacuous, witness)

    def _deciding(self, root: int, mix: list[int], values: Mapping[int, float]) -> Finding:
        """Follow the value from the root to the parts that it comes from."""
        marked = {(root, 1.0)}
        finding = Finding()
        for index in reversed(mix):
            for sign in (1.0, -1.0):
                if (index, sign) not in marked or values[index] != sign * values[root]:
                    continue
                node = self._nodes[index]
                if index in self._parts:
                    finding = finding.merged(self._parts[index].finding.seen_from(sign))
                else:
                    below = -sign if node.op == "not" else sign
                    marked |= {(child, below) for child in node.children}
        return finding


def _mix(bundle: BundleData, root: int) -> list[int]:
    """Return the Boolean operators at the top of a formula and what they join, children first."""
    found, stack = set(), [root]
    while stack:
        index = stack.pop()
        if index in found:
            continue
        found.add(index)
        node = bundle.nodes[index]
        if node.op in _MIX:
            stack += node.children
    return sorted(found)


def _leaves(bundle: BundleData, root: int) -> list[int]:
    return [index for index in _mix(bundle, root) if bundle.nodes[index].op not in _MIX]


def refusals(bundle: BundleData) -> tuple[Diagnostic, ...]:
    """Return a diagnostic for each requirement that needs all samples to be kept.

    Not in the paper: scale. An operator without end that stands under another temporal operator has a value of its
    own at every sample, which may be decided as late as by the last one; `since` without end under an operator over
    all samples may be decided by any earlier one. Neither fits into a bounded number of values.
    """
    found = []
    for requirement in bundle.requirements:
        problem = next(filter(None, (_problem(bundle, leaf) for leaf in _leaves(bundle, requirement.root))), None)
        if problem is not None:
            found.append(diagnostic("D896", requirement=requirement.name, reason=problem))
    return tuple(found)


def _problem(bundle: BundleData, leaf: int) -> str | None:
    top = bundle.nodes[leaf]
    folded = top.op in ("always", "eventually", "until")
    for index in needed_nodes(bundle.nodes, top.children if folded else [leaf]):
        node = bundle.nodes[index]
        endless = node.interval is not None and node.interval[1] is None and not unending_past(node)
        if endless and (node.op != "since" or folded):
            way = "looks back over" if node.op == "since" else "waits for"
            above = top.op if index != leaf else "the requirement"
            return f"`{node.op}` without end under `{above}` {way} any number of samples"
    return None
