"""From a foreign spec to the text of one of this language.

In: the text of an RTAMT or Breach spec. Out: a `Conversion`, or every diagnostic with its place in the foreign text:
the translated statements keep the places that they came from, so the checks of this language speak of these too.
"""

import re
from dataclasses import dataclass

from stlspec.compiler.checks import check
from stlspec.errors import Diagnostic, SpecError, UsageError, diagnostic
from stlspec.lang.formatting.text import format_text
from stlspec.lang.nodes import LetStatement, ParamStatement, RequirementStatement, SignalStatement, Statement
from stlspec.lang.parse import Syntax, parse
from stlspec.source import SourceText
from stlspec.tools.importing import breach, rtamt
from stlspec.tools.importing.model import refuse_broken
from stlspec.tools.importing.python import looks_like_program
from stlspec.tools.importing.writing import spec_text

READERS = {"rtamt": rtamt.read, "breach": breach.read}
_BREACH = re.compile(r":=|\b(?:alw|ev)(?:_\s*\[)?\b|\[\s*t\s*\]|^\s*(?:(?:in|out)put\s+)?signal\s+\w+\s*,", re.M)

_REMARKS = re.compile(r"/\*.*?\*/|(?:#|//|%)[^\n]*", re.S)
"""What any of the tools takes for a comment."""
_COMMENTS = re.compile(r"^\s*(?:#|//|%)[^\n]*", re.M)


@dataclass(frozen=True, slots=True)
class Conversion:
    """A foreign spec as text of this language. tool: whose it was. syntax: its statements, with foreign places."""

    tool: str
    text: str
    syntax: Syntax
    warnings: tuple[Diagnostic, ...]


def convert(source: SourceText, tool: str | None = None, time: str | None = None) -> Conversion:
    """Translate a foreign spec.

    Not in the paper: other tools' languages.

    Args:    tool: "rtamt" or "breach"; None: told by the text. time: how time is measured, as after `time` in a
             spec; None: what the tool takes by default.
    Raises:  SpecError: it cannot be read, or something in it cannot be carried over. UsageError: no such tool.
    """
    if tool is not None and tool not in READERS:
        what = f"there is no tool '{tool[:30]}' to import from"
        raise UsageError([diagnostic("D880", what=what, help=f"write one of {', '.join(READERS)}")])
    if not _COMMENTS.sub("", source.text).strip():
        what, way = "there is nothing here but comments", "is this the right file?"
        raise SpecError([diagnostic("S043", file=source.name, what=what, help=way)])
    if tool is None:
        _refuse_own(source)
        program = looks_like_program(source)
        tool = "breach" if _BREACH.search(_REMARKS.sub("", source.text)) and not program else "rtamt"
    draft = READERS[tool](source, time)
    if not draft.problems and not draft.assigned:
        what = f"no formula of {draft.tool} is here"
        raise SpecError([diagnostic("S043", file=source.name, what=what, help="is this the right file?")])
    refuse_broken(draft.problems)
    statements = draft.statements()
    refuse_broken(draft.problems)
    syntax = _syntax(source, statements)
    refuse_broken([*draft.problems, *check(syntax)[1]])
    warnings = tuple(sorted(draft.problems, key=Diagnostic.sort_key))
    return Conversion(tool, format_text(spec_text(statements, draft.comments)), syntax, warnings)


def _refuse_own(source: SourceText) -> None:
    """Refuse a spec of this language."""
    if any(isinstance(statement, RequirementStatement) for statement in parse(source).statements):
        what, way = "this is a spec of this language already", "check it with `stlspec check`"
        raise SpecError([diagnostic("S043", file=source.name, what=what, help=way)])


def _syntax(source: SourceText, statements: list[Statement]) -> Syntax:
    declaring = (SignalStatement, ParamStatement, LetStatement)
    names = frozenset(s.name.text for s in statements if isinstance(s, declaring))
    required = frozenset(s.name.text for s in statements if isinstance(s, RequirementStatement))
    return Syntax(source, tuple(statements), (), (), names, required)
