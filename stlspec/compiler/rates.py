"""Comparisons of rates in the unit that their author wrote, for messages.

In: a compiled spec and one of its comparisons. Out: `Written`. Compiling brings constants to the unit of time of the
spec: under `time 100 ms`, `rate(alt) >= -2 m/s` compares with -0.002 m/ms. What is shown of it goes the way back.
"""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import COMPARISONS, Node, reachable
from stlspec.compiler.printing import number_text
from stlspec.compiler.quantities import conversion, scaled
from stlspec.lang.units import STEP, Dimension, dimension

_LITERAL = re.compile(
    r"(?<![\w.])(?P<number>\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+)[ \t]*"
    r"(?P<unit>[A-Za-z_%][A-Za-z_0-9%]*(?:\*\*-?\d+|[*/][A-Za-z_%][A-Za-z_0-9%]*)*)"
)
_SAME_UNIT = frozenset({"neg", "abs", "add", "sub", "min", "max", "hypot", "delta"})


@dataclass(frozen=True, slots=True)
class Written:
    """A unit as the text has it, and the factor that brings a value of the engine to it."""

    unit: str
    factor: Fraction

    def of(self, value: float) -> float:
        """Return a value in this unit."""
        return scaled(value, self.factor)

    def text(self, number: str) -> str:
        """Return a number with this unit."""
        return f"{number} {self.unit}"


def written_unit(bundle: BundleData, predicate: int) -> Written | None:
    """Return the unit in which a comparison with a rate was written; None for others, and where no unit was.

    Not in the paper: it serves the messages.
    """
    top = bundle.nodes[predicate]
    if top.op not in COMPARISONS or bundle.time.unit == STEP:
        return None
    nodes, _ = reachable(bundle.nodes, [predicate])
    if all(node.op != "rate" for node in nodes):
        return None
    found = _dimension(bundle, nodes)
    if not found:
        return None
    literals = [(value, unit) for value, unit in _literals(bundle) if _factor(found, unit) is not None]
    wanted = {abs(float(node.value or 0.0)) for node in nodes if node.op == "const"}
    # Of several units, the one whose number is the constant at hand.
    literals.sort(key=lambda literal: _back(literal[0], literal[1], found) not in wanted)
    unit = literals[0][1] if literals else ""
    factor = _factor(found, unit) if unit else None
    return None if factor is None else Written(unit, factor)


def comparison_text(node: Node, nodes: Sequence[Node], sides: Sequence[str], written: Written) -> str:
    """Return a comparison whose constant sides stand in the unit that was written. Not in the paper: for messages."""
    left, right = (
        written.text(number_text(written.of(float(nodes[child].value or 0.0)))) if nodes[child].op == "const" else side
        for child, side in zip(node.children, sides, strict=True)
    )
    return f"{left} {COMPARISONS[node.op]} {right}"


def _dimension(bundle: BundleData, nodes: Sequence[Node]) -> Dimension | None:
    """Return the unit of both sides of the last node, a comparison, as far as signals tell it; None if they do not.

    A constant has the unit of what it is joined with; what a product with a constant is in, only its text knows.
    """
    signals = {signal.name: signal.unit for signal in bundle.signals}
    found: list[tuple[bool, Dimension | None]] = []  # whether it is known, and the unit, None = any
    for node in nodes[:-1]:
        below = [found[child] for child in node.children]
        unit = next((unit for _, unit in below if unit is not None), None)
        known = all(known for known, _ in below)
        if node.op == "signal":
            known, unit = True, dimension(signals.get(str(node.value)) or "")
        elif node.op == "rate" and unit is not None:
            power = unit.get(bundle.time.unit, 0) - 1
            unit = {word: p for word, p in {**unit, bundle.time.unit: power}.items() if p}
        elif node.op not in _SAME_UNIT and node.op != "const":
            known = False
        found.append((known, unit))
    sides = [found[child] for child in nodes[-1].children]
    return next((unit for _, unit in sides if unit is not None), None) if all(known for known, _ in sides) else None


def _literals(bundle: BundleData) -> Iterator[tuple[float, str]]:
    """Yield the numbers with units of the texts, and the values of params."""
    for _, text in bundle.sources:
        for line in text.splitlines():
            for match in _LITERAL.finditer(line.split("#")[0]):
                yield float(match["number"]), match["unit"]
    for param in bundle.params:
        if param.unit is not None:
            yield abs(param.value), param.unit


def _factor(unit: Dimension, written: str) -> Fraction | None:
    exponents = dimension(written)
    return None if exponents is None else conversion(unit, exponents)


def _back(value: float, written: str, unit: Dimension) -> float:
    factor = _factor(unit, written)
    return scaled(value, 1 / factor) if factor else math.nan
