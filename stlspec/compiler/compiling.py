"""The front end in one call: text in, bundle or diagnostics out.

In: source text and the values that `-p` or `params=` give. Out: `CheckResult` for tools that want every
diagnostic, or `BundleData` for those that want to run it.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from numbers import Real

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.checks import check
from stlspec.compiler.lower import lower
from stlspec.compiler.model import Binding, Model
from stlspec.compiler.quantities import scaled
from stlspec.errors import Diagnostic, InputError, SpecError, diagnostic
from stlspec.lang.parse import Syntax
from stlspec.lang.spelling import closest
from stlspec.lang.units import NANOSECONDS, STEP
from stlspec.lang.using import Loader, parse_with_uses
from stlspec.source import SourceText

_VALUE = re.compile(
    r"\s*(?P<number>[+-]?(?:inf|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))\s*(?P<unit>[A-Za-z_][A-Za-z_0-9/*]*)?\s*\Z",
    re.ASCII,
)


@dataclass(frozen=True, slots=True)
class CheckResult:
    """What checking a text gives: the model (complete if there is no error) and all diagnostics in order."""

    model: Model
    diagnostics: tuple[Diagnostic, ...]

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The diagnostics that keep the text from being compiled."""
        return tuple(d for d in self.diagnostics if d.severity == "error")


def check_source(
    source: SourceText, params: Mapping[str, float | str] | None = None, load: Loader | None = None
) -> CheckResult:
    """Check a text; params may stay without a value.

    Args:    load: reads the files that the text uses; None: it has no files.
    Raises: InputError: a given param does not exist or its value cannot be read.
    """
    return check_syntax(parse_with_uses(source, load), params)


def check_syntax(syntax: Syntax, params: Mapping[str, float | str] | None = None) -> CheckResult:
    """Check statements that are parsed; see `check_source`."""
    model, diagnostics = check(syntax)
    if params:
        model, diagnostics = check(syntax, _bind(model, params))
    return CheckResult(model, diagnostics)


def compile_source(
    source: SourceText, params: Mapping[str, float | str] | None = None, load: Loader | None = None
) -> BundleData:
    """Compile a text.

    Args:    params: values by name; a number is in the declared unit, a text such as "12s" is converted.
             load: reads the files that the text uses; None: it has no files.
    Raises: SpecError: the text has errors. InputError: a param has no value, does not exist, or cannot be read.
    """
    return compile_syntax(parse_with_uses(source, load), params)


def compile_syntax(syntax: Syntax, params: Mapping[str, float | str] | None = None) -> BundleData:
    """Compile statements that are parsed, or made by a program; see `compile_source`."""
    source = syntax.source
    result = check_syntax(syntax, params)
    if result.errors:
        raise SpecError(result.errors)
    model = result.model
    if not model.declared.requirements:
        raise SpecError([diagnostic("G506", file=source.name)])
    unbound = [name for name in model.declared.params if name not in model.params]
    if unbound:
        places = [(n, model.declared.place(n)) for n in unbound]
        raise InputError(diagnostic("N106", source=p.source, span=p.span, name=n) for n, p in places)
    return lower(model)


def _bind(model: Model, params: Mapping[str, float | str]) -> dict[str, Binding]:
    """Read the given values into the declared units."""
    bindings: dict[str, Binding] = {}
    problems: list[Diagnostic] = []
    for name, given in params.items():
        statement = model.declared.params.get(name)
        if statement is None:
            close = closest(name, model.declared.params, 0.5)
            names = ", ".join(f"`{n}`" for n in model.declared.params) or "none"
            way = f"did you mean `{close}`?" if close else f"the params of this spec: {names}"
            problems.append(diagnostic("N107", file=model.source.name, name=name, help=way))
            continue
        unit = statement.number.unit.text if statement.number and statement.number.unit else None
        binding = _value(given, unit, is_open=statement.number is None)
        if isinstance(binding, str):
            shown = str(given)[:30]
            problems.append(diagnostic("N108", file=model.source.name, name=name, value=shown, problem=binding))
        else:
            bindings[name] = binding
    if problems:
        raise InputError(problems)
    return bindings


def _value(given: object, unit: str | None, *, is_open: bool) -> Binding | str:
    """Return a value in the declared unit, or what is wrong with it; `is_open`: the text gives neither."""
    own = None
    if isinstance(given, str):
        match = _VALUE.match(given)
        if match is None:
            return "it is not a number"
        number, own = float(match["number"]), match["unit"]
        if abs(number) == math.inf and "inf" not in match["number"]:
            return "it is too large to be kept"
    elif isinstance(given, bool) or not isinstance(given, Real):
        return "it is not a number"
    else:
        try:
            number = float(given)
        except OverflowError:
            return "it is too large to be kept"
    if math.isnan(number):
        return "it is not a number"
    if own is None or own == unit:
        return Binding(number)
    if is_open and own in (*NANOSECONDS, STEP):
        return Binding(number, own)
    if own not in NANOSECONDS or unit not in NANOSECONDS:
        return f"the param is {'in ' + unit if unit else 'without a unit'}"
    return Binding(scaled(number, Fraction(NANOSECONDS[own], NANOSECONDS[unit])))
