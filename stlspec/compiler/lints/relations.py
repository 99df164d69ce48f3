"""Requirements beside each other: contradictions, and what another one contains already.

In: a `Subject`. Out: L605 and L606. Both are decided by rules that are sound and not complete: a pair of which
nothing is said may still contradict. Nothing is said of a requirement with a bound that has no value yet.
"""

from collections.abc import Mapping
from itertools import combinations
from typing import Any

from stlspec.compiler.dependencies import ancestors
from stlspec.compiler.lints.entailment import Entailment
from stlspec.compiler.lints.subject import Subject
from stlspec.errors import Diagnostic, Label, diagnostic
from stlspec.lang.nodes import RequirementStatement

_MANY = 100
"""Of more requirements than this only equal ones are found: pairs grow with the square."""


def check_relations(subject: Subject) -> list[Diagnostic]:
    """Compare every requirement with every other one; one warning for each pair, one for each that is contained."""
    requirements = subject.model.declared.requirements
    if len(requirements) > _MANY:
        return []
    known = {name: root for name, root in subject.sketch.roots.items() if root not in subject.sketch.open}
    roots = {name: root for name, root in known.items() if not _is_decided(subject, root)}
    above = _above(requirements)
    rules = Entailment(subject.sketch.nodes, subject.ranges)
    found: list[Diagnostic] = []
    told: set[str] = set()
    for one, other in combinations(roots, 2):
        if rules.excludes(roots[one], roots[other]):
            found.append(_pair(subject, "L605", other, one))
            continue
        for strong, weak in ((one, other), (other, one)):
            same = roots[one] == roots[other]
            graded = requirements[strong].strength == "soft" and not same
            # A soft one may well go further than another: both count, each with its weight.
            if weak in told or weak in above[strong] or graded or not rules.entails(roots[strong], roots[weak]):
                continue
            told.add(weak)
            found.append(_contained(subject, weak, strong, same=same))
            break
    return found


def _is_decided(subject: Subject, root: int) -> bool:
    """Tell whether a formula always or never holds, which is told of its conditions already."""
    low, high = subject.truths[root]
    return low > 0 or high < 0


def _above(requirements: Mapping[str, RequirementStatement]) -> dict[str, frozenset[str]]:
    """Return for each requirement all that it depends on."""
    names = list(requirements)
    edges = {name: list(dict.fromkeys(on.text for on in r.depends_on)) for name, r in requirements.items()}
    bits = ancestors(edges)
    return {name: frozenset(other for i, other in enumerate(names) if bits[name] >> i & 1) for name in names}


def _contained(subject: Subject, name: str, other: str, *, same: bool) -> Diagnostic:
    way = f"remove `{name}`, or write `depends on {name}` in the header of `{other}` if it is a first step to it"
    return _pair(subject, "L606", name, other, help="remove one of them: they mean the same" if same else way)


def _pair(subject: Subject, code: str, name: str, other: str, **fields: Any) -> Diagnostic:
    requirements, source = subject.model.declared.requirements, subject.syntax.source
    place = Label(requirements[other].name.span, f"`{other}` is stated here", source)
    span = requirements[name].name.span
    return diagnostic(code, source=source, span=span, labels=(place,), name=name, other=other, **fields)
