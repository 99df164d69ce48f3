"""The reading `every`: the exact value at each sample, in order, and enclosures of the others on demand.

In: a compiled spec. Out: a program whose function returns what a sample made known. The operators of `late` are
joined to a network along the DAG; shared sub-formulas are shared there too. Beside it a tape keeps the settled
values of the samples that are still open, from which their enclosures are computed when somebody asks.
"""

from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.horizon import horizons
from stlspec.compiler.ir import Node
from stlspec.errors import UsageError, diagnostic
from stlspec.semantics.evaluation import Verdict
from stlspec.semantics.online.arrays import enclosures, needed, stretch, three
from stlspec.semantics.online.front import Lines
from stlspec.semantics.online.late import (
    Late,
    LateBoolean,
    LateNext,
    LateNot,
    LatePast,
    LatePrev,
    LateSince,
    LateUntil,
    LateWindow,
    Sink,
)
from stlspec.semantics.online.past import Greatest, Since, Sliding
from stlspec.semantics.online.plan import DEEPEST, Plan
from stlspec.semantics.online.program import Program, compiled, make_front
from stlspec.semantics.online.saving import Remembering, State, Unsound, items, whole
from stlspec.semantics.online.states import States
from stlspec.semantics.online.tape import Tape, reach_back
from stlspec.semantics.robustness import TIE

Floats = NDArray[np.float64]


class Known(NamedTuple):
    """The exact value of a requirement at a sample; a tie is shown as 0. time: in the spec's unit."""

    sample: int
    time: float
    requirement: str
    robustness: float
    verdict: Verdict


class Network(Remembering):
    """All that the reading `every` remembers beside settled formulas.

    tape: settled values, and as its first column time stamps as given. counts: for each requirement the number
    of samples at which it is known.
    """

    __slots__ = (
        "_bundle",
        "_inputs",
        "_late",
        "_others",
        "_plan",
        "_reach",
        "_timed",
        "counts",
        "found",
        "sinks",
        "tape",
    )
    STATE: ClassVar[State] = {"counts": lambda value: [whole(x) for x in items(value)]}

    def __init__(self, bundle: BundleData, plan: Plan) -> None:
        self._bundle, self._plan = bundle, plan
        roots = [r.root for r in bundle.requirements]
        self._inputs, self._others = needed(plan, roots)
        reach = reach_back(plan, self._others, roots)
        self._reach = None if deferred(bundle, plan) else reach
        self.counts = [0] * len(roots)
        self._timed = plan.base.kind != "step"
        self.tape = Tape(len(self._inputs) + self._timed)
        self.found: list[Known] = []
        self._late: dict[int, Late] = {}
        self.sinks = self._connect()

    @property
    def inputs(self) -> tuple[int, ...]:
        """The settled formulas that are kept."""
        return self._inputs

    def _connect(self) -> dict[int, list[Sink]]:
        """Join the operators; return what takes the values of each settled formula."""
        sinks: dict[int, list[Sink]] = {}
        late = set(deferred(self._bundle, self._plan))
        bounded = [i for i, r in enumerate(self._bundle.requirements) if r.name not in late]
        _, others = needed(self._plan, [self._bundle.requirements[i].root for i in bounded])
        for index in others:
            node = self._plan.nodes[index]
            part = self._late[index] = _operator(node)
            for child, inlet in zip(node.children, part.inlets(), strict=True):
                sinks.setdefault(child, []).append(inlet)
        for i in bounded:
            sinks.setdefault(self._bundle.requirements[i].root, []).append(self._outlet(i))
        for index, part in self._late.items():
            part.sinks = sinks.pop(index, [])
        return sinks

    def _outlet(self, requirement: int) -> Sink:
        name, counts = self._bundle.requirements[requirement].name, self.counts
        per_unit = self._plan.base.ticks_per_unit
        new, tell, timed = tuple.__new__, self.found.append, self._timed
        satisfied, violated = Verdict.SATISFIED, Verdict.VIOLATED

        def take(time: int, value: float, _: int) -> None:
            sample = counts[requirement]
            counts[requirement] = sample + 1
            stamp = self._stamp(sample) if timed else time / per_unit
            # Ties are shown as 0.
            if value > TIE:
                tell(new(Known, (sample, stamp, name, value, satisfied)))
            else:
                visible = value if value < -TIE else 0.0
                tell(new(Known, (sample, stamp, name, visible, satisfied if value > 0 else violated)))

        return take

    def _stamp(self, sample: int) -> float:
        """Return the time of a sample as it was given."""
        stamps = self.tape.columns[-1]
        return stamps[min(sample - self.tape.base, len(stamps) - 1)]

    def trim(self) -> None:
        """Forget what no open sample looks at."""
        self.tape.drop(min(self.counts), self._reach)

    def open_samples(self, n: int) -> list[tuple[int, Floats]]:
        """Return for each requirement its first open sample, and columns low, high, current from there on."""
        base = self.tape.needed(min(*self.counts, n - 1), self._reach)
        times, columns = self.tape.arrays(base)
        found = enclosures(stretch(self._plan, times), self._inputs, self._others, columns[: len(self._inputs)])
        result = []
        for requirement, first in zip(self._bundle.requirements, self.counts, strict=True):
            values = three(found[requirement.root][first - base :]) if first < n else np.empty((0, 3))
            result.append((first, values))
        return result

    def stamps(self, first: int) -> Floats:
        """Return the times of the samples from number `first` on, (n_samples,)."""
        if not self._timed:
            return np.arange(first, self.tape.base + len(self.tape.times), dtype=np.float64)
        return np.frombuffer(self.tape.columns[-1], dtype=np.float64)[first - self.tape.base :].copy()

    def parts(self) -> list[Remembering]:
        """Return the objects that it consists of."""
        return [self.tape, *self._late.values()]

    def load(self, state: Any) -> None:
        """Take over a saved state."""
        held = self.counts
        super().load(state)
        # The outlets hold on to this very list.
        held[:], self.counts = self.counts, held

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        fits = self.tape.base + len(self.tape.times) == n and len(self.counts) == len(self._bundle.requirements)
        if not fits or not all(self.tape.base <= count <= n for count in self.counts):
            raise Unsound("the tape does not fit")


def _operator(node: Node) -> Late:
    """Return the late operator of a node."""
    op = node.op
    if op in ("not", "next", "prev"):
        return {"not": LateNot, "next": LateNext, "prev": LatePrev}[op]()
    if op in ("and", "or"):
        return LateBoolean(len(node.children), min if op == "and" else max)
    assert node.interval is not None
    low, high = node.interval
    if op in ("historically", "once"):
        return LatePast((Sliding if op == "historically" else Greatest)(low, high))
    if op == "since":
        return LateSince(Since(low, high))
    assert high is not None
    return LateUntil(low, high) if op == "until" else LateWindow(low, high, op == "eventually")


def deferred(bundle: BundleData, plan: Plan) -> tuple[str, ...]:
    """Return the names of the requirements whose values are known at the end only: they look ahead without end.

    Not in the paper: it evaluates complete traces only.
    """
    ahead = horizons(plan.nodes, plan.base)
    return tuple(r.name for r in bundle.requirements if ahead[r.root] is None)


def every_program(bundle: BundleData, plan: Plan, states: States | None = None) -> Program:
    """Write the program of the reading `every`."""
    lines = Lines()
    for requirement in bundle.requirements:
        if plan.depths[requirement.root] > DEEPEST:
            what = f"the reading `every` of '{requirement.name}', whose operators look ahead {DEEPEST} deep and more"
            raise UsageError([diagnostic("D880", what=what, help="use the reading `start`")])
    front = make_front(plan, bundle, states, lines)
    model = Network(bundle, plan)
    part = lines.keep(lambda: Network(bundle, plan))
    stamps = [] if plan.counted else ["clock.shown(T) if time is None else clock.stamp"]
    for slot, name in enumerate([*(front.value(i) for i in model.inputs), *stamps]):
        lines.add(f"{lines.call(part, _appender(slot))}({name})")
    lines.add(f"{lines.call(part, lambda network: network.tape.times.append)}(T)")
    for index, sinks in model.sinks.items():
        for slot in range(len(sinks)):
            lines.add(f"{lines.call(part, _inlet(index, slot))}(T, {front.value(index)}, T)")
    lines.add("if not n & 255:")
    lines.add(f"    {lines.call(part, lambda network: network.trim)}()")
    found = lines.call(part, lambda network: network.found)
    lines.add(f"known = {found}[:]")
    lines.add(f"{found}.clear()")
    lines.add("return known")
    return compiled(plan, lines, part)


def _appender(slot: int) -> Callable[[Network], Callable[[float], None]]:
    return lambda network: network.tape.columns[slot].append


def _inlet(index: int, slot: int) -> Callable[[Network], Sink]:
    return lambda network: network.sinks[index][slot]
