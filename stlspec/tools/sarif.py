"""Diagnostics as SARIF 2.1.0, which code hosts and editors show at their places.

In: diagnostics. Out: the log as a document. Regions count in code points, as `columnKind` says; the rules are those
rows of the catalogue that results refer to, with their explanation and examples.
"""

import os
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

from stlspec import __version__
from stlspec.errors import CATALOGUE, Code, Diagnostic, Fix
from stlspec.source import SourceText, Span

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
VERSION = "2.1.0"


def sarif_log(diagnostics: Sequence[Diagnostic]) -> dict[str, Any]:
    """Return the log of one run. Not in the paper: what SARIF 2.1.0 (OASIS) asks for."""
    codes = sorted({found.code for found in diagnostics})
    places = {code: index for index, code in enumerate(codes)}
    driver = {"name": "stlspec", "version": __version__, "rules": [_rule(CATALOGUE[code]) for code in codes]}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(found, places[found.code]) for found in diagnostics],
    }
    return {"$schema": SCHEMA, "version": VERSION, "runs": [run]}


def _rule(row: Code) -> dict[str, Any]:
    examples = f"Bad:\n\n{_indented(row.bad)}\n\nGood:\n\n{_indented(row.good)}"
    return {
        "id": row.code,
        "shortDescription": {"text": row.title},
        "fullDescription": {"text": row.explanation},
        "help": {"text": f"{row.explanation}\n\n{examples}", "markdown": f"{row.explanation}\n\n{examples}"},
        "defaultConfiguration": {"level": row.level},
    }


def _indented(text: str) -> str:
    return "\n".join(f"    {line}" for line in text.rstrip("\n").split("\n"))


def _result(found: Diagnostic, index: int) -> dict[str, Any]:
    text = f"{found.message}; help: {found.help}" if found.help else found.message
    result: dict[str, Any] = {
        "ruleId": found.code,
        "ruleIndex": index,
        "level": found.severity,
        "message": {"text": text},
    }
    if found.file is not None:
        result["locations"] = [{"physicalLocation": _place(found.file, found.source, found.span)}]
    if found.labels:
        result["relatedLocations"] = [
            {"id": i, "physicalLocation": _place(x.source.name, x.source, x.span), "message": {"text": x.text}}
            for i, x in enumerate(found.labels)
        ]
    if found.fixes and found.source is not None:
        result["fixes"] = [_fix(fix, found.source) for fix in found.fixes]
    return result


def _place(file: str, source: SourceText | None, span: Span | None) -> dict[str, Any]:
    place: dict[str, Any] = {"artifactLocation": {"uri": uri(file)}}
    if source is not None and span is not None:
        place["region"] = _region(source, span)
    return place


def _region(source: SourceText, span: Span) -> dict[str, int]:
    start, end = source.position(span.start), source.position(span.end)
    return {"startLine": start.line, "startColumn": start.column, "endLine": end.line, "endColumn": end.column}


def _fix(fix: Fix, source: SourceText) -> dict[str, Any]:
    replacements = [
        {"deletedRegion": _region(source, edit.span), "insertedContent": {"text": edit.text}} for edit in fix.edits
    ]
    changes = [{"artifactLocation": {"uri": uri(source.name)}, "replacements": replacements}]
    return {"description": {"text": fix.title}, "artifactChanges": changes}


def uri(file: str) -> str:
    """Return the URI of a file: relative ones stay relative, with slashes, everything else escaped.

    A path that is no UTF-8 text keeps its bytes.
    """
    path = PurePath(file)
    return path.as_uri() if path.is_absolute() else quote(os.fsencode(path.as_posix()))
