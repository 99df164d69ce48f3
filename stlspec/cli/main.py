"""The entry of the command line: builds the app, runs one command, turns what goes wrong into an exit code.

In: the words of the command line. Out: an exit code. This is the only place that catches everything: a mistake
of the user leaves as a diagnostic, a fault of stlspec as X901 without a traceback.
"""

import errno
import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper
from itertools import pairwise
from typing import Annotated, Any

import typer

from stlspec import __version__
from stlspec.cli import (
    checking,
    conformance,
    data,
    formatting,
    importing,
    language,
    lsp,
    monitoring,
    recording,
    testing,
    training,
)
from stlspec.cli.options import expand_many
from stlspec.cli.output import error_document, print_diagnostics, print_json
from stlspec.errors import Diagnostic, StlspecError, UsageError, diagnostic

INTERNAL, INTERRUPTED = 3, 130
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"stlspec {__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="show the version")
    ] = False,
) -> None:
    """Signal Temporal Logic: check specs, score demonstrations, learn policies."""


def build() -> typer.Typer:
    """Return the app with all commands."""
    names = {"help_option_names": ["-h", "--help"]}
    app = typer.Typer(add_completion=False, rich_markup_mode=None, context_settings=names)
    app.callback()(_root)
    app.command("check")(checking.check)
    app.command("fmt")(formatting.fmt)
    app.command("explain")(language.explain)
    app.command("compile")(language.compile_spec)
    app.command("graph")(language.graph)
    app.command("eval")(data.evaluate_formula)
    app.command("score")(data.score)
    app.command("reward")(data.reward)
    app.command("monitor")(monitoring.monitor)
    app.command("learn")(training.learn)
    app.command("test")(testing.test_specs)
    app.command("import")(importing.import_spec)
    app.command("record")(recording.record)
    app.command("conform")(conformance.conform)
    app.command("lsp")(lsp.lsp)
    return app


def run(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # signs such as ✓ where the terminal has ASCII only
    try:
        # Not `command.main`: it turns Ctrl-C and a closed pipe into exits of its own.
        command = typer.main.get_command(build())
        with command.make_context("stlspec", expand_many(words or ["--help"])) as context:
            command.invoke(context)
        sys.stdout.flush()
    except StlspecError as error:
        return _fail(words, error.exit_code, error.diagnostics)
    except (KeyboardInterrupt, typer.Abort):
        print("interrupted", file=sys.stderr)
        return _fail(words, INTERRUPTED, [])
    except BrokenPipeError:
        # The reader has gone: what remains in the buffer must not raise again at exit.
        _silence_stdout()
        return 0
    except OSError as error:
        if error.errno not in _FULL:
            return _unexpected(words, error)
        _silence_stdout()
        problem = (error.strerror or str(error)).lower()
        found = diagnostic("S092", file="the output", verb="write", problem=problem, help="is there space left?")
        print_diagnostics([found], sys.stderr)
        return UsageError.exit_code
    except typer.Exit as stop:
        return stop.exit_code
    except Exception as error:
        return _unexpected(words, error)
    return 0


def _silence_stdout() -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _unexpected(words: Sequence[str], error: Exception) -> int:
    """Handle what Typer raises for wrong usage, and what should be impossible."""
    if any(base.__name__ == "ClickException" for base in type(error).__mro__):
        message: Any = getattr(error, "format_message", lambda: str(error))()
        if not message:  # no command was given: the help has been shown
            return 2
        what = str(message).splitlines()[0].rstrip(".").replace("Value error, ", "")
        found = diagnostic("D880", what=what[:1].lower() + what[1:], help=_help_hint(words, what))
        return _fail(words, UsageError.exit_code, [found])
    if os.environ.get("STLSPEC_DEBUG"):
        raise error
    problem = f"{type(error).__name__}: {str(error)[:200]}"
    return _fail(words, INTERNAL, [diagnostic("X901", problem=problem)])


def _help_hint(words: Sequence[str], message: str) -> str:
    if "--demos" in words and "SPEC" in message:
        return "`--demos` takes every path up to the next option: put SPEC before it"
    names = {name for app in [build()] for name in (c.name for c in app.registered_commands)}
    command = next((word for word in words if word in names), None)
    return f"see `stlspec {command} --help`" if command else "see `stlspec --help`"


def _wants_json(words: Sequence[str]) -> bool:
    pairs = pairwise([*words, ""])
    return any(word == "--format=json" or (word == "--format" and after == "json") for word, after in pairs)


def _fail(words: Sequence[str], exit_code: int, diagnostics: Sequence[Diagnostic]) -> int:
    if _wants_json(words):
        print_json(error_document(exit_code, diagnostics))
    else:
        print_diagnostics(diagnostics, sys.stderr)
    return exit_code
