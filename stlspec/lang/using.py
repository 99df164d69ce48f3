"""The files that a spec uses: found, read and parsed, each once, before the formulas that name what they declare.

In: the text of a spec, and a function that reads the text behind a path; an editor hands in one that prefers its
open buffers. Out: the `Syntax` of the spec with that of every file it uses. What a file sees is what it and the
files it uses declare, never what stands in the file that uses it: so a file reads the same wherever it is used.
"""

import os
from collections.abc import Callable, Mapping
from dataclasses import replace

from stlspec.errors import Diagnostic, InputError, Label, diagnostic
from stlspec.lang.nodes import UseStatement
from stlspec.lang.parse import Syntax, parse
from stlspec.source import SourceText

Loader = Callable[[str], SourceText]
"""Reads the spec behind a path. Raises InputError: it cannot."""

Parser = Callable[[SourceText, frozenset[str]], Syntax]
"""Parses one text, given names that are declared elsewhere, as `parse.parse` does."""

MOST_FILES = 100
MOST_TEXT = 16 * 2**20
"""How many files, and characters in all, a spec may use."""


def resolve(using: str, path: str) -> str:
    """Return where `use "path"` looks: beside the file that says so.

    Not in the paper: file formats.

    Args:    using: the name of the using file. path: as written.
    Returns: a path that can be opened; without `..` where that leads to the same file.
    """
    joined = os.path.join(os.path.dirname(using), path)  # noqa: PTH118, PTH120 - `Path` would lose `./` and `//`
    short = os.path.normpath(joined)
    return short if identity(short) == identity(joined) else joined


def identity(path: str) -> str:
    """Return what two paths to one file share."""
    return os.path.realpath(path)


def parse_with_uses(source: SourceText, load: Loader | None, parsed: Parser = parse) -> Syntax:
    """Parse a spec and every file that it uses, directly or through others.

    Not in the paper: the language.

    Args:    source: the main file. load: reads the others; None: they cannot be read, which is reported.
             parsed: parses one file, given the names that it sees of others; an editor hands in one that remembers.
    Returns: the syntax of the main file; `uses` holds the files that it names, `used` all of them, each after
             those that it uses itself.
    """
    syntax = parsed(source, frozenset())
    if not any(isinstance(statement, UseStatement) for statement in syntax.statements):
        return syntax
    return _Files(load, parsed).with_uses(syntax, identity(source.name))


class _Files:
    """The files of one spec: those that are parsed, and the `use` statements between the main file and here."""

    def __init__(self, load: Loader | None, parsed: Parser) -> None:
        self._load = load
        self._parse = parsed
        self._parsed: dict[str, Syntax] = {}
        self._open: dict[str, Label] = {}
        self._read = 0

    def with_uses(self, syntax: Syntax, key: str) -> Syntax:
        """Add to a parsed file the files that it uses; parse it again if their names change how it reads."""
        problems: list[Diagnostic] = []
        uses: list[tuple[UseStatement, Syntax]] = []
        failed = False
        for statement in syntax.statements:
            if isinstance(statement, UseStatement):
                self._open[key] = Label(statement.span, "", syntax.source)
                other = self._used(statement, syntax.source, problems)
                failed = failed or other is None or other.lost.nameless
                uses += [(statement, other)] if other is not None else []
        self._open.pop(key, None)
        used = {file.source.name: file for _, direct in uses for file in (*direct.used, direct)}
        names = frozenset[str]().union(*(file.names for file in used.values()))
        if names - syntax.names:
            syntax = self._parse(syntax.source, names)
        lost = replace(syntax.lost, nameless=True) if failed else syntax.lost
        return replace(
            syntax,
            diagnostics=(*syntax.diagnostics, *problems),
            lost=lost,
            uses=tuple(uses),
            used=tuple(used.values()),
        )

    def _used(self, statement: UseStatement, source: SourceText, problems: list[Diagnostic]) -> Syntax | None:
        """Return the file that a statement names; None after a diagnostic."""
        written = statement.path.text
        usable = bool(written.strip()) and "\0" not in written
        path = resolve(source.name, written) if usable else ""
        key = identity(path)
        if key in self._open:
            problems.append(_circle(statement, source, self._open, key))
            return None
        if key not in self._parsed:
            try:
                text = self._text(path)
            except InputError as error:
                first = error.diagnostics[0]
                problem, way = first.message, f"looked for `{path[:80]}`: a path begins at the file that says `use`"
                if first.code != "S092":
                    way = first.help
                span = statement.path.span
                problems.append(diagnostic("N111", source=source, span=span, problem=problem, help=way))
                return None
            syntax = self._parse(text, frozenset())
            stated = tuple(problem for problem in syntax.diagnostics if problem.code != "S016")
            # A file that says nothing yet may be used: "state a requirement" would be wrong advice.
            self._parsed[key] = self.with_uses(replace(syntax, diagnostics=stated), key)
        return self._parsed[key]

    def _text(self, path: str) -> SourceText:
        """Read a file. Raises: InputError: it cannot be read, or the spec has become too large."""
        if self._load is None:
            raise InputError([diagnostic("D880", what="a text has no folder to look in", help=_NO_FOLDER)])
        if not path:
            raise InputError([diagnostic("D880", what="this is no path", help="write the path of a spec file")])
        if len(self._parsed) + len(self._open) > MOST_FILES:
            what = f"a spec uses at most {MOST_FILES} files"
            raise InputError([diagnostic("D880", what=what, help="put some of them together")])
        text = self._load(path)
        self._read += len(text.text)
        if self._read > MOST_TEXT:
            what = f"the files of a spec hold at most {MOST_TEXT} characters"
            raise InputError([diagnostic("D880", what=what, help="split the spec")])
        return text


_NO_FOLDER = 'give the file as `compile(Path("spec.stl"))`, or name the folder: `compile(text, folder=".")`'


def _circle(statement: UseStatement, source: SourceText, opened: Mapping[str, Label], key: str) -> Diagnostic:
    """Report files that use each other; every `use` of the circle is shown."""
    keys = list(opened)
    circle = [opened[k] for k in keys[keys.index(key) :]]
    labels = tuple(Label(place.span, "from here", place.source) for place in circle[:-1])
    names = [os.path.basename(place.source.name) for place in circle]  # noqa: PTH119 - no path, a name to show
    shown = " -> ".join([*names, names[0]])
    return diagnostic("N110", source=source, span=statement.span, labels=labels, circle=shown)
