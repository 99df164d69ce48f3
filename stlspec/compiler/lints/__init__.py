"""Static analysis that knows temporal logic: what a spec says, and hardly means.

In: a spec without errors. Out: warnings. Each family of lints is a module; the passes are the tuple `PASSES`,
in the order in which they run.
"""

from collections.abc import Callable

from stlspec.compiler.lints.first_sample import check_first_sample
from stlspec.compiler.lints.predicates import check_predicates
from stlspec.compiler.lints.relations import check_relations
from stlspec.compiler.lints.shapes import check_shapes
from stlspec.compiler.lints.spelled import check_spelling
from stlspec.compiler.lints.stepwise import check_stepwise
from stlspec.compiler.lints.subject import Subject, make_subject
from stlspec.compiler.lints.unused import check_unused
from stlspec.compiler.model import Model
from stlspec.errors import Diagnostic
from stlspec.lang.parse import Syntax

__all__ = ["PASSES", "lint"]

PASSES: tuple[Callable[[Subject], list[Diagnostic]], ...] = (
    check_predicates,
    check_relations,
    check_stepwise,
    check_shapes,
    check_first_sample,
    check_spelling,
    check_unused,
)


def lint(syntax: Syntax, model: Model) -> tuple[Diagnostic, ...]:
    """Return the warnings on the main file of a spec that has no errors.

    Not in the paper: it supposes that specs say what is meant.
    """
    subject = make_subject(syntax, model)
    found = [problem for run in PASSES for problem in run(subject)]
    return tuple(sorted(dict.fromkeys(found), key=Diagnostic.sort_key))
