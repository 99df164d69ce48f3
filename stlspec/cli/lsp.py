"""The command lsp: the language server, for an editor to start.

In: messages of the protocol on stdin. Out: messages on stdout, and nothing else there; the log goes to stderr.
"""

import os
import sys
from typing import Annotated, BinaryIO

import typer

from stlspec.cli.options import standard_input
from stlspec.errors import UsageError, diagnostic


def lsp(
    stdio: Annotated[bool, typer.Option("--stdio", hidden=True, help="what editors add; there is no other way")] = True,
) -> None:
    """Serve editors with diagnostics, hover, completion and more as one types; an editor starts this itself."""
    try:
        from stlspec.tools.lsp.session import serve
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] in ("pygls", "lsprotocol", "cattrs", "attrs"):
            raise UsageError([diagnostic("D847", what="the language server", extra="lsp")]) from None
        raise
    assert stdio
    if standard_input().isatty():
        print("this is for an editor to start: it waits for messages on stdin; Ctrl-C ends it", file=sys.stderr)
    with _stdout_apart() as out:

        def write(data: bytes) -> None:
            out.write(data)
            out.flush()

        code = serve(lambda most: os.read(0, most), write)
    raise typer.Exit(code)


def _stdout_apart() -> BinaryIO:
    """Return what stdout was; it is stderr from now on, since what a library may print is no message."""
    sys.stdout.flush()
    if sys.stderr is None:  # closed by whoever started this: its number must not be given to another stream
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return out
