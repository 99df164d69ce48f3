"""One name for another, in every file, or the reason why not.

In: a reviewed buffer, an offset, a new name. Out: edits of texts. Whether the new name would mean something else,
hide a name or be hidden is not guessed: the texts are edited, read again, and must say the same with one name for the
other.
"""

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from stlspec.compiler.compiling import check_syntax
from stlspec.errors import Diagnostic, Edit, Fix, InputError, diagnostic
from stlspec.lang.expected import quoted
from stlspec.lang.parse import Syntax
from stlspec.lang.statements import RESERVED
from stlspec.lang.using import identity
from stlspec.source import SourceText, Span
from stlspec.tools.lsp.navigation import occurrence_at, users
from stlspec.tools.lsp.occurrences import Scope, Target
from stlspec.tools.lsp.workspace import Reviewed, Workspace

_NAME = re.compile(r"[A-Za-z_][A-Za-z_0-9]*\Z", re.ASCII)


@dataclass(frozen=True, slots=True)
class Renamed:
    """The edits of one text."""

    source: SourceText
    edits: tuple[Edit, ...]


def renamable(reviewed: Reviewed, offset: int) -> Span | None:
    """Return the stretch of the name at an offset, if it is one that can be renamed."""
    found = occurrence_at(reviewed.syntax, offset) if reviewed.syntax is not None else None
    return found.span if found is not None else None


def rename(space: Workspace, reviewed: Reviewed, offset: int, new: str) -> tuple[Renamed, ...]:
    """Give what is named at an offset another name, in all files.

    Raises: InputError: N118, the name cannot be given, or it is not clear what it is to be given to.
    """
    syntax = reviewed.syntax
    found = occurrence_at(syntax, offset) if syntax is not None else None
    if syntax is None or found is None:
        raise InputError([diagnostic("N118", what="there is no declared name here", help="go to a name")])
    target = found.target
    if new == target.name:
        return ()
    _allowed(target.name, new)
    roots = users(space, reviewed, syntax, target)
    files = {identity(file.source.name): file for root in reversed(roots) for file in (*root.used, root)}
    for root in roots:
        _free(root, target, new)
    for file in files.values():
        _readable(file, target.name, new)
    edits = {key: _edits(file, target, new) for key, file in files.items()}
    after = {key: Fix("", made).applied(files[key].source.text) for key, made in edits.items() if made}
    for root in roots:
        if not _same(space, root, after, target, new):
            what = f"`{new}` stands for something else where `{target.name}` is used, or would be hidden there"
            raise InputError([_refusal(target.name, new, what)])
    return tuple(Renamed(files[key].source, made) for key, made in edits.items() if made)


def _refusal(old: str, new: str, reason: str, way: str = "choose another name") -> Diagnostic:
    return diagnostic("N118", what=f"`{old}` cannot become {quoted(new)}: {reason}", help=way)


def _allowed(old: str, new: str) -> None:
    if new in RESERVED:
        raise InputError([_refusal(old, new, "it is a word of the language")])
    if _NAME.match(new) is None:
        way = "a name is made of letters a to z, digits and `_`, and begins with no digit"
        raise InputError([_refusal(old, new, "that is no name", way)])


def _free(root: Syntax, target: Target, new: str) -> None:
    """Refuse a name that is declared where the target is seen; the arguments of templates are left to `_same`."""
    declared = Scope.of(root).declared.get(new)
    if declared is None or target.kind == "argument":
        return
    file, statement = declared
    place = file.source.position(statement.name.span.start)
    raise InputError([_refusal(target.name, new, f"that is declared at {file.source.name}:{place.line}")])


def _readable(file: Syntax, old: str, new: str) -> None:
    """Refuse where a statement that cannot be parsed has one of the names: it may mean what is renamed."""
    stretches = sorted([s.span for s in file.statements] + [c.span for c in file.comments])
    for match in re.finditer(rf"\b(?:{old}|{new})\b", file.source.text):
        if not any(span.start <= match.start() < span.end for span in stretches):
            line = file.source.position(match.start()).line
            what = f"what stands at {file.source.name}:{line} cannot be read, and may mean it"
            raise InputError([_refusal(old, new, what, "mend the statement there first")])


def _edits(file: Syntax, target: Target, new: str) -> tuple[Edit, ...]:
    return tuple(Edit(o.span, new) for o in Scope.of(file).occurrences() if o.target == target)


def _same(space: Workspace, root: Syntax, after: Mapping[str, str], target: Target, new: str) -> bool:
    """Tell whether a spec says the same after the edits, with one name for the other."""
    edited = space.parsed(root.source.name, after)
    if _said(root, target, new) != _said(edited, None, new):
        return False
    codes = [Counter(d.code for d in check_syntax(syntax).diagnostics) for syntax in (root, edited)]
    return codes[0] == codes[1]


def _said(root: Syntax, target: Target | None, new: str) -> list[tuple[object, ...]]:
    """Return what each name of a spec stands for: the how-manieth declaration of which file, and its kind and name."""
    files = (*root.used, root)
    found = {identity(file.source.name): Scope.of(file).occurrences() for file in files}
    order = {(key, o.span.start): i for key, occurrences in found.items() for i, o in enumerate(occurrences)}
    return [
        (o.target.kind, new if o.target == target else o.target.name, o.target.file, order[o.target.file, o.target.at])
        for occurrences in found.values()
        for o in occurrences
    ]
