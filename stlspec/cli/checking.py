"""The command that says what is wrong with specs: check.

In: spec files or bundles. Out: all diagnostics of all files in one run, as text, JSON, SARIF or annotations of
GitHub. Nothing heavy is loaded, unless demonstrations are given to be compared with.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from stlspec.cli.options import Params, read_params
from stlspec.cli.output import CheckFormat, error_document, print_diagnostics, print_json
from stlspec.compiler import bundle_file, files
from stlspec.compiler.compiling import compile_source
from stlspec.compiler.printing import counted
from stlspec.compiler.review import review_source
from stlspec.compiler.selection import configured, override
from stlspec.errors import Diagnostic, InputError

Codes = Annotated[
    list[str] | None,
    typer.Option("--select", metavar="CODES", help="report only these warnings: codes, or their beginnings"),
]


def check(
    specs: Annotated[list[Path], typer.Argument(metavar="FILE...", help="spec files, or compiled bundles")],
    params: Params = None,
    select: Codes = None,
    ignore: Annotated[
        list[str] | None, typer.Option("--ignore", metavar="CODES", help="leave these warnings out; errors stay")
    ] = None,
    deny: Annotated[
        list[str] | None, typer.Option("--deny", metavar="LEVEL", help="`warning`: count warnings as errors")
    ] = None,
    demos: Annotated[
        list[str] | None,
        typer.Option(
            "--demos",
            metavar="PATH...",
            help="also say which signals these demonstrations lack, and where they are shorter than a horizon",
        ),
    ] = None,
    output: Annotated[CheckFormat, typer.Option("--format", help="for a person, or for a program")] = CheckFormat.TEXT,
) -> None:
    """Report everything that is wrong with spec files, in one run."""
    values = read_params(params)
    options = (select, ignore, deny)
    found: list[Diagnostic] = []
    exit_code = 0
    for path in specs:
        try:
            found += _checked(path, values, options, demos or ())
        except InputError as error:
            found += error.diagnostics
            exit_code = 2
    found = list(dict.fromkeys(found))  # a file that is checked and used by another speaks once
    errors = sum(d.severity == "error" for d in found)
    exit_code = max(exit_code, 1 if errors else 0)
    _show(output, found, exit_code, len(specs))
    raise typer.Exit(exit_code)


def _checked(
    path: Path, values: dict[str, str], options: tuple[list[str] | None, ...], demos: Sequence[str]
) -> tuple[Diagnostic, ...]:
    data = files.read_bytes(path, bundle_file.LARGEST)
    selection = override(configured(path), *options)
    if files.looks_like_bundle(path, data):
        files.read_spec(path, values)
        return ()
    source = files.decode(data, str(path))
    review = review_source(source, values, files.read_used, selection)
    if not demos or review.result.errors:
        return review.diagnostics
    from stlspec.tools.coverage import uncovered

    more = uncovered(source, compile_source(source, values, files.read_used), review.result.model, demos)
    return tuple(sorted((*review.diagnostics, *selection.applied(more)), key=Diagnostic.sort_key))


def _show(output: CheckFormat, found: Sequence[Diagnostic], exit_code: int, n_files: int) -> None:
    if output is CheckFormat.JSON:
        document = {"schema": "stlspec.check/1", "diagnostics": [d.to_json() for d in found]}
        print_json(error_document(exit_code, found) if exit_code == 2 else document)
    elif output is CheckFormat.SARIF:
        from stlspec.tools.sarif import sarif_log

        print_json(sarif_log(found))
    elif output is CheckFormat.GITHUB:
        from stlspec.tools.annotations import annotation

        print("".join(f"{annotation(problem)}\n" for problem in found), end="")
    else:
        print_diagnostics(found, sys.stdout)
        errors = sum(d.severity == "error" for d in found)
        print(_summary(errors, len(found) - errors, n_files))


def _summary(errors: int, warnings: int, n_files: int) -> str:
    if not errors and not warnings:
        return f"{counted(n_files, 'file')} checked, nothing to report"
    parts = [counted(n, noun) for n, noun in ((errors, "error"), (warnings, "warning")) if n]
    return f"{' and '.join(parts)} in {counted(n_files, 'file')}"
