"""The front end in one call: text in, bundle or diagnostics out.

In: source text and the values that `-p` or `params=` give. Out: `CheckResult` for tools that want every
diagnostic, or `BundleData` for those that want to run it.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.checks import check
from stlspec.compiler.lower import lower
from stlspec.compiler.model import Model
from stlspec.errors import Diagnostic, InputError, SpecError, diagnostic
from stlspec.lang.parse import parse
from stlspec.lang.units import NANOSECONDS
from stlspec.source import SourceText

_VALUE = re.compile(r"\s*(?P<number>[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)\s*(?P<unit>[A-Za-z]+)?\s*\Z")


@dataclass(frozen=True, slots=True)
class CheckResult:
    """What checking a text gives: the model (complete if there is no error) and all diagnostics in order."""

    model: Model
    diagnostics: tuple[Diagnostic, ...]

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The diagnostics that keep the text from being compiled."""
        return tuple(d for d in self.diagnostics if d.severity == "error")


def check_source(source: SourceText, params: Mapping[str, float | str] | None = None) -> CheckResult:
    """Check a text; params may stay without a value.

    Raises: InputError: a given param does not exist or its value cannot be read.
    """
    syntax = parse(source)
    model, diagnostics = check(syntax)
    if params:
        values = _bind(model, params)
        model, diagnostics = check(syntax, values)
    return CheckResult(model, diagnostics)


def compile_source(source: SourceText, params: Mapping[str, float | str] | None = None) -> BundleData:
    """Compile a text.

    Args:    params: values by name; a number is in the declared unit, a text such as "12s" is converted.
    Raises: SpecError: the text has errors. InputError: a param has no value, does not exist, or cannot be read.
    """
    result = check_source(source, params)
    if result.errors:
        raise SpecError(result.errors)
    model = result.model
    if not model.declared.requirements:
        raise SpecError([diagnostic("G506", file=source.name)])
    unbound = [name for name in model.declared.params if name not in model.values]
    if unbound:
        places = model.declared.places
        raise InputError(diagnostic("N106", source=source, span=places[n], name=n) for n in unbound)
    return lower(model)


def _bind(model: Model, params: Mapping[str, float | str]) -> dict[str, float]:
    """Read the given values into the declared units."""
    values: dict[str, float] = {}
    problems: list[Diagnostic] = []
    for name, given in params.items():
        statement = model.declared.params.get(name)
        if statement is None:
            close = get_close_matches(name, model.declared.params, 1, 0.5)
            names = ", ".join(f"`{n}`" for n in model.declared.params) or "none"
            way = f"did you mean `{close[0]}`?" if close else f"the params of this spec: {names}"
            problems.append(diagnostic("N107", file=model.source.name, name=name, help=way))
            continue
        unit = statement.number.unit.text if statement.number and statement.number.unit else None
        value = _value(given, unit)
        if isinstance(value, str):
            shown = str(given)[:30]
            problems.append(diagnostic("N108", file=model.source.name, name=name, value=shown, problem=value))
        else:
            values[name] = value
    if problems:
        raise InputError(problems)
    return values


def _value(given: float | str, unit: str | None) -> float | str:
    """Return a value in the declared unit, or what is wrong with it."""
    if isinstance(given, str):
        if given.strip() in ("inf", "-inf"):
            return float(given)
        match = _VALUE.match(given)
        if match is None:
            return "it is not a number"
        number, own = float(match["number"]), match["unit"]
        if own is None or own == unit:
            return number
        if own not in NANOSECONDS or unit not in NANOSECONDS:
            return f"the param is {'in ' + unit if unit else 'without a unit'}"
        return number * NANOSECONDS[own] / NANOSECONDS[unit]
    if isinstance(given, bool) or not isinstance(given, int | float) or given != given:
        return "it is not a number"
    return float(given)
