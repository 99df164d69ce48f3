"""What the command line prints: diagnostics for a person, JSON documents for a program.

In: diagnostics and documents. Out: text on stdout or stderr. Colours come from typer, so that `check` and
`explain` need nothing heavier; they are left out where the stream is no terminal or NO_COLOR is set.
"""

import json
import os
import sys
from collections.abc import Iterable, Sequence
from enum import StrEnum
from typing import Any, TextIO

import typer

from stlspec.errors import Diagnostic, render


class Format(StrEnum):
    """How a result is printed."""

    TEXT = "text"
    JSON = "json"


class CheckFormat(StrEnum):
    """How diagnostics are printed: for a person, or for programs that know JSON, SARIF, or GitHub Actions."""

    TEXT = "text"
    JSON = "json"
    SARIF = "sarif"
    GITHUB = "github"


class ScoreFormat(StrEnum):
    """How scores are printed."""

    TEXT = "text"
    JSON = "json"
    CSV = "csv"


class GraphFormat(StrEnum):
    """How the graph of requirements is printed."""

    TEXT = "text"
    JSON = "json"
    MERMAID = "mermaid"
    DOT = "dot"


_COLOURS: dict[str, dict[str, Any]] = {
    "error": {"fg": "red", "bold": True},
    "warning": {"fg": "yellow", "bold": True},
    "place": {"fg": "blue", "bold": True},
    "caret": {"fg": "blue"},
    "help": {"fg": "cyan"},
}


def coloured(stream: TextIO) -> bool:
    """Tell whether colours may be written to `stream`."""
    return stream.isatty() and "NO_COLOR" not in os.environ


def print_json(document: Any) -> None:
    """Print one JSON document on stdout, in ASCII, which every terminal and every pipe can carry."""
    print(json.dumps(document, allow_nan=False, indent=2))


def print_diagnostics(diagnostics: Iterable[Diagnostic], stream: TextIO) -> None:
    """Print diagnostics for a person, one blank line between them."""
    paint = _paint if coloured(stream) else None
    for diagnostic in diagnostics:
        text = render(diagnostic, paint) if paint else render(diagnostic)
        print(text, end="\n\n", file=stream)


def _paint(text: str, role: str) -> str:
    return typer.style(text, **_COLOURS.get(role, {}))


def warn(diagnostics: Iterable[Diagnostic]) -> None:
    """Print warnings on stderr, so that results on stdout stay clean."""
    print_diagnostics(diagnostics, sys.stderr)


def error_document(exit_code: int, diagnostics: Sequence[Diagnostic]) -> dict[str, Any]:
    """Return the document that stands for a failed command."""
    return {
        "schema": "stlspec.error/1",
        "exit": exit_code,
        "diagnostics": [d.to_json() for d in diagnostics],
    }
