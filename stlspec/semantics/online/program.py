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
from stlspec.semantics.online.plan import Ends, Plan, make_plan
from stlspec.semantics.online.roots import Roots
from stlspec.semantics.online.samples import Clock
from stlspec.semantics.online.saving import Remembering, Unsound, items


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
    """What all copies of a monitor share; network: which object is the network of the reading `every`."""

    plan: Plan
    build: Callable[..., Callable[..., Any]]
    initial: tuple[float, ...]
    makers: tuple[Callable[[], Any], ...]
    calls: tuple[tuple[int, Callable[[Any], Any]], ...]
    network: int

    def objects(self) -> Objects:
        """Return fresh memory."""
        clock = Clock(self.plan.base, gapless=self.plan.certain)
        return Objects(clock, Memory(self.initial), tuple(make() for make in self.makers))

    def bind(self, objects: Objects) -> Callable[..., Any]:
        """Return the function that takes a sample, working on this memory."""
        return self.build(objects.clock, objects.store, *(method(objects.parts[i]) for i, method in self.calls))


def start_program(bundle: BundleData, ends: Ends) -> Program:
    """Write the program of the reading `start`: the enclosures of all requirements at sample 0."""
    plan, lines = make_plan(bundle, ends), Lines()
    front = Front(plan, bundle.signals, lines)
    front.write_samples()
    roots = Roots(plan, front)
    found = {r.name: roots.enclosure(r.root) for r in bundle.requirements}
    lines.add(f"clock.last = ({', '.join(name for names in found.values() for name in names)},)")
    lines.add(f"return {{{', '.join(_standing(lines, name, *names) for name, names in found.items())}}}")
    return compiled(plan, lines)


def _standing(lines: Lines, name: str, low: str, high: str, current: str) -> str:
    bound = lines.bound
    bound |= {"new": tuple.__new__, "Standing": Standing}
    bound |= {"SAT": Verdict.SATISFIED, "VIO": Verdict.VIOLATED, "OPEN": Verdict.UNDECIDED}
    # `TIE` and `NTIE` stand for 0: what is shown of them.
    low_shown, high_shown, current_shown = (f"{v} if {v} > TIE or {v} < NTIE else 0.0" for v in (low, high, current))
    verdict = f"SAT if {low} > 0 else VIO if {high} < 0 else OPEN"
    return f"{lines.bind(name)}: new(Standing, ({low_shown}, {high_shown}, {current_shown}, {verdict}))"


def compiled(plan: Plan, lines: Lines, network: int = -1) -> Program:
    """Compile the lines to a function `step(sample, time)` over a clock, a store and the parts."""
    parts = "".join(f", o{i}" for i in range(len(lines.calls)))
    body = "".join(f"        {line}\n" for line in lines.lines)
    text = f"def build(clock, store{parts}):\n    def step(sample, time):\n{body}    return step\n"
    scope: dict[str, Any] = dict(lines.bound)
    exec(compile(text, "<monitor>", "exec"), scope)  # noqa: S102 - no word of it comes from the spec: see `front`
    return Program(plan, scope["build"], tuple(lines.initial), tuple(lines.parts), tuple(lines.calls), network)


def shown(value: float) -> float:
    """Return a value with a tie as the 0 that it stands for."""
    return 0.0 if -1e-323 < value < 1e-323 else value
