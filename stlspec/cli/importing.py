"""The command on specs of other tools: import.

In: the file of an RTAMT or Breach spec. Out: the text of a spec on stdout, differences on stderr; or, if something
cannot be carried over, every such construct with its place.
"""

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from stlspec.cli.options import FormatOption
from stlspec.cli.output import Format, print_json, warn
from stlspec.compiler import files


class Tool(StrEnum):
    """Whose language a file is in."""

    RTAMT = "rtamt"
    BREACH = "breach"


def import_spec(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="a spec of RTAMT, or of Breach or STLRom")],
    tool: Annotated[Tool | None, typer.Option("--from", help="whose it is, where the text does not tell")] = None,
    time: Annotated[
        str | None, typer.Option("--time", metavar="TIME", help="as in a spec: step, s, '100 ms'; the tool's default")
    ] = None,
    output: FormatOption = Format.TEXT,
) -> None:
    """Translate a spec of another tool; exit with 1 if a construct cannot be carried over."""
    from stlspec.tools.importing.conversion import convert

    found = convert(files.read_source(file), tool.value if tool is not None else None, time)
    if output is Format.JSON:
        warnings = [warning.to_json() for warning in found.warnings]
        print_json({"schema": "stlspec.import/1", "from": found.tool, "text": found.text, "diagnostics": warnings})
        return
    warn(found.warnings)
    sys.stdout.write(found.text)
