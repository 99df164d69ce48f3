"""One generated function a monitor: from a sample to the values of all settled formulas.

In: the DAG. Out: lines of Python that read the signals, check them, compute expressions and predicates, and hand
the values to the objects that remember. A function of plain local variables costs a fraction of a walk over the
DAG, and shared nodes are computed once. Nothing of the spec's text gets into the lines: operators come from a
fixed table, names and numbers are bound as constants. All that can fail comes before anything is remembered.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NoReturn

import numpy as np

from stlspec.compiler.bundle import Signal
from stlspec.compiler.ir import COMPARISONS, REAL, Node
from stlspec.compiler.printing import expression_text, number_text
from stlspec.compiler.ranges import INF
from stlspec.semantics.online.past import Greatest, Since, Sliding
from stlspec.semantics.online.plan import Plan
from stlspec.semantics.online.samples import as_boolean, as_real, missing, outside, refuse
from stlspec.semantics.online.saving import Remembering, State, Unsound, numbers
from stlspec.semantics.robustness import TIE

_MAY_BE_NAN = frozenset({"add", "sub", "mul", "div", "pow", "sqrt", "log", "sin", "cos", "delta", "rate"})


class Memory(Remembering):
    """Numbers that are remembered from one sample to the next."""

    __slots__ = ("_count", "values")
    STATE: ClassVar[State] = {"values": numbers}

    def __init__(self, initial: Sequence[float]) -> None:
        self._count = len(initial)
        self.values = list(initial)

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if len(self.values) != self._count:
            raise Unsound("it remembers another number of values")


class Lines:
    """The body of a function: lines, the values bound to names in it, the objects that remember.

    parts: for each object how to make one. calls: what the lines call as `o<i>`: of which object, and what of it.
    """

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.bound: dict[str, Any] = {"INF": INF, "NINF": -INF, "TIE": TIE, "NTIE": -TIE}
        self.parts: list[Callable[[], Any]] = []
        self.calls: list[tuple[int, Callable[[Any], Any]]] = []
        self.initial: list[float] = []
        self._names = 0
        self._negated: dict[str, str] = {"INF": "NINF", "NINF": "INF"}

    def add(self, line: str) -> None:
        """Add a line."""
        self.lines.append(line)

    def bind(self, value: Any) -> str:
        """Bind a constant, return its name."""
        name = f"k{len(self.bound)}"
        self.bound[name] = value
        return name

    def number(self, value: float) -> str:
        """Name a number."""
        if math.isinf(value):
            return "INF" if value > 0 else "NINF"
        return self.bind(value)

    def let(self, expression: str) -> str:
        """Assign an expression to a new variable, return its name."""
        self._names += 1
        name = f"t{self._names}"
        self.add(f"{name} = {expression}")
        return name

    def keep(self, make: Callable[[], Any]) -> int:
        """Add an object that remembers, return its number."""
        self.parts.append(make)
        return len(self.parts) - 1

    def call(self, part: int, method: Callable[[Any], Any]) -> str:
        """Return the name of a method of an object."""
        self.calls.append((part, method))
        return f"o{len(self.calls) - 1}"

    def part(self, make: Callable[[], Any]) -> str:
        """Add an object that remembers, return the name of its `step`."""
        return self.call(self.keep(make), lambda part: part.step)

    def remember(self, initial: float) -> str:
        """Add a number that is remembered, return where it is."""
        self.initial.append(initial)
        return f"memory[{len(self.initial) - 1}]"

    def negated(self, name: str) -> str:
        """Name the negative of a variable."""
        if name not in self._negated:
            self._negated[name] = self.let(f"-{name}")
        return self._negated[name]

    def least(self, names: Sequence[str]) -> str:
        """Name the least of some variables."""
        return self._extremum(names, "<", "INF", "NINF")

    def greatest(self, names: Sequence[str]) -> str:
        """Name the greatest of some variables."""
        return self._extremum(names, ">", "NINF", "INF")

    def _extremum(self, names: Sequence[str], sign: str, neutral: str, absorbing: str) -> str:
        kept = [n for n in dict.fromkeys(names) if n != neutral]
        if absorbing in kept:
            return absorbing
        if not kept:
            return neutral
        result = kept[0]
        for other in kept[1:]:
            result = self.let(f"{result} if {result} {sign} {other} else {other}")
        return result


class Front:
    """Writes the lines that compute expressions and settled formulas; `value` names the variable of a node."""

    def __init__(self, plan: Plan, signals: Sequence[Signal], lines: Lines) -> None:
        self.plan, self.lines = plan, lines
        # The DAG as far down as formulas are computed sample by sample.
        self.nodes: Sequence[Node] = plan.nodes
        self._signals = {s.name: s for s in signals}
        self._named: dict[int, str] = {}
        self._formulas: dict[int, str] = {}
        self._kept: list[str] = []

    def write_samples(self) -> None:
        """Write what reads and checks a sample, and all expressions: everything that can be refused."""
        lines = self.lines
        lines.add("n = clock.n")
        self._read_time()
        self._read()
        lines.add("memory = store.values")
        for index, node in enumerate(self.plan.nodes):
            if node.op in REAL and index not in self._named and self._computed(index):
                self._named[index] = self._real(index, node)
        lines.add("clock.ticks = T; clock.n = n + 1" if self.plan.counted else "clock.take(T, time)")
        if self.plan.counted:
            lines.add("if time is not None:")
            lines.add("    clock.n = n; clock.take(T, time)")
        for line in self._kept:
            lines.add(line)

    def _read_time(self) -> None:
        """Write what takes the time of a sample, where samples may have one; else they are counted."""
        lines, base, declared = self.lines, self.plan.base, frozenset(self._signals)
        lines.add(f"T = n * {lines.bind(base.period or 1)}" if base.period else "T = n")
        lines.add("if time is not None or clock.stamped:")
        lines.add("    if time is None or not n:")
        lines.add(f"        time = clock.stamp_of(sample, time, {lines.bind(declared)})")
        lines.add("    clock.read(time)" if self.plan.counted else "    T = clock.read(time)")

    def _read(self) -> None:
        """Write what takes the values of signals out of a sample."""
        lines, nodes = self.lines, self.plan.nodes
        used = list(dict.fromkeys(str(n.value) for n in nodes if n.op in ("signal", "bool")))
        names = {name: f"s{i}" for i, name in enumerate(used)}
        if used:
            lines.add("try:")
            for name, variable in names.items():
                lines.add(f"    {variable} = sample[{lines.bind(name)}]")
            lines.add("except (KeyError, TypeError, IndexError, ValueError):")
            lines.add(f"    {lines.bind(missing)}(sample, {lines.bind(used)})")
        for name, variable in names.items():
            self._check(self._signals[name], variable)
        self._named |= {i: names[str(n.value)] for i, n in enumerate(nodes) if n.op in ("signal", "bool")}

    def _computed(self, _: int) -> bool:
        """Tell whether an expression is computed at every sample."""
        return True

    def _check(self, signal: Signal, variable: str) -> None:
        lines, name = self.lines, self.lines.bind(signal.name)
        if signal.type == "bool":
            lines.add(f"if {variable} is not True and {variable} is not False:")
            lines.add(f"    {variable} = {lines.bind(as_boolean)}({name}, {variable}, n, clock.now(time))")
            return
        lines.add(f"if type({variable}) is not float:")
        lines.add(f"    {variable} = {lines.bind(as_real)}({name}, {variable}, n)")
        if signal.low is None and signal.high is None:
            lines.add(f"if {variable} != {variable}:")
        else:
            low = lines.number(-INF if signal.low is None else signal.low)
            high = lines.number(INF if signal.high is None else signal.high)
            # NaN fails both comparisons.
            lines.add(f"if not {low} <= {variable} <= {high}:")
        lines.add(f"    {variable} = {lines.bind(outside)}({lines.bind(signal)}, {variable}, n, clock.now(time))")

    def _real(self, index: int, node: Node) -> str:
        lines = self.lines
        if node.op == "const":
            return lines.number(float(node.value or 0.0))
        operands = [self._named[c] for c in node.children]
        shown = operands
        if node.op == "now":
            return lines.let(f"float(T) / {lines.number(float(self.plan.base.ticks_per_unit))}")
        if node.op in ("delta", "rate"):
            before = lines.remember(0.0)
            self._kept.append(f"{before} = {operands[0]}")
            change = f"{operands[0]} - {before}"
            if node.op == "rate":
                change = f"({change}) / (float(T - clock.ticks) / {lines.number(float(self.plan.base.ticks_per_unit))})"
            result = lines.let(f"{change} if n else 0.0")
            shown = [operands[0], before]
        else:
            result = lines.let(self._arithmetic(node.op, operands))
        if node.op in _MAY_BE_NAN:
            fail = lines.bind(_failure(self.plan.nodes, index))
            lines.add(f"if {result} != {result}:")
            lines.add(f"    {fail}(n, {', '.join(shown)})")
        return result

    def _arithmetic(self, op: str, names: Sequence[str]) -> str:
        if op in ("add", "sub", "mul"):
            return {"add": " + ", "sub": " - ", "mul": " * "}[op].join(names)
        if op == "neg":
            return f"-{names[0]}"
        if op == "abs":
            return f"abs({names[0]})"
        if op in ("min", "max"):
            pick = self.lines.least if op == "min" else self.lines.greatest
            return f"{pick(names)} + 0.0"
        if op == "div":
            return f"{names[0]} / {names[1]} if {names[1]} else {self.lines.bind(_by_zero)}({names[0]}, {names[1]})"
        return f"{self.lines.bind(_scalar(op))}({', '.join(names)})"

    def value(self, index: int) -> str:
        """Write a settled formula and all under it, each once; return its variable."""
        for below in self._unwritten(index):
            self._formulas[below] = self._formula(below, self.nodes[below])
        return self._formulas[index]

    def _unwritten(self, index: int) -> list[int]:
        """Return the formulas that are still to be written for one, children first."""
        # A loop over the DAG, not a recursion: a chain of formulas may be long. It looks at what is missing only:
        # there may be thousands of requirements, each with its own formulas.
        found: set[int] = set()
        stack = [index]
        while stack:
            below = stack.pop()
            if below not in found and below not in self._formulas and self.nodes[below].op not in REAL:
                found.add(below)
                stack += self.nodes[below].children
        return sorted(found)

    def _formula(self, index: int, node: Node) -> str:
        lines, op = self.lines, node.op
        if op == "bool":
            return lines.let(f"INF if {self._named[index]} else NINF")
        if op in ("true", "false"):
            return "INF" if op == "true" else "NINF"
        if op in COMPARISONS:
            return self._comparison(op, *(self._named[c] for c in node.children))
        operands = [self._formulas[c] for c in node.children]
        if op == "not":
            return lines.negated(operands[0])
        if op in ("and", "or"):
            return lines.least(operands) if op == "and" else lines.greatest(operands)
        if op == "prev":
            before = lines.remember(-INF)
            result = lines.let(before)
            lines.add(f"{before} = {operands[0]}")
            return result
        assert node.interval is not None
        if node.interval == (0, None):
            return self._unbounded(op, operands)
        low, high = node.interval
        kind = {"historically": Sliding, "once": Greatest, "since": Since}[op]
        return lines.let(f"{lines.part(lambda: kind(low, high))}(T, {', '.join(operands)})")

    def _unbounded(self, op: str, operands: Sequence[str]) -> str:
        lines = self.lines
        kept = lines.remember(INF if op == "historically" else -INF)
        before = lines.let(kept)
        if op == "historically":
            result = lines.least([before, operands[0]])
        elif op == "once":
            result = lines.greatest([before, operands[0]])
        else:
            result = lines.greatest([operands[1], lines.least([operands[0], before])])
        lines.add(f"{kept} = {result}")
        return result

    def _comparison(self, op: str, left: str, right: str) -> str:
        if op in ("lt", "le"):
            left, right = right, left
        difference = f"{left} - {right}"
        if op in ("eq", "ne"):
            difference = f"{'-' if op == 'eq' else ''}abs({difference})"
        tie = "TIE" if op in ("ge", "le", "eq") else "NTIE"
        # Equal infinities are on the bound too; their difference is no number.
        return self.lines.let(f"{difference} if {left} != {right} else {tie}")


def _scalar(op: str) -> Callable[..., float]:
    """Return a function on floats that gives the very bits of the offline one, quietly."""
    if op == "sqrt":
        return lambda x: math.sqrt(x) if x >= 0 else math.nan
    function: Any = getattr(np, {"pow": "power"}.get(op, op))

    def quiet(*operands: float) -> float:
        with np.errstate(all="ignore"):
            return float(function(*operands))

    return quiet


def _by_zero(x: float, zero: float) -> float:
    return math.nan if x == 0 else math.copysign(INF, x) * math.copysign(1.0, zero)


def _failure(nodes: Sequence[Node], index: int) -> Callable[..., NoReturn]:
    """Return what refuses a sample at which an expression has no value."""

    def fail(sample: int, *values: float) -> NoReturn:
        shown: dict[str, None] = {}
        changed = nodes[index].op in ("delta", "rate")
        for child, value in zip(nodes[index].children, values, strict=False):
            if nodes[child].op != "const":
                text = f"{expression_text(nodes, child)} = {number_text(value)}"
                shown[f"{text} after {number_text(values[1])}" if changed else text] = None
        text = expression_text(nodes, index)
        refuse("D808", expression=text, sample=sample, operands=", ".join(shown) or "its operands are constants")

    return fail
