"""Diagnostics and the exceptions that carry them.

    StlspecError            .diagnostics, .exit_code
    ├── SpecError           1  the text of a spec has errors
    └── InputError          2  an input cannot be used
        ├── BundleError     2  B7xx: a bundle is damaged, foreign or of another version
        ├── DataError       2  D8xx: a demonstration or trace cannot be used
        └── UsageError      2  the command line or a call asks for something impossible

One row of the catalogue owns a code: its level and all its wording. `diagnostic` fills the row's templates;
nothing else writes a message, so wording stays in one place.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, Literal

from stlspec.source import SourceText, Span

Severity = Literal["error", "warning"]


@dataclass(frozen=True, slots=True)
class Code:
    """One row of the catalogue.

    message, label and help are templates for `str.format`; label stands beside the carets, help is the way
    out; both may be empty. explanation, bad and good are shown by `stlspec explain` and run by the tests.
    kind says what bad and good are: a spec, data (CSV) for a standard spec, or only an illustration.
    """

    code: str
    title: str
    level: Severity
    message: str
    explanation: str
    bad: str
    good: str
    label: str = ""
    help: str = ""
    kind: Literal["spec", "data", "shown"] = "spec"


@dataclass(frozen=True, slots=True)
class Label:
    """A second place that a diagnostic points at, such as "declared here"."""

    span: Span
    text: str
    source: SourceText


@dataclass(frozen=True, slots=True)
class Edit:
    """A stretch of the diagnostic's source and the text to write in its place; an empty stretch is an insertion."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A way out that a program can take: the help as edits, ordered by place, none overlapping another."""

    title: str
    edits: tuple[Edit, ...]

    def applied(self, text: str) -> str:
        """Return `text`, which is that of the diagnostic's source, with the edits made."""
        for edit in reversed(self.edits):
            text = text[: edit.span.start] + edit.text + text[edit.span.end :]
        return text


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One thing that is wrong, where, why, and the way out.

    source and span are None when the place is not in a spec; file then names the input, if there is one. Each of
    fixes is a way out by itself, the likeliest first; there is none where only the author knows what was meant.
    """

    code: str
    severity: Severity
    message: str
    file: str | None = None
    source: SourceText | None = None
    span: Span | None = None
    label: str = ""
    help: str = ""
    labels: tuple[Label, ...] = ()
    fixes: tuple[Fix, ...] = ()

    def also_at(self, span: Span) -> "Diagnostic":
        """Return this diagnostic with the edit of its first fix made at a later place too."""
        if not self.fixes:
            return self
        first, *others = self.fixes
        again = Fix(first.title, (*first.edits, Edit(span, first.edits[0].text)))
        return replace(self, fixes=(again, *others))

    def sort_key(self) -> tuple[str, int, str]:
        """Order by file, then place, then code."""
        return (self.file or "", self.span.start if self.span else -1, self.code)

    def to_json(self) -> dict[str, Any]:
        """Return the diagnostic as the `stlspec.check/1` document has it; unknown places are null."""
        return {
            "code": self.code,
            "severity": self.severity,
            "message": self.message,
            "file": self.file,
            **_place(self.source, self.span),
            "help": self.help or None,
            "labels": [{"message": x.text, "file": x.source.name, **_place(x.source, x.span)} for x in self.labels],
            "fixes": [self._fix_to_json(fix) for fix in self.fixes],
        }

    def _fix_to_json(self, fix: Fix) -> dict[str, Any]:
        edits = [{**_place(self.source, edit.span), "text": edit.text} for edit in fix.edits]
        return {"title": fix.title, "edits": edits}


def _place(source: SourceText | None, span: Span | None) -> dict[str, int | None]:
    if source is None or span is None:
        return dict.fromkeys(("line", "column", "end_line", "end_column"))
    start, end = source.position(span.start), source.position(span.end)
    return {
        "line": start.line,
        "column": start.column,
        "end_line": end.line,
        "end_column": end.column,
    }


def _plain(text: str, _role: str) -> str:
    return text


def render(diagnostic: Diagnostic, paint: Callable[[str, str], str] = _plain) -> str:
    """Draw a diagnostic for a person: head, place, excerpt with carets, second places, help.

    paint(text, role) may colour a piece; roles are "error", "warning", "place", "caret", "help".
    """
    head = paint(f"{diagnostic.severity}[{diagnostic.code}]", diagnostic.severity)
    lines = [f"{head}: {diagnostic.message}"]
    if diagnostic.source is not None and diagnostic.span is not None:
        lines += _drawn(diagnostic.source, diagnostic.span, diagnostic.label, diagnostic.severity, paint)
    elif diagnostic.file is not None:
        lines.append(f"  {paint('-->', 'place')} {diagnostic.file}")
    for extra in diagnostic.labels:
        lines += _drawn(extra.source, extra.span, extra.text, "caret", paint)
    if diagnostic.help:
        lines.append(f"     {paint('= help:', 'help')} {diagnostic.help}")
    return "\n".join(lines)


def _drawn(source: SourceText, span: Span, note: str, role: str, paint: Callable[[str, str], str]) -> list[str]:
    at = source.position(span.start)
    text, carets = source.excerpt(span, note)
    return [
        f"  {paint('-->', 'place')} {source.name}:{at.line}:{at.column}",
        text,
        paint(carets, role),
    ]


class StlspecError(Exception):
    """Anything that a user can cause; carries the diagnostics and the exit code of the command line."""

    exit_code = 1

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__("\n".join(render(d) for d in self.diagnostics))

    def __reduce__(self) -> tuple[type["StlspecError"], tuple[tuple[Diagnostic, ...]]]:
        """Let an error travel between processes: made again from its diagnostics, not from its text."""
        return type(self), (self.diagnostics,)


class SpecError(StlspecError):
    """The text of a spec has errors."""


class InputError(StlspecError):
    """An input cannot be used."""

    exit_code = 2


class BundleError(InputError):
    """A bundle is damaged, was tampered with, or is of another version."""


class DataError(InputError):
    """A demonstration or a trace cannot be used."""


class UsageError(InputError):
    """The command line or a call asks for something that cannot be done."""
