"""`score SPEC -`: one recording from stdin, in memory that does not grow with it.

In: a spec, CSV on stdin, options. Out: a ranking of one. Options that need the whole recording, or several, are refused
before the first sample is read.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from stlspec.cli.options import standard_input
from stlspec.errors import UsageError, diagnostic

if TYPE_CHECKING:
    from stlspec.api import Bundle
    from stlspec.sampling import OnNan
    from stlspec.scores import Ranking

STDIN = "-"


def check_stdin(demonstrations: Sequence[str], options: Mapping[str, object]) -> None:
    """Refuse what one pass over one recording cannot serve.

    Args:   demonstrations: as given, `-` among them. options: by name; those that were not given are falsy.
    Raises: UsageError D880.
    """
    given = [name for name, value in options.items() if value]
    what, way = "", ""
    if len(demonstrations) > 1:
        what, way = "`-` is one recording, on its own", "leave out the other files, or score them without `-`"
    elif given:
        what = f"`{given[0]}` does not go with `-`: stdin is one recording, read once and not kept"
        way = "leave it out, or score a file"
    if what:
        raise UsageError([diagnostic("D880", what=what, help=way)])


def score_stdin(bundle: "Bundle", end: str, on_nan: "OnNan") -> "Ranking":
    """Score what comes on stdin. Arguments and errors as for `many.stream.score_stream`."""
    from stlspec.many.stream import score_stream

    return score_stream(bundle, standard_input(), end=end, on_nan=on_nan)
