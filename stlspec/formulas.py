"""One formula without a spec around it, evaluated on data.

In: the text of a formula and demonstrations. Out: a result for each. Every name in the formula is taken as a
signal, Boolean where the data says so, and the formula as the only requirement: the compiler does the rest.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stlspec.api import Bundle, publish
from stlspec.binding import bind
from stlspec.compiler.checks import check
from stlspec.compiler.compiling import compile_syntax
from stlspec.compiler.inference import FUNCTIONS, NOW
from stlspec.demos import Demonstration
from stlspec.errors import Diagnostic, SpecError, StlspecError, UsageError, diagnostic
from stlspec.lang.nodes import Name, ParamStatement, RequirementStatement, SignalStatement, Statement, names_in
from stlspec.lang.parse import Syntax, parse, parse_formula
from stlspec.sampling import OnNan
from stlspec.semantics.ending import End, evaluate_ending
from stlspec.semantics.evaluation import RequirementResult
from stlspec.source import SourceText, Span

_NAME = "formula"
_NOWHERE = Span(0, 0)
_LEAVE_OUT = "leave the unit out: signals have none without a spec"
_IN_FORMULA = (
    (r"declare `time (.+?)`", r"give `--time '\1'`"),
    (r"write `time (.+?)`", r"give `--time '\1'`"),
    (r"declare the sampling period: `time (.+?)`", r"give the sampling period: `--time '\1'`"),
    (r'write `from "([A-Za-z_]\w*)"` in its declaration', r"write `\1`"),
    (r'write `from "(.*?)"` in its declaration', "a formula cannot name it: write a spec that reads it by `from`"),
    (r"declare the unit of both sides|convert one side by a factor with a unit", _LEAVE_OUT),
    (r"declare a signal with this unit, or remove it", _LEAVE_OUT),
    (r"use numbers, params and `inf` only", "use numbers and `inf`, or give the name a value with `-p NAME=VALUE`"),
)
"""What help says of declarations, which a formula alone has none of, and what there is in their place."""


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
    values = dict(params or {})
    words = frozenset(_words(text))
    formula, problems = parse_formula(source, words & (booleans | values.keys()))
    if formula is None or problems:
        raise SpecError(problems)
    used = dict.fromkeys(names_in(formula))
    signals = [name for name in used if name not in {*NOW, *FUNCTIONS, *values}]
    statements: list[Statement] = [*_time(time), *(_signal(name, name in booleans) for name in signals)]
    statements += [ParamStatement(_NOWHERE, Name(_NOWHERE, name), None, None) for name in values if name in used]
    statements.append(RequirementStatement(formula.span, "hard", Name(_NOWHERE, _NAME), None, (), None, None, formula))
    return publish(compile_syntax(Syntax(source, tuple(statements), (), (), words, frozenset({_NAME})), values))


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
    try:
        for demonstration in demonstrations:
            columns = demonstration.recording.columns
            booleans = frozenset(n for n, values in columns.items() if np.asarray(values).dtype == np.bool_)
            bundle = compile_formula(text, booleans, time, params)
            bound = bind(bundle, demonstration, None, on_nan)
            found = evaluate_ending(bundle, bound.signals, bound.time, end=end, at=at, file=bound.name)
            results.append(FormulaResult(bound.name, found[_NAME]))
    except StlspecError as error:
        raise type(error)(_without_declarations(error.diagnostics)) from None
    return tuple(results)


def _without_declarations(problems: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Say ways out in the words of the command that evaluates one formula."""
    found = []
    for problem in problems:
        way = problem.help
        for pattern, words in _IN_FORMULA:
            way = re.sub(pattern, words, way)
        found.append(replace(problem, help=way))
    return found


def _words(text: str) -> list[str]:
    return "".join(c if c.isalnum() or c == "_" else " " for c in text).split()


def _signal(name: str, boolean: bool) -> Statement:
    kind = Name(_NOWHERE, "bool") if boolean else None
    return SignalStatement(_NOWHERE, Name(_NOWHERE, name), kind, None, None, None, None)


def _time(time: str) -> tuple[Statement, ...]:
    syntax = parse(SourceText.of("<command line>", f"time {time}"))
    _, problems = check(syntax)
    if problems or len(syntax.statements) != 1:
        what = f"`--time {time[:30]}` is no way to measure time"
        raise UsageError([diagnostic("D880", what=what, help="write --time step, --time s or --time '100 ms'")])
    return syntax.statements
