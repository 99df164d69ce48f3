"""Spellings that other tools read in another way.

In: a `Subject`. Out: L613, one for each formula, at its first such place, with the brackets as edits.
"""

from stlspec.compiler.lints.subject import Subject
from stlspec.errors import Diagnostic, Edit, diagnostic
from stlspec.lang.formatting.expressions import SIGNS, tools_disagree
from stlspec.lang.nodes import Expression, Infix, LetStatement, RequirementStatement, post_order
from stlspec.source import Span


def check_spelling(subject: Subject) -> list[Diagnostic]:
    """Report the mixes without brackets on which tools disagree; templates too, since only the text counts."""
    found = []
    for statement in subject.syntax.statements:
        match statement:
            case LetStatement(body=root) | RequirementStatement(formula=root):
                found += _mixes(subject, root)
    return found


def _mixes(subject: Subject, root: Expression) -> list[Diagnostic]:
    places = [
        (child.span, parent)
        for parent in post_order(root)
        if isinstance(parent, Infix)
        for i, child in enumerate(parent.operands)
        if tools_disagree(parent, child, last=i == len(parent.operands) - 1)
    ]
    if not places:
        return []
    edits = [Edit(Span(span.start, span.start), "(") for span, _ in places]
    edits += [Edit(Span(span.end, span.end), ")") for span, _ in places]
    edits.sort(key=lambda edit: (edit.span.start, edit.text == "("))
    span, parent = min(places, key=lambda place: (place[0].start, -place[0].end))
    word = parent.operators[0].word
    return [
        diagnostic(
            "L613",
            source=subject.syntax.source,
            span=span,
            edits=tuple(edits),
            text=subject.text(parent.span),
            child=subject.text(span),
            word=SIGNS.get(word, word),
        )
    ]
