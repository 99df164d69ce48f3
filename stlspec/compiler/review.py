"""All that is to be said of a text: what `check` shows, and an editor.

In: source text. Out: errors and warnings of the checks and the lints, less what settings and comments leave out.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from stlspec.compiler.compiling import CheckResult, check_syntax
from stlspec.compiler.lints import lint
from stlspec.compiler.selection import Selection
from stlspec.compiler.suppression import suppressed
from stlspec.errors import Diagnostic
from stlspec.lang.parse import Syntax
from stlspec.lang.using import Loader, parse_with_uses
from stlspec.source import SourceText

EVERYTHING = Selection()


@dataclass(frozen=True, slots=True)
class Review:
    """What is reported of a text, in order, and the result of the checks that it stems from."""

    result: CheckResult
    diagnostics: tuple[Diagnostic, ...]


def review_source(
    source: SourceText,
    params: Mapping[str, float | str] | None = None,
    load: Loader | None = None,
    selection: Selection = EVERYTHING,
) -> Review:
    """Check and lint a text.

    Args:    params: values of params. load: reads the files that the text uses. selection: what is reported.
    Raises:  InputError: as `check_source`.
    """
    return review_syntax(parse_with_uses(source, load), params, selection)


def review_syntax(
    syntax: Syntax, params: Mapping[str, float | str] | None = None, selection: Selection = EVERYTHING
) -> Review:
    """Check and lint statements that are parsed; see `review_source`. Lints wait until there are no errors."""
    result = check_syntax(syntax, params)
    found = result.diagnostics
    if not result.errors:
        found = tuple(sorted({*found, *lint(syntax, result.model)}, key=Diagnostic.sort_key))
    return Review(result, selection.applied(suppressed(syntax, found)))
