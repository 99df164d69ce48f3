"""Options that several commands share, and how their texts are read.

In: words of the command line. Out: mappings and environments, or a usage diagnostic that names the word.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, BinaryIO, TextIO

import typer

from stlspec.cli.output import Format
from stlspec.errors import UsageError, diagnostic

Params = Annotated[
    list[str] | None,
    typer.Option("--param", "-p", metavar="NAME=VALUE", help="bind a param; may be repeated"),
]
FormatOption = Annotated[Format, typer.Option("--format", help="text for a person, json for a program")]

MANY = ("--demos",)
"""Options that take every path up to the next option."""


def standard_input() -> BinaryIO:
    """Return stdin.

    Raises: UsageError D880: whoever started this has closed it.
    """
    stream: TextIO | None = sys.stdin
    if stream is None:
        raise UsageError([diagnostic("D880", what="stdin is closed", help="pipe something in, or use < FILE")])
    return stream.buffer


def spare_inputs(out: Path, inputs: Sequence[str | Path], option: str = "-o") -> None:
    """Refuse to write a result over one of the files that it is made from.

    Raises: UsageError: `out` is one of `inputs`, under whatever name.
    """
    for path in inputs:
        if out.exists() and Path(path).exists() and out.samefile(path):
            what = f"`{option} {out}` is one of the inputs, and would be overwritten"
            raise UsageError([diagnostic("D880", what=what, help="choose another file for the result")])


def read_params(given: Sequence[str] | None) -> dict[str, str]:
    """Read `-p NAME=VALUE` options; the last one of a name counts."""
    values: dict[str, str] = {}
    for text in given or ():
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            what = f"`-p {text[:40]}` binds nothing"
            raise UsageError([diagnostic("D880", what=what, help="write -p NAME=VALUE")])
        values[name.strip()] = value.strip()
    return values


def expand_many(arguments: Sequence[str]) -> list[str]:
    """Repeat the options of `MANY` before each of their paths: `--demos a b` becomes `--demos a --demos b`."""
    expanded: list[str] = []
    current, fresh = "", False
    for word in arguments:
        if word in MANY:
            current, fresh = word, True
        elif current and (not word.startswith("-") or word == "-"):
            expanded += [current, word]
            fresh = False
        else:
            expanded += [current, word] if fresh else [word]
            current, fresh = "", False
    return [*expanded, current] if fresh else expanded
