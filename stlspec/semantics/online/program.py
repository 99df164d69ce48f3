"""A monitor's program: the generated function and the objects that remember, made once for all copies.

In: a compiled spec. Out: `Program`, which makes fresh sets of objects and binds the function to them. The
function is compiled from the lines that `front` and `roots` write; see there for what may stand in them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from stlspec.compiler.bundle import BundleData
from stlspec.semantics.evaluation import Verdict
from stlspec.semantics.online.front import Front, Lines, Memory
from stlspec.semantics.online.plan import Ends, Plan
from stlspec.semantics.online.roots import Roots
from stlspec.semantics.online.samples import Clock
from stlspec.semantics.online.saving import Remembering, Unsound, items
from stlspec.semantics.online.states import StateFront, States


class Standing(NamedTuple):
    """What is known of a requirement at sample 0; ties are shown as 0.

    low, high: enclose its robustness over every way the trace can go on. current: its robustness if the trace
    ended here. verdict: undecided as long as it can change.
    """

    low: float
    high: float
    current: float
    verdict: Verdict


@dataclass(frozen=True, slots=True, eq=False)
class Objects:
    """One monitor's memory."""

    clock: Clock
    store: Memory
    parts: tuple[Any, ...]

    def save(self) -> list[Any]:
        """Return the state as JSON values."""
        return [part.save() for part in self._all()]

    def load(self, state: Any) -> None:
        """Take over a saved state. Raises: Unsound: it is of another monitor, or damaged."""
        everything = self._all()
        if len(items(state)) != len(everything):
            raise Unsound("it has another number of parts")
        for part, saved in zip(everything, state, strict=True):
            part.load(saved)
        for part in everything:
            part.check(self.clock.n, self.clock.ticks)

    def _all(self) -> Sequence[Remembering]:
        return (self.clock, self.store, *self.parts)


@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """What all copies of a monitor share.

    opening: which object has the open samples of the reading `every`, -1 with the reading `start`. ends: what was
    promised of the end. states: what samples are numbers of, if they are.
    """

    plan: Plan
    build: Callable[..., Callable[..., Any]]
    initial: tuple[float, ...]
    makers: tuple[Callable[[], Any], ...]
    calls: tuple[tuple[int, Callable[[Any], Any]], ...]
    opening: int
    ends: Ends = "any"
    states: States | None = None

    def objects(self) -> Objects:
        """Return fresh memory."""
        clock = Clock(self.plan.base, gapless=self.plan.certain)
        return Objects(clock, Memory(self.initial), tuple(make() for make in self.makers))

    def bind(self, objects: Objects) -> Callable[..., Any]:
        """Return the function that takes a sample, working on this memory."""
        return self.build(objects.clock, objects.store, *(method(objects.parts[i]) for i, method in self.calls))


def make_front(plan: Plan, bundle: BundleData, states: States | None, lines: Lines) -> Front:
    """Return a front whose lines for samples are written; states: what samples are numbers of."""
    front = Front(plan, bundle.signals, lines) if states is None else StateFront(plan, states, lines)
    front.write_samples()
    return front


def start_program(bundle: BundleData, plan: Plan, states: States | None = None) -> Program:
    """Write the program of the reading `start`: the enclosures of all requirements at sample 0."""
    lines = Lines()
    front = make_front(plan, bundle, states, lines)
    roots = Roots(plan, front)
    found = {r.name: roots.enclosure(r.root) for r in bundle.requirements}
    # Most samples change nothing: what was told is told again.
    lines.add(f"last = ({', '.join(name for names in found.values() for name in names)},)")
    lines.add("if last != clock.last:")
    lines.add("    clock.last = last")
    lines.add(f"    clock.told = ({', '.join(_standing(lines, *names) for names in found.values())},)")
    told = [f"r{i}" for i in range(len(found))]
    lines.add(f"{', '.join(told)}, = clock.told")
    lines.add(f"return {{{', '.join(f'{lines.bind(name)}: {r}' for name, r in zip(found, told, strict=True))}}}")
    return compiled(plan, lines)


def _standing(lines: Lines, low: str, high: str, current: str) -> str:
    bound = lines.bound
    bound |= {"new": tuple.__new__, "Standing": Standing}
    bound |= {"SAT": Verdict.SATISFIED, "VIO": Verdict.VIOLATED, "OPEN": Verdict.UNDECIDED}
    # `TIE` and `NTIE` stand for 0: what is shown of them.
    low_shown, high_shown, current_shown = (f"{v} if {v} > TIE or {v} < NTIE else 0.0" for v in (low, high, current))
    verdict = f"SAT if {low} > 0 else VIO if {high} < 0 else OPEN"
    return f"new(Standing, ({low_shown}, {high_shown}, {current_shown}, {verdict}))"


def compiled(plan: Plan, lines: Lines, opening: int = -1) -> Program:
    """Compile the lines to a function `update(sample, time=None)` over a clock, a store and the parts."""
    parts = "".join(f", o{i}" for i in range(len(lines.calls)))
    body = "".join(f"        {line}\n" for line in lines.lines)
    text = f"def build(clock, store{parts}):\n    def update(sample, time=None):\n{body}    return update\n"
    scope: dict[str, Any] = dict(lines.bound)
    exec(compile(text, "<monitor>", "exec"), scope)  # noqa: S102 - no word of it comes from the spec: see `front`
    return Program(plan, scope["build"], tuple(lines.initial), tuple(lines.parts), tuple(lines.calls), opening)


def shown(value: float) -> float:
    """Return a value with a tie as the 0 that it stands for."""
    return 0.0 if -1e-323 < value < 1e-323 else value
