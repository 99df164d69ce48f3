"""One formula without a spec around it, evaluated on data.

In: the text of a formula and demonstrations. Out: a result for each. Every name in the formula is taken as a
signal, Boolean where the data says so, and the formula as the only requirement: the compiler does the rest.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stlspec.api import Bundle, publish
from stlspec.compiler.checks import check, names_in
from stlspec.compiler.inference import FUNCTIONS, NOW
from stlspec.compiler.lower import lower
from stlspec.demos import Demonstration, OnNan, bind
from stlspec.errors import SpecError, UsageError, diagnostic
from stlspec.lang.nodes import Name, RequirementStatement, SignalStatement, Statement
from stlspec.lang.parse import Syntax, parse, parse_formula
from stlspec.semantics.evaluation import End, RequirementResult, evaluate
from stlspec.source import SourceText, Span

_NAME = "formula"
_NOWHERE = Span(0, 0)


@dataclass(frozen=True, slots=True)
class FormulaResult:
    """The value of the formula on one demonstration."""

    name: str
    result: RequirementResult


def compile_formula(
    text: str, booleans: frozenset[str], time: str = "step", params: Mapping[str, str] | None = None
) -> Bundle:
    """Compile a formula; names become signals, those in `booleans` Boolean ones, `params` numbers.

    Raises: SpecError: the formula has errors. UsageError: `time` or a param cannot be read.
    """
    source = SourceText.of("<formula>", text)
    values = _numbers(params or {})
    words = frozenset(_words(text))
    formula, problems = parse_formula(source, words & (booleans | values.keys()))
    if formula is None or problems:
        raise SpecError(problems)
    used = dict.fromkeys(n for n in names_in(formula) if n not in NOW and n not in values and n not in FUNCTIONS)
    statements = _time(time) + [_signal(name, name in booleans) for name in used]
    statements += [s for n, v in values.items() for s in parse(_text(f"param {n} = {v!r}")).statements]
    requirement = RequirementStatement(formula.span, "hard", Name(_NOWHERE, _NAME), None, (), None, None, formula)
    syntax = Syntax(source, (*statements, requirement), (), (), words, frozenset({_NAME}))
    model, diagnostics = check(syntax)
    errors = [d for d in diagnostics if d.severity == "error"]
    if errors:
        raise SpecError(errors)
    return publish(lower(model))


def evaluate_on(
    text: str,
    demonstrations: Sequence[Demonstration],
    time: str = "step",
    params: Mapping[str, str] | None = None,
    *,
    end: End = "clip",
    at: int = 0,
    on_nan: OnNan = "refuse",
) -> tuple[FormulaResult, ...]:
    """Evaluate a formula on each demonstration.

    Raises: SpecError: the formula has errors. DataError: a signal is missing or cannot be used.
    """
    results = []
    for demonstration in demonstrations:
        columns = demonstration.recording.columns
        booleans = frozenset(n for n, values in columns.items() if np.asarray(values).dtype == np.bool_)
        bundle = compile_formula(text, booleans, time, params)
        bound = bind(bundle, demonstration, None, on_nan)
        found = evaluate(bundle, bound.signals, bound.time, end=end, at=at, file=bound.name)
        results.append(FormulaResult(bound.name, found[_NAME]))
    return tuple(results)


def _text(text: str) -> SourceText:
    return SourceText.of("<command line>", text)


def _words(text: str) -> list[str]:
    return "".join(c if c.isalnum() or c == "_" else " " for c in text).split()


def _signal(name: str, boolean: bool) -> Statement:
    kind = Name(_NOWHERE, "bool") if boolean else None
    return SignalStatement(_NOWHERE, Name(_NOWHERE, name), kind, None, None, None, None)


def _time(time: str) -> list[Statement]:
    syntax = parse(_text(f"time {time}"))
    if syntax.diagnostics:
        what = f"`--time {time}` is no way to measure time"
        raise UsageError([diagnostic("D880", what=what, help="write --time step, --time s or --time '100 ms'")])
    return list(syntax.statements)


def _numbers(params: Mapping[str, str]) -> dict[str, float]:
    values = {}
    for name, text in params.items():
        try:
            values[name] = float(text)
        except ValueError:
            problem = diagnostic("N108", file="-p", name=name, value=text[:30], problem="it is not a number")
            raise UsageError([problem]) from None
        if not name.isidentifier() or values[name] != values[name] or abs(values[name]) == float("inf"):
            raise UsageError([diagnostic("N108", file="-p", name=name, value=text[:30], problem="it is not a number")])
    return values
