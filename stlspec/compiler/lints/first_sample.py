"""Requirements that look at the first sample of a trace alone.

In: a `Subject`. Out: L611 where operators of the past see nothing but that sample, L620 where no operator of time
stands at all, each with the two operators that are commonly meant as fixes: which one, only the author knows.
"""

from dataclasses import replace

from stlspec.compiler.ir import FUTURE, PAST
from stlspec.compiler.lints.subject import Subject
from stlspec.errors import Diagnostic, Edit, Fix
from stlspec.lang.nodes import Call, Expression, Group, Name
from stlspec.source import Span

_MEANT = ("always", "eventually")


def check_first_sample(subject: Subject) -> list[Diagnostic]:
    """Judge every requirement by the operators of time that its formula has, those of its lets included."""
    signal, past, future = _uses(subject)
    found = []
    for name, root in subject.sketch.roots.items():
        formula = subject.model.declared.requirements[name].formula
        if future[root] or not (past[root] or signal[root]):
            continue
        problem = subject.warn("L611" if past[root] else "L620", formula.span, name=name, **_help(subject, formula))
        ways = tuple(Fix(f"write `{word} (...)`", _around(formula, word)) for word in _MEANT)
        found.append(replace(problem, fixes=ways))
    return found


def _uses(subject: Subject) -> tuple[list[bool], list[bool], list[bool]]:
    """Tell of each node whether a signal, an operator of the past and one of the future occur in it."""
    signal, past, future = list[bool](), list[bool](), list[bool]()
    for node in subject.sketch.nodes:
        # A param without a value is a node like a signal.
        measured = node.op in ("signal", "bool") and node.value in subject.model.signals
        for found, here in ((signal, measured), (past, node.op in PAST), (future, node.op in FUTURE)):
            found.append(here or any(found[child] for child in node.children))
    return signal, past, future


def _help(subject: Subject, formula: Expression) -> dict[str, str]:
    opening = _opening(formula, _MEANT[0])
    return {"meant": opening + subject.text(formula.span) + _closing(opening)}


def _around(formula: Expression, word: str) -> tuple[Edit, ...]:
    """Return the edits that put a formula under an operator."""
    opening, (start, end) = _opening(formula, word), (formula.span.start, formula.span.end)
    edits = (Edit(Span(start, start), opening), Edit(Span(end, end), _closing(opening)))
    return tuple(edit for edit in edits if edit.text)


def _opening(formula: Expression, word: str) -> str:
    return f"{word} " if isinstance(formula, Group | Name | Call) else f"{word} ("


def _closing(opening: str) -> str:
    return ")" if opening.endswith("(") else ""
