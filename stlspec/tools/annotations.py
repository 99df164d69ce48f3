"""Diagnostics as workflow commands of GitHub Actions, which shows them beside the changed lines.

In: a diagnostic. Out: one line. What users write is escaped, so that no text of a spec can end a command and begin
another.
"""

from stlspec.errors import Diagnostic

_MESSAGE = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A"})
_PROPERTY = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A", ":": "%3A", ",": "%2C"})


def annotation(found: Diagnostic) -> str:
    """Return the workflow command for a diagnostic. Not in the paper: what GitHub Actions reads from a log."""
    properties = {"title": f"stlspec {found.code}"}
    if found.file is not None:
        properties["file"] = found.file
    if found.source is not None and found.span is not None:
        start, end = found.source.position(found.span.start), found.source.position(found.span.end)
        properties |= {"line": str(start.line), "endLine": str(end.line), "col": str(start.column)}
        if start.line == end.line:  # columns are shown within one line only
            properties["endColumn"] = str(end.column)
    said = ",".join(f"{key}={value.translate(_PROPERTY)}" for key, value in properties.items())
    text = f"{found.message}\nhelp: {found.help}" if found.help else found.message
    return f"::{found.severity} {said}::{text.translate(_MESSAGE)}"
