"""From a name to where it is declared, and to all places where it stands.

In: a reviewed buffer and an offset. Out: stretches of texts. The path of a `use` leads to the file.
"""

from dataclasses import dataclass

from stlspec.lang.parse import Syntax
from stlspec.lang.using import identity
from stlspec.source import SourceText, Span
from stlspec.tools.lsp.cursor import token_at
from stlspec.tools.lsp.occurrences import Occurrence, Scope, Target, at
from stlspec.tools.lsp.workspace import Reviewed, Workspace


@dataclass(frozen=True, slots=True)
class Found:
    """A stretch of one of the files."""

    source: SourceText
    span: Span


def occurrence_at(syntax: Syntax, offset: int) -> Occurrence | None:
    """Return the name at an offset with what it stands for; in a broken statement, what it would stand for."""
    scope = Scope.of(syntax)
    found = at(scope.occurrences(), offset)
    if found is not None or any(s.span.start <= offset <= s.span.end for s in syntax.statements):
        return found
    token = token_at(syntax.source, offset)
    target = scope.target(token.text) if token is not None else None
    return Occurrence(token.span, target) if token is not None and target is not None else None


def definition(reviewed: Reviewed, offset: int) -> Found | None:
    """Return where the name at an offset is declared, or the file that a `use` there names."""
    syntax = reviewed.syntax
    if syntax is None:
        return None
    for use, used in syntax.uses:
        if use.path.span.start <= offset <= use.path.span.end:
            return Found(used.source, Span(0, 0))
    found = occurrence_at(syntax, offset)
    if found is None:
        return None
    return declared(syntax, found.target)


def declared(syntax: Syntax, target: Target) -> Found | None:
    """Return where a target is declared, in a file or one that it uses."""
    span = Span(target.at, target.at + len(target.name))
    for file in (syntax, *syntax.used):
        if identity(file.source.name) == target.file:
            return Found(file.source, span)
    return None


def users(space: Workspace, reviewed: Reviewed, syntax: Syntax, target: Target) -> tuple[Syntax, ...]:
    """Return the specs in which a target may be named: the one at hand first, then others that use its file.

    Raises: InputError: the folders hold too many files to look through.
    """
    if target.kind in ("argument", "requirement") or not reviewed.document.is_file:
        return (syntax,)
    others = (root for root in space.roots(target.file) if root is not syntax)
    return (syntax, *(root for root in others if _holds(root, target.file)))


def _holds(root: Syntax, file: str) -> bool:
    return any(identity(part.source.name) == file for part in (root, *root.used))


def references(space: Workspace, reviewed: Reviewed, offset: int) -> tuple[tuple[Found, bool], ...]:
    """Return every place where the name at an offset stands, in all files, and whether it is declared there."""
    syntax = reviewed.syntax
    found = occurrence_at(syntax, offset) if syntax is not None else None
    if syntax is None or found is None:
        return ()
    files: dict[str, Syntax] = {}
    for root in users(space, reviewed, syntax, found.target):
        for file in (root, *root.used):
            files.setdefault(identity(file.source.name), file)
    return tuple(
        (Found(file.source, occurrence.span), occurrence.declares)
        for file in files.values()
        for occurrence in Scope.of(file).occurrences()
        if occurrence.target == found.target
    )
