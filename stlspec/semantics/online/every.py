"""The reading `every`: the exact value at each sample, in order, and enclosures of the others on demand.

In: a compiled spec. Out: a program whose function returns what a sample made known. Where samples are counted its
operators are lines of that function (`flow`). Elsewhere gaps leave open how late a value is: there the operators of
`late` are joined to a network along the DAG. Beside it a tape keeps the settled values of the samples that are
still open, from which their enclosures are computed when somebody asks (`opening`).
"""

from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NamedTuple

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import Node
from stlspec.errors import UsageError, diagnostic
from stlspec.semantics.evaluation import Verdict
from stlspec.semantics.online.arrays import needed
from stlspec.semantics.online.counted import Counted
from stlspec.semantics.online.flow import Flow
from stlspec.semantics.online.front import Front, Lines
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
from stlspec.semantics.online.opening import Opening, deferred
from stlspec.semantics.online.past import Greatest, Since, Sliding
from stlspec.semantics.online.plan import DEEPEST, Plan
from stlspec.semantics.online.program import Program, compiled, make_front
from stlspec.semantics.online.saving import Remembering, State, items, whole
from stlspec.semantics.online.states import States
from stlspec.semantics.robustness import TIE


class Known(NamedTuple):
    """The exact value of a requirement at a sample; a tie is shown as 0. time: in the spec's unit."""

    sample: int
    time: float
    requirement: str
    robustness: float
    verdict: Verdict


class Network(Opening):
    """All that the reading `every` remembers beside settled formulas, where samples may come at any time.

    counts: for each requirement the number of samples at which it is known.
    """

    __slots__ = ("_late", "counts", "found", "sinks")
    STATE: ClassVar[State] = {"counts": lambda value: [whole(x) for x in items(value)]}

    def __init__(self, bundle: BundleData, plan: Plan) -> None:
        super().__init__(bundle, plan)
        self.counts = [0] * len(bundle.requirements)
        self.found: list[Known] = []
        self._late: dict[int, Late] = {}
        self.sinks = self._connect()

    def first_open(self, _: int) -> list[int]:
        """Return for each requirement the first sample at which it is not known."""
        return self.counts

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
        new, tell = tuple.__new__, self.found.append
        satisfied, violated = Verdict.SATISFIED, Verdict.VIOLATED

        def take(_: int, value: float, __: int) -> None:
            sample = counts[requirement]
            counts[requirement] = sample + 1
            stamp = self._stamp(sample)
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

    def parts(self) -> list[Remembering]:
        """Return the objects that it consists of."""
        return [*super().parts(), *self._late.values()]

    def load(self, state: Any) -> None:
        """Take over a saved state."""
        held = self.counts
        super().load(state)
        # The outlets hold on to this very list.
        held[:], self.counts = self.counts, held


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


def every_program(bundle: BundleData, plan: Plan, states: States | None = None) -> Program:
    """Write the program of the reading `every`."""
    lines = Lines()
    front = make_front(plan, bundle, states, lines)
    if plan.counted:
        return _counted_program(bundle, plan, front)
    for requirement in bundle.requirements:
        if plan.depths[requirement.root] > DEEPEST:
            what = f"the reading `every` of '{requirement.name}', whose operators look ahead {DEEPEST} deep and more"
            raise UsageError([diagnostic("D880", what=what, help="use the reading `start`")])
    model = Network(bundle, plan)
    part = lines.keep(lambda: Network(bundle, plan))
    lines.add(f"{lines.call(part, lambda network: network.tape.times.append)}(T)")
    _keep(front, part, model.inputs, ["clock.shown(T) if time is None else clock.stamp"])
    for index, sinks in model.sinks.items():
        for slot in range(len(sinks)):
            lines.add(f"{lines.call(part, _inlet(index, slot))}(T, {front.value(index)}, T)")
    found = lines.call(part, lambda network: network.found)
    lines.add(f"known = {found}[:]")
    lines.add(f"{found}.clear()")
    lines.add("return known")
    return compiled(plan, lines, part)


def _counted_program(bundle: BundleData, plan: Plan, front: Front) -> Program:
    lines, late = front.lines, set(deferred(bundle, plan))
    part = lines.keep(lambda: Counted(bundle, plan))
    inputs = Counted(bundle, plan).inputs
    _keep(front, part, inputs, [])
    taped = {front.value(index): lines.call(part, _column(slot)) for slot, index in enumerate(inputs)}
    bounded = [r for r in bundle.requirements if r.name not in late]
    roots = [r.root for r in bounded]
    names = {"KNOWN": Known, "new": tuple.__new__, "SAT": Verdict.SATISFIED, "VIO": Verdict.VIOLATED}
    lines.bound |= names
    name_of = [lines.bind(r.name) for r in bounded]
    per_unit = lines.bind(plan.base.ticks_per_unit)

    def tell(i: int, horizon: int, value: str) -> str:
        sample = f"n - {lines.bind(horizon)}" if horizon else "n"
        # Ties are shown as 0.
        shown = f"{value} if {value} > TIE or {value} < NTIE else 0.0"
        verdict = f"SAT if {value} > 0 else VIO"
        return f"new(KNOWN, (j := {sample}, j / {per_unit}, {name_of[i]}, {shown}, {verdict}))"

    Flow(plan, front, taped).write(needed(plan, roots)[1], roots, tell)
    return compiled(plan, lines, part)


def _keep(front: Front, part: int, inputs: Sequence[int], more: Sequence[str]) -> None:
    """Write what puts settled values on the tape."""
    lines = front.lines
    for slot, name in enumerate([*(front.value(i) for i in inputs), *more]):
        lines.add(f"{lines.call(part, _appender(slot))}({name})")
    lines.add("if not n & 255:")
    lines.add(f"    {lines.call(part, lambda opening: opening.trim)}(n + 1)")


def _column(slot: int) -> Callable[[Opening], Sequence[float]]:
    return lambda opening: opening.tape.columns[slot]


def _appender(slot: int) -> Callable[[Opening], Callable[[float], None]]:
    return lambda opening: opening.tape.columns[slot].append


def _inlet(index: int, slot: int) -> Callable[[Network], Sink]:
    return lambda network: network.sinks[index][slot]
