"""The checked spec, before formulas are lowered: what was declared, with types, units and values known.

In: syntax that passed the checks. Out: `Model`, from which `lower` makes the bundle. Expressions stay syntax;
`typings` says of each of their nodes whether it is real or a formula, in which unit, and its value if constant.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from stlspec.compiler.bundle import Param, Signal, TimeBase
from stlspec.errors import Diagnostic, Label
from stlspec.lang.nodes import Expression, LetStatement, ParamStatement, RequirementStatement, SignalStatement
from stlspec.lang.parse import Syntax
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
    """All that a text and the files it uses declare, by name.

    places: where each name was declared first, in which of the files. elsewhere: the requirements of used files,
    which are not those of this spec. time_known: False if the `time` statement is broken, so that bounds cannot be
    judged.
    """

    spec_name: str
    title: str | None
    time: TimeBase
    signals: Mapping[str, SignalStatement]
    params: Mapping[str, ParamStatement]
    lets: Mapping[str, LetStatement]
    requirements: Mapping[str, RequirementStatement]
    places: Mapping[str, Span]
    files: Mapping[str, Syntax]
    elsewhere: Mapping[str, Label]
    time_known: bool = True

    def place(self, name: str, text: str = "declared here") -> Label:
        """Return where a name is declared, as the second place of a diagnostic."""
        return Label(self.places[name], text, self.files[name].source)


@dataclass(frozen=True, slots=True)
class Binding:
    """A value for a param from outside the text; a unit only where the text declares none."""

    value: float
    unit: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """A template with certain arguments: its body, typed for them.

    typings, intervals, calls: as in `Model`, for the nodes of the body. result: the typing of the whole.
    problems: what does not fit, at its place in the body.
    """

    template: LetStatement
    typings: Mapping[int, Typing]
    intervals: Mapping[int, tuple[int, int | None]]
    calls: Mapping[int, "Instance"]
    result: Typing
    problems: tuple[Diagnostic, ...]

    def typing(self, expression: Expression) -> Typing:
        """Return what is known of an expression of the body."""
        return self.typings[id(expression)]


@dataclass(frozen=True, slots=True)
class Model:
    """A spec that was checked.

    signals: with units and ranges resolved. params: those that have a value. let_order: lets, each after
    those it uses. typings: by `id` of the expression node. intervals: ticks, by `id` of the interval node.
    calls: by `id` of a call of a template, the template with these arguments.
    """

    source: SourceText
    declared: Declared
    signals: Mapping[str, Signal]
    params: Mapping[str, Param]
    let_order: tuple[str, ...]
    let_typings: Mapping[str, Typing]
    typings: Mapping[int, Typing]
    intervals: Mapping[int, tuple[int, int | None]]
    calls: Mapping[int, Instance] = field(default_factory=dict)
    sources: tuple[SourceText, ...] = ()

    def typing(self, expression: Expression) -> Typing:
        """Return what is known of `expression`."""
        return self.typings[id(expression)]
