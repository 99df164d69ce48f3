"""The catalogue of diagnostic codes, and the one function that makes a diagnostic from it.

Codes: S0xx syntax, N1xx names, T2xx types, U3xx units, I4xx intervals, G5xx graph, L6xx lint, B7xx bundle,
D8xx data and environments, X9xx internal.
"""

from types import MappingProxyType
from typing import Any

from stlspec.errors import (
    data,
    files,
    graph,
    inputs,
    intervals,
    learning,
    lints,
    monitoring,
    names,
    recording,
    syntax,
    types,
)
from stlspec.errors.model import (
    BundleError,
    Code,
    DataError,
    Diagnostic,
    Edit,
    Fix,
    InputError,
    Label,
    Severity,
    SpecError,
    StlspecError,
    UsageError,
    render,
)
from stlspec.source import SourceText, Span

__all__ = [
    "CATALOGUE",
    "BundleError",
    "Code",
    "DataError",
    "Diagnostic",
    "Edit",
    "Fix",
    "InputError",
    "Label",
    "Severity",
    "SpecError",
    "StlspecError",
    "UsageError",
    "diagnostic",
    "render",
]

_PARTS = (syntax, names, types, intervals, graph, lints, files, data, inputs, learning, monitoring, recording)

CATALOGUE = MappingProxyType({row.code: row for part in _PARTS for row in part.CODES})
"""Every code with its row, in the order of the codes."""


def diagnostic(
    code: str,
    *,
    source: SourceText | None = None,
    span: Span | None = None,
    file: str | None = None,
    labels: tuple[Label, ...] = (),
    edits: tuple[Edit, ...] = (),
    **fields: Any,
) -> Diagnostic:
    """Make the diagnostic `code` at a place, its templates filled with `fields`.

    edits: what the help says, for a program to do; titled with the help.
    """
    row = CATALOGUE[code]
    way = row.help.format(**fields)
    return Diagnostic(
        code=code,
        severity=row.level,
        message=row.message.format(**fields),
        file=source.name if source is not None else file,
        source=source,
        span=span,
        label=row.label.format(**fields),
        help=way,
        labels=labels,
        fixes=(Fix(way or row.title, edits),) if edits else (),
    )
