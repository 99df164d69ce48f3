"""The structure of a bundle read from outside: typed access to JSON, and the rules that a formula DAG obeys.

In: untrusted values. Out: values of the right type, or `Malformed` with what is wrong. After `check_nodes` every
later stage may rely on children coming first, on arities, on reals and formulas in their places.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from stlspec.compiler.bundle import Requirement, Signal, TimeBase
from stlspec.compiler.ir import BOUNDED, COMPARISONS, LOGIC, OPERATORS, REAL, Node
from stlspec.lang.units import NANOSECONDS, STEP

_LARGEST_TICK = 2**62
_NAME = re.compile(r"[A-Za-z_][A-Za-z_0-9]*\Z")
_ARITY = {
    **dict.fromkeys(["const", "signal", "now", "true", "false", "bool"], (0, 0)),
    **dict.fromkeys(("neg abs sqrt exp log sin cos delta rate not next prev").split(), (1, 1)),
    **dict.fromkeys(["always", "eventually", "historically", "once"], (1, 1)),
    **dict.fromkeys(["sub", "div", "pow", "hypot", "until", "since"], (2, 2)),
    **dict.fromkeys(COMPARISONS, (2, 2)),
    **dict.fromkeys(["add", "mul", "min", "max", "and", "or"], (2, None)),
}


class Malformed(Exception):  # noqa: N818 - never leaves the package: it becomes a B704
    """The bundle breaks a rule of its structure."""


class Reader:
    """Typed access to one JSON object."""

    def __init__(self, values: Any, what: str) -> None:
        if not isinstance(values, dict):
            raise Malformed(f"{what} is not an object")
        self.values: Mapping[str, Any] = values
        self.what = what

    def _wrong(self, key: str, wanted: str) -> Malformed:
        return Malformed(f"`{key}` of {self.what} is not {wanted}")

    def entry(self, key: str) -> "Reader":
        """Return the object under `key`."""
        return Reader(self.values.get(key), f"`{key}`")

    def entries(self, key: str) -> Iterator["Reader"]:
        """Yield the objects in the list under `key`."""
        found = self.values.get(key)
        if not isinstance(found, list):
            raise self._wrong(key, "a list")
        for i, value in enumerate(found):
            yield Reader(value, f"`{key}[{i}]`")

    def text(self, key: str) -> str:
        """Return the text under `key`."""
        found = self.values.get(key)
        if not isinstance(found, str):
            raise self._wrong(key, "a text")
        if not found.isascii() and any("\ud800" <= c <= "\udfff" for c in found):
            raise self._wrong(key, "a text of whole characters")
        return found

    def name(self, key: str) -> str:
        """Return the name under `key`."""
        found = self.text(key)
        if _NAME.match(found) is None:
            raise self._wrong(key, "a name")
        return found

    def optional_text(self, key: str) -> str | None:
        """Return the text under `key`, or None."""
        return None if self.values.get(key) is None else self.text(key)

    def texts(self, key: str) -> list[str]:
        """Return the list of texts under `key`."""
        found = self.values.get(key)
        if not isinstance(found, list) or not all(isinstance(x, str) for x in found):
            raise self._wrong(key, "a list of texts")
        return found

    def choice(self, key: str, allowed: Sequence[str]) -> str:
        """Return the text under `key`, one of `allowed`."""
        found = self.text(key)
        if found not in allowed:
            raise self._wrong(key, f"one of {', '.join(allowed)}")
        return found

    def number(self, key: str) -> float:
        """Return the number under `key`; "inf" and "-inf" are numbers."""
        found = self.values.get(key)
        if found in ("inf", "-inf"):
            return float(found)
        if isinstance(found, bool) or not isinstance(found, int | float):
            raise self._wrong(key, "a number")
        try:
            value = float(found)
        except OverflowError:
            raise self._wrong(key, "a number that can be kept") from None
        if not math.isfinite(value):
            raise self._wrong(key, "a finite number")
        return value

    def optional_number(self, key: str) -> float | None:
        """Return the number under `key`, or None."""
        return None if self.values.get(key) is None else self.number(key)

    def whole(self, key: str, low: int, high: int) -> int:
        """Return the whole number under `key`, in [low, high]."""
        found = self.values.get(key)
        if isinstance(found, bool) or not isinstance(found, int) or not low <= found <= high:
            raise self._wrong(key, f"a whole number from {low} to {high}")
        return found

    def index(self, key: str, length: int) -> int:
        """Return an index below `length`."""
        return self.whole(key, 0, length - 1)

    def wholes(self, key: str) -> list[int]:
        """Return the list of whole numbers under `key`."""
        found = self.values.get(key)
        if not isinstance(found, list) or not all(type(x) is int and 0 <= x < _LARGEST_TICK for x in found):
            raise self._wrong(key, "a list of whole numbers")
        return found

    def pair(self, key: str) -> tuple[int, int | None]:
        """Return an interval of ticks; its end may be null."""
        found = self.values.get(key)
        if not isinstance(found, list) or len(found) != 2:
            raise self._wrong(key, "a pair")
        ends = Reader({"low": found[0], "high": found[1]}, f"`{key}` of {self.what}")
        low = ends.whole("low", 0, _LARGEST_TICK)
        return low, None if found[1] is None else ends.whole("high", low, _LARGEST_TICK)


def check_nodes(nodes: Sequence[Node], signals: Mapping[str, str]) -> None:
    """Check operators, arities, the order of children, types and intervals of a formula DAG."""
    for i, node in enumerate(nodes):
        where = f"node {i}"
        if node.op not in OPERATORS:
            raise Malformed(f"{where} has an unknown operator")
        least, most = _ARITY[node.op]
        if len(node.children) < least or (most is not None and len(node.children) > most):
            raise Malformed(f"{where} (`{node.op}`) has {len(node.children)} operands")
        if any(child >= i for child in node.children):
            raise Malformed(f"{where} refers to a later node")
        wanted = REAL if node.op in REAL or node.op in COMPARISONS else LOGIC
        if any(nodes[child].op not in wanted for child in node.children):
            raise Malformed(f"{where} (`{node.op}`) takes operands of the other type")
        if (node.interval is not None) != (node.op in BOUNDED):
            raise Malformed(f"{where} (`{node.op}`) has a wrong interval")
        _check_value(node, where, signals)


def _check_value(node: Node, where: str, signals: Mapping[str, str]) -> None:
    if node.op in ("signal", "bool"):
        wanted = "real" if node.op == "signal" else "bool"
        if signals.get(str(node.value)) != wanted:
            raise Malformed(f"{where} reads a {wanted} signal that is not declared")
    elif (node.op == "const") != isinstance(node.value, float):
        raise Malformed(f"{where} (`{node.op}`) has a wrong value")


def check_names(*groups: Sequence[str]) -> None:
    """Check that every name is one of the language, and that no two things share one."""
    names = [name for group in groups for name in group]
    wrong = next((name for name in names if _NAME.match(name) is None), None)
    if wrong is not None:
        raise Malformed(f"{wrong[:30]!r} is not a name")
    if len(set(names)) != len(names):
        raise Malformed("two of its parts share a name")


def check_requirements(requirements: Sequence[Requirement], nodes: Sequence[Node]) -> None:
    """Check that there are requirements, that they are formulas, and depend on requirements that may come first."""
    strengths = {r.name: r.strength for r in requirements}
    if not requirements:
        raise Malformed("it has no requirement")
    for requirement in requirements:
        name, before = requirement.name, requirement.depends_on
        if nodes[requirement.root].op not in LOGIC:
            raise Malformed(f"requirement `{name}` is not a formula")
        if not set(before) <= strengths.keys() or len(set(before)) != len(before):
            raise Malformed(f"requirement `{name}` depends on a requirement that is not there, or twice on one")
        if requirement.strength == "hard" and any(strengths[on] == "soft" for on in before):
            raise Malformed(f"hard requirement `{name}` depends on a soft one")


def check_signals(signals: Sequence[Signal]) -> None:
    """Check that ranges have two ends in order, and that only real signals have one."""
    for signal in signals:
        ends = [end for end in (signal.low, signal.high) if end is not None]
        if ends and (len(ends) == 1 or ends[0] >= ends[1] or signal.type == "bool"):
            raise Malformed(f"the range of signal `{signal.name}` makes no sense")


def check_time(time: TimeBase) -> None:
    """Check that a time base is one that a `time` statement can give."""
    expected = 1 if time.kind == "step" else NANOSECONDS.get(time.unit)
    if time.ticks_per_unit != expected or (time.kind == "step") != (time.unit == STEP):
        raise Malformed("its unit of time does not fit its kind of time")
    if (time.kind == "period") != (time.period is not None):
        raise Malformed("its period does not fit its kind of time")
