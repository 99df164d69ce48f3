"""The compiled spec as data: what every later stage takes, and nothing else.

In: the checked model, lowered. Out: `BundleData`, immutable and free of numpy, so that it can be compared,
hashed, written and read without running anything. The public `stlspec.Bundle` adds the methods.
"""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from stlspec.compiler.ir import Node

Strength = Literal["hard", "soft"]
Bounding = Literal["tanh", "linear", "none"]


@dataclass(frozen=True, slots=True)
class TimeBase:
    """How samples and bounds are measured.

    kind: "step" (time is the sample's index), "period" (one sample every `period` ticks) or "stamps" (time
    stamps come with the data). unit: "step", or the time unit of stamps, `now` and `rate`.
    ticks_per_unit: ticks (nanoseconds; the index for "step") in one `unit`. period: ticks, for "period".
    """

    kind: Literal["step", "period", "stamps"]
    unit: str
    ticks_per_unit: int
    period: int | None = None


@dataclass(frozen=True, slots=True)
class Signal:
    """A declared signal: type, unit, the range that its samples stay in, and the column or path it is read from."""

    name: str
    type: Literal["real", "bool"] = "real"
    unit: str | None = None
    low: float | None = None
    high: float | None = None
    source: str | None = None
    doc: str | None = None


@dataclass(frozen=True, slots=True)
class Param:
    """A param with the value it is bound to, in its declared unit."""

    name: str
    value: float
    unit: str | None = None
    doc: str | None = None


@dataclass(frozen=True, slots=True)
class Requirement:
    """A named formula with its strength, how its robustness is bounded, and its place in the formula DAG.

    root: index into `BundleData.nodes`. horizon: how far ahead the formula looks, in ticks; None = no end.
    depends_on: names of the direct prerequisites. text: the formula as the user wrote it, on one line.
    """

    name: str
    strength: Strength
    root: int
    depends_on: tuple[str, ...] = ()
    scale: float = 1.0
    bound: Bounding = "tanh"
    horizon: int | None = 0
    doc: str | None = None
    text: str = ""


@dataclass(frozen=True)
class BundleData:
    """A compiled spec.

    nodes: the formula DAG (children first). names: the root of each `let` that a requirement uses.
    raw_weights: |Φ| - |ancestors| for each requirement (the paper's equation 1); weights: their softmax.
    sources: (file name, text) of the spec and of all it uses, main file first.
    """

    name: str
    title: str | None
    time: TimeBase
    signals: tuple[Signal, ...]
    params: tuple[Param, ...]
    requirements: tuple[Requirement, ...]
    nodes: tuple[Node, ...]
    names: MappingProxyType[str, int]
    raw_weights: tuple[int, ...]
    weights: tuple[float, ...]
    sources: tuple[tuple[str, str], ...]

    @property
    def edges(self) -> tuple[tuple[str, str], ...]:
        """All (prerequisite, dependant) pairs as declared."""
        return tuple((p, r.name) for r in self.requirements for p in r.depends_on)

    @property
    def horizon(self) -> int | None:
        """The longest horizon of the requirements, in ticks; None = no end."""
        horizons = [r.horizon for r in self.requirements]
        known = [h for h in horizons if h is not None]
        return max(known, default=0) if len(known) == len(horizons) else None
