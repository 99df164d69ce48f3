"""The checks of a whole spec: declarations, formulas, and the graph of requirements.

In: the syntax and the values of params. Out: the `Model` and every diagnostic, in the order of the text. Each
root cause is reported once: names that broken statements declare are known, and broken expressions stay silent.
"""

import re
from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise

from stlspec.compiler.bundle import Param, Signal
from stlspec.compiler.dependencies import ancestors, dependency_weights, find_cycle, softmax
from stlspec.compiler.expectations import check_expectations, check_margins
from stlspec.compiler.inference import MANY_PROBLEMS, Inference
from stlspec.compiler.model import BROKEN, FORMULA, Binding, Declared, Model, Typing
from stlspec.compiler.names import declare
from stlspec.compiler.templates import TemplateInference
from stlspec.errors import Diagnostic, Edit, Label, diagnostic
from stlspec.lang.nodes import (
    LetStatement,
    Name,
    RequirementStatement,
    SignalStatement,
    names_in,
)
from stlspec.lang.parse import Syntax
from stlspec.lang.spelling import closest
from stlspec.lang.units import Dimension, dimension, respelt
from stlspec.source import SourceText, Span

_TYPES = ("real", "bool")
BOUNDINGS = ("tanh", "linear", "none")
_VANISHING = 1 / 100
_CLAUSE = re.compile(r"[ \t]*depends\s+on\s+\Z")


def check(syntax: Syntax, bindings: Mapping[str, Binding] | None = None) -> tuple[Model, tuple[Diagnostic, ...]]:
    """Check a parsed text.

    Args:    bindings: values of params from outside; they replace those of the text.
    Returns: the model, complete only if no diagnostic is an error; all diagnostics of the text in order.
    """
    files = (*syntax.used, syntax)
    problems = [problem for file in files for problem in file.diagnostics]
    declared = declare(syntax, problems)
    names = frozenset[str]().union(*(file.names | file.lost.names for file in files))
    silent = (names | syntax.requirement_names) - declared.places.keys()
    inference = TemplateInference(syntax, declared, silent, problems)
    units = _units(inference)
    params = _params(inference, bindings or {})
    kinds = _types(inference, units)
    order = _lets(inference)
    signals = _signals(inference, kinds, units)
    inference.enter(syntax)
    for requirement in declared.requirements.values():
        inference.formula(requirement.formula)
        _clauses(syntax.source, requirement, problems)
    _graph(syntax, declared, problems)
    check_expectations(syntax, declared, problems)
    let_typings = {name: inference.scope[name] for name in order}
    model = Model(
        syntax.source,
        declared,
        signals,
        params,
        order,
        let_typings,
        inference.typings,
        inference.intervals,
        inference.calls,
        tuple(file.source for file in (syntax, *syntax.used)),
    )
    check_margins(syntax, model, problems)
    return model, tuple(sorted(dict.fromkeys(problems), key=Diagnostic.sort_key))


def _units(inference: Inference) -> dict[str, Dimension | None]:
    """Return the unit of each signal, None (any) for a broken one; their words may stand behind numbers now."""
    units = {}
    for name, statement in inference.declared.signals.items():
        inference.enter(inference.declared.files[name])
        units[name] = _unit_of(inference, statement)
    for unit in units.values():
        inference.quantities.known |= set(unit or ())
    for text in inference.lost_units:
        inference.quantities.known |= set(dimension(text) or ())
    return units


def _params(inference: Inference, bindings: Mapping[str, Binding]) -> dict[str, Param]:
    """Put params into scope, bound from outside first; return those with a value."""
    params: dict[str, Param] = {}
    for name, statement in inference.declared.params.items():
        inference.enter(inference.declared.files[name])
        typing = inference.infer(statement.number) if statement.number else Typing("real", None, True)
        unit = statement.number.unit.text if statement.number and statement.number.unit else None
        given = bindings.get(name)
        if given is not None and typing.kind == "real":
            unit = unit or given.unit
            typing = Typing("real", dimension(unit) if unit else None, True, given.value)
        if typing.value is not None:
            params[name] = Param(name, typing.value, unit, statement.doc.text if statement.doc else None)
        inference.scope[name] = typing
    return params


def _types(inference: Inference, units: Mapping[str, Dimension | None]) -> dict[str, str]:
    """Put signals into scope; return the type of each."""
    kinds = {}
    for name, statement in inference.declared.signals.items():
        inference.enter(inference.declared.files[name])
        kinds[name] = _type_of(inference, statement)
    for name, kind in kinds.items():
        inference.scope[name] = Typing("real", units[name]) if kind == "real" else FORMULA
    return kinds


def _signals(
    inference: Inference, kinds: Mapping[str, str], units: Mapping[str, Dimension | None]
) -> dict[str, Signal]:
    """Resolve the ranges of signals, in which params and lets may stand."""
    found = {}
    for name, statement in inference.declared.signals.items():
        inference.enter(inference.declared.files[name])
        low, high = None, None
        if statement.range is not None:
            low, high = _range_of(inference, statement, kinds[name], units[name])
        found[name] = Signal(
            name,
            "bool" if kinds[name] == "bool" else "real",
            statement.unit.text if statement.unit else None,
            low,
            high,
            statement.source.text if statement.source else None,
            statement.doc.text if statement.doc else None,
        )
    return found


def _unit_of(inference: Inference, statement: SignalStatement) -> Dimension | None:
    if statement.unit is None:
        return {}
    unit = dimension(statement.unit.text)
    if unit is None:
        written, span = respelt(statement.unit.text), statement.unit.span
        way = 'write it like "m/s" or "m/s**2"' if written is None else f'write `"{written}"`'
        edits = () if written is None else (Edit(span, f'"{written}"'),)
        text = statement.unit.text
        inference.problems.append(
            diagnostic("U302", source=inference.source, span=span, edits=edits, unit=text, help=way)
        )
    return unit


def _type_of(inference: Inference, statement: SignalStatement) -> str:
    if statement.type is None or statement.type.text in _TYPES:
        return statement.type.text if statement.type else "real"
    inference.problems.append(_choice(inference.source, statement.type, "a type", _TYPES))
    return closest(statement.type.text, _TYPES, 0.5) or "real"


def _choice(source: SourceText, name: Name, what: str, allowed: tuple[str, ...]) -> Diagnostic:
    close = closest(name.text, allowed, 0.5)
    way = f"did you mean `{close}`?" if close else f"write one of {', '.join(allowed)}"
    edits = (Edit(name.span, close),) if close else ()
    return diagnostic("T205", source=source, span=name.span, edits=edits, what=f"`{name.text}` is not {what}", help=way)


def _range_of(
    inference: Inference, statement: SignalStatement, kind: str, unit: Dimension | None
) -> tuple[float | None, float | None]:
    assert statement.range is not None
    if kind == "bool":
        problem = diagnostic(
            "T206",
            source=inference.source,
            span=statement.range.span,
            what="a bool signal has no range",
            help="remove the range, or the `: bool`",
        )
        inference.problems.append(problem)
        return None, None
    found = inference.range_of(statement.range, unit)
    return found if found is not None else (None, None)


def _lets(inference: TemplateInference) -> tuple[str, ...]:
    """Type the lets, each after those that it uses, and put them into scope."""
    lets = inference.declared.lets
    uses = {name: _used_lets(let, lets) for name, let in lets.items()}
    try:
        order = tuple(TopologicalSorter(uses).static_order())
    except CycleError as error:
        circle: list[str] = error.args[1][::-1]
        inference.problems.append(_let_circle(inference.declared, circle))
        order = tuple(lets)
        inference.scope.update(dict.fromkeys(order, BROKEN))
    for name in order:
        let = lets[name]
        if name in inference.scope:
            continue
        inference.enter(inference.declared.files[name])
        inference.scope[name] = inference.template(let) if let.arguments else inference.infer(let.body)
    return order


def _used_lets(let: LetStatement, lets: Mapping[str, LetStatement]) -> list[str]:
    arguments = {argument.text for argument in let.arguments}
    return [name for name in names_in(let.body) if name in lets and name not in arguments]


def _let_circle(declared: Declared, circle: list[str]) -> Diagnostic:
    labels = tuple(declared.place(name, f"`{name}` uses `{used}`") for name, used in pairwise(circle[1:]))
    first, shown = declared.place(circle[0]), " -> ".join(circle)
    return diagnostic("N104", source=first.source, span=first.span, labels=labels, name=circle[0], cycle=shown)


def _clauses(source: SourceText, requirement: RequirementStatement, problems: list[Diagnostic]) -> None:
    """Check the scale and the bound of a requirement's header."""
    scale, bound = requirement.scale, requirement.bound
    if scale is not None and not 0 < scale.value < float("inf"):
        what = f"a scale of {scale.value:g} does not scale"
        problems.append(diagnostic("T205", source=source, span=scale.span, what=what, help="write a positive number"))
    if bound is not None and bound.text not in BOUNDINGS:
        problems.append(_choice(source, bound, "a way to bound robustness", BOUNDINGS))


def _graph(syntax: Syntax, declared: Declared, problems: list[Diagnostic]) -> None:
    """Check the edges between requirements: they exist, are acyclic, and hard ones do not wait for soft ones."""
    requirements = declared.requirements
    before = len(problems)
    edges: dict[str, list[str]] = {}
    for name, requirement in requirements.items():
        edges[name] = []
        for on in requirement.depends_on:
            problem = _edge(syntax, declared, requirement, on, suggest=len(problems) < MANY_PROBLEMS)
            if problem is not None:
                problems.append(problem)
            if on.text in requirements and on.text != name:
                edges[name].append(on.text)
    circle = find_cycle(edges)
    if circle is not None:
        problems.append(_circle(syntax.source, declared, circle))
        return
    complete = (
        not syntax.lost.names
        and not syntax.lost.nameless
        and syntax.requirement_names <= requirements.keys()
        and len(problems) == before
    )
    if complete:
        _weights(syntax.source, declared, edges, problems)


def _edge(
    syntax: Syntax, declared: Declared, requirement: RequirementStatement, on: Name, *, suggest: bool
) -> Diagnostic | None:
    source, name = syntax.source, requirement.name.text
    if on.text == name:
        return diagnostic("G503", source=source, span=on.span, name=name)
    other = declared.requirements.get(on.text)
    if other is None:
        if on.text in syntax.requirement_names or on.text in syntax.lost.names or syntax.lost.nameless:
            return None
        if on.text in declared.elsewhere:
            there = declared.elsewhere[on.text]
            return diagnostic("N112", source=source, span=on.span, labels=(there,), name=on.text)
        close = closest(on.text, (n for n in declared.requirements if n != name)) if suggest else None
        way = f"did you mean `{close}`?" if close else _instead(declared, requirement, on)
        first = close or _first_hard(declared, requirement)
        edits = (Edit(on.span, first),) if first else _independent(source, requirement, on)
        return diagnostic("G502", source=source, span=on.span, edits=edits, name=name, on=on.text, help=way)
    if requirement.strength == "hard" and other.strength == "soft":
        place = Label(other.name.span, "declared soft here", source)
        return diagnostic("G504", source=source, span=on.span, labels=(place,), name=name, on=on.text)
    return None


def _first_hard(declared: Declared, requirement: RequirementStatement) -> str | None:
    """Return what a soft requirement may depend on that depends on nothing else; None if that need not be."""
    if requirement.strength == "hard" or len(requirement.depends_on) > 1:
        return None
    return next((name for name, other in declared.requirements.items() if other.strength == "hard"), None)


def _instead(declared: Declared, requirement: RequirementStatement, on: Name) -> str:
    """Say what to write for a dependency that is declared nowhere and like no other name."""
    first = _first_hard(declared, requirement)
    what = f"`depends on {on.text}`" if len(requirement.depends_on) == 1 else f"`{on.text}` and its comma"
    way = f"write `depends on {first}`" if first is not None else f"remove {what}"
    return way if on.text in declared.places else f"{way}, or state `hard {on.text}: ...`"


def _independent(source: SourceText, requirement: RequirementStatement, on: Name) -> tuple[Edit, ...]:
    """Return the edit that takes `on` from what a requirement depends on; none where a comment stands in the way."""
    names = requirement.depends_on
    at = names.index(on)
    if len(names) == 1:
        clause = _CLAUSE.search(source.text, requirement.span.start, on.span.start)
        span = Span(clause.start(), on.span.end) if clause else None
    else:
        span = Span(names[at - 1].span.end, on.span.end) if at else Span(on.span.start, names[1].span.start)
    return (Edit(span, ""),) if span and not re.search("#|//", source.slice(span)) else ()


def _circle(source: SourceText, declared: Declared, circle: list[str]) -> Diagnostic:
    def place(name: str, on: str) -> Span:
        names = declared.requirements[name].depends_on
        return next(n.span for n in names if n.text == on)

    edges = list(pairwise(circle))
    labels = tuple(Label(place(a, b), f"`{a}` depends on `{b}`", source) for a, b in edges[1:])
    first = f"`{edges[0][0]}` depends on `{edges[0][1]}`"
    return diagnostic(
        "G501", source=source, span=place(*edges[0]), labels=labels, cycle=" -> ".join(circle), edge=first
    )


def _weights(
    source: SourceText, declared: Declared, edges: Mapping[str, list[str]], problems: list[Diagnostic]
) -> None:
    """Warn of soft requirements that no hard one precedes, and of weights too small to matter."""
    above = ancestors(edges)
    names = list(edges)
    hard = [name for name in names if declared.requirements[name].strength == "hard"]
    for name in names if hard else []:
        requirement = declared.requirements[name]
        # What depends on such a one, and on no hard one either, is mended with it.
        if requirement.strength == "soft" and not above[name]:
            span = requirement.name.span
            problems.append(diagnostic("G505", source=source, span=span, name=name, hard=hard[0]))
    weights = softmax(dependency_weights(list(above.values())))
    least = _VANISHING * max(weights, default=0.0)
    small = [n for n, w in zip(names, weights, strict=True) if w < least]
    if small:
        shown = ", ".join(f"`{n}`" for n in small[:5]) + (f" and {len(small) - 5} more" if small[5:] else "")
        span = declared.requirements[small[0]].name.span
        problems.append(diagnostic("G507", source=source, span=span, names=shown))
