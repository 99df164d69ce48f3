"""The checked spec, before formulas are lowered: what was declared, with types, units and values known.

In: syntax that passed the checks. Out: `Model`, from which `lower` makes the bundle. Expressions stay syntax;
`typings` says of each of their nodes whether it is real or a formula, in which unit, and its value if constant.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from stlspec.compiler.bundle import Param, Signal, TimeBase
from stlspec.lang.nodes import Expression, LetStatement, ParamStatement, RequirementStatement, SignalStatement
from stlspec.lang.units import Dimension
from stlspec.source import SourceText, Span

Kind = Literal["real", "formula", "broken"]


@dataclass(frozen=True, slots=True)
class Typing:
    """What is known of an expression.

    kind: "broken" if it was reported already, so that nothing above it is. unit: None takes the unit of the
    other side, as a literal does. constant: no signal in it. value: of a constant whose params are bound.
    """

    kind: Kind
    unit: Dimension | None = None
    constant: bool = False
    value: float | None = None


BROKEN = Typing("broken")
FORMULA = Typing("formula")


@dataclass(frozen=True, slots=True)
class Declared:
    """All that a text declares, by name.

    places: where each name was declared first. time_known: False if the `time` statement is broken, so that
    bounds cannot be judged.
    """

    spec_name: str
    title: str | None
    time: TimeBase
    signals: Mapping[str, SignalStatement]
    params: Mapping[str, ParamStatement]
    lets: Mapping[str, LetStatement]
    requirements: Mapping[str, RequirementStatement]
    places: Mapping[str, Span]
    time_known: bool = True


@dataclass(frozen=True, slots=True)
class Binding:
    """A value for a param from outside the text; a unit only where the text declares none."""

    value: float
    unit: str | None = None


@dataclass(frozen=True, slots=True)
class Model:
    """A spec that was checked.

    signals: with units and ranges resolved. params: those that have a value. let_order: lets, each after
    those it uses. typings: by `id` of the expression node. intervals: ticks, by `id` of the interval node.
    """

    source: SourceText
    declared: Declared
    signals: Mapping[str, Signal]
    params: Mapping[str, Param]
    let_order: tuple[str, ...]
    let_typings: Mapping[str, Typing]
    typings: Mapping[int, Typing]
    intervals: Mapping[int, tuple[int, int | None]]

    def typing(self, expression: Expression) -> Typing:
        """Return what is known of `expression`."""
        return self.typings[id(expression)]
