"""Monitors over finitely many states: what depends on the present state alone is a table over the states.

In: a compiled spec, and the values of its signals in every state. Out: `States`, tables that the offline engine
computes once, so that they have its bits, and `StateFront`, whose lines look up what `Front` would compute. A
sample is then the number of a state, and all that can be refused of its values has been refused before.
"""

import hashlib
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stlspec.compiler.bundle import BundleData, TimeBase
from stlspec.compiler.ir import TEMPORAL, Node
from stlspec.errors import UsageError, diagnostic
from stlspec.semantics.online.front import Front, Lines
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.samples import refuse
from stlspec.semantics.robustness import evaluate_nodes
from stlspec.traces import make_trace

_REMEMBERING = TEMPORAL | {"now", "delta", "rate"}
_CONSTANTS = frozenset({"const", "true", "false"})


@dataclass(frozen=True, slots=True, eq=False)
class States:
    """count: number of states. tables: by node (count,) values. present: nodes that depend on the state alone."""

    count: int
    tables: Mapping[int, list[float]]
    present: frozenset[int]

    def sha256(self) -> str:
        """Return a hash that tells states apart as far as the spec can."""
        found = hashlib.sha256(str(self.count).encode())
        for index, table in sorted(self.tables.items()):
            found.update(np.array([index, *table], dtype="<f8").tobytes())
        return found.hexdigest()


def make_states(bundle: BundleData, plan: Plan, states: Mapping[str, ArrayLike] | ArrayLike) -> States:
    """Tabulate what depends on the present state alone.

    Not in the paper: over finitely many states every predicate is a table.

    Args:    states: for each signal that a requirement uses (n_states,) values, or an array (n_states, n_signals)
             with a column for each signal of the spec, in its order.
    Raises:  DataError: a signal is missing, or has a value that no sample may have, or an expression has no value.
             UsageError D880: an array of another shape.
    """
    nodes = plan.nodes
    used = {str(node.value) for node in nodes if node.op in ("signal", "bool")}
    signals = states if isinstance(states, Mapping) else _columns(bundle, states)
    # What depends on the state alone knows no time, so any will do.
    base = TimeBase("step", "step", 1)
    trace = make_trace(base, bundle.signals, signals, required=used, file="the states")
    if trace.numbers is not None:
        _refuse_shape("a signal in `states` has not one number for each state", bundle)
    present = _present(nodes)
    others = {child for i, node in enumerate(nodes) if i not in present for child in node.children}
    wanted = sorted((others | {r.root for r in bundle.requirements}) & present)
    tables = {i: values.tolist() for i, values in zip(wanted, evaluate_nodes(nodes, wanted, trace), strict=True)}
    return States(trace.n_samples, tables, present)


def _present(nodes: Sequence[Node]) -> frozenset[int]:
    """Return the nodes that depend on the present sample alone, constants left out."""
    steady: set[int] = set()
    for index, node in enumerate(nodes):
        if node.op not in _REMEMBERING and all(child in steady for child in node.children):
            steady.add(index)
    return frozenset(i for i in steady if nodes[i].op not in _CONSTANTS)


def _columns(bundle: BundleData, states: ArrayLike) -> Mapping[str, Any]:
    array = np.asarray(states)
    if array.ndim != 2 or array.shape[1] != len(bundle.signals):
        _refuse_shape(f"`states` has the shape {array.shape}", bundle)
    return {signal.name: array[:, i] for i, signal in enumerate(bundle.signals)}


def _refuse_shape(what: str, bundle: BundleData) -> None:
    names = ", ".join(signal.name for signal in bundle.signals)
    help_text = f"give a mapping from signals to arrays (n_states,), or one array (n_states, n_signals) for {names}"
    raise UsageError([diagnostic("D880", what=what, help=help_text)])


class StateFront(Front):
    """Writes look-ups in place of the computation of what depends on the state alone."""

    def __init__(self, plan: Plan, states: States, lines: Lines) -> None:
        super().__init__(plan, (), lines)
        self._states = states
        self.nodes = [replace(n, children=()) if i in states.present else n for i, n in enumerate(plan.nodes)]

    def _read(self) -> None:
        lines, count = self.lines, self._states.count
        lines.add("s = sample")
        lines.add(f"if type(s) is not int or not 0 <= s < {lines.bind(count)}:")
        lines.add(f"    s = {lines.bind(number_of_state)}(s, {lines.bind(count)}, n)")

    def _computed(self, index: int) -> bool:
        return index not in self._states.present or index in self._states.tables

    def _real(self, index: int, node: Node) -> str:
        return self._looked_up(index) if index in self._states.tables else super()._real(index, node)

    def _formula(self, index: int, node: Node) -> str:
        return self._looked_up(index) if index in self._states.tables else super()._formula(index, node)

    def _looked_up(self, index: int) -> str:
        return self.lines.let(f"{self.lines.bind(self._states.tables[index])}[s]")


def number_of_state(state: Any, count: int, sample: int) -> int:
    """Return the number of a state.

    Not in the paper: an interface.

    Raises: DataError D895: it is none.
    """
    try:
        number = -1 if isinstance(state, bool | np.bool_) else operator.index(state)
    except TypeError:
        number = -1
    if not 0 <= number < count:
        shown = repr(state)
        refuse("D895", sample=sample, state=shown if len(shown) <= 30 else f"{shown[:29]}…", last=count - 1)
    return number
