"""The command that writes specs in canonical form: fmt.

In: spec files, or one on stdin. Out: the files written again where they change, whole or not at all; with --check
or --diff nothing is written. A file with errors is left alone, and stops no other.
"""

import sys
from dataclasses import dataclass
from difflib import unified_diff
from typing import Annotated, Any

import typer

from stlspec.cli.options import FormatOption, standard_input
from stlspec.cli.output import Format, print_diagnostics, print_json
from stlspec.compiler import files
from stlspec.compiler.printing import counted
from stlspec.errors import Diagnostic, StlspecError, UsageError, diagnostic
from stlspec.lang.formatting.text import format_syntax
from stlspec.lang.using import parse_with_uses

_STDIN, _STDIN_NAME = "-", "<stdin>"
_MARK = b"\xef\xbb\xbf"
"""A byte-order mark, kept where there is one."""


@dataclass(frozen=True, slots=True)
class _Formatted:
    """One file: its bytes before and after, or what is wrong with it and the exit code that this asks for."""

    name: str
    before: bytes
    after: bytes
    diagnostics: tuple[Diagnostic, ...] = ()
    exit_code: int = 0

    @property
    def changed(self) -> bool:
        return self.before != self.after

    def diff(self) -> str:
        """Return what changes, as a patch."""
        before, after = (_lines(data) for data in (self.before, self.after))
        return "".join(unified_diff(before, after, self.name, self.name))

    def to_json(self) -> dict[str, Any]:
        shown = [problem.to_json() for problem in self.diagnostics]
        return {"file": self.name, "changed": self.changed, "diagnostics": shown}


def fmt(
    specs: Annotated[list[str], typer.Argument(metavar="FILE...", help="spec files, or - for stdin")],
    check: Annotated[bool, typer.Option("--check", help="write nothing; exit with 1 if a file would change")] = False,
    diff: Annotated[bool, typer.Option("--diff", help="write nothing; show what would change")] = False,
    output: FormatOption = Format.TEXT,
) -> None:
    """Write specs in canonical form: same meaning, same comments, one spelling."""
    if _STDIN in specs and len(specs) > 1:
        raise UsageError([diagnostic("D880", what="`-` stands beside other files", help="give `-` alone")])
    results = [_formatted(name) for name in specs]
    stdin = specs == [_STDIN]
    if not (check or diff or stdin):
        results = [_written(result) for result in results]
    code = max(result.exit_code for result in results)
    if check and not code:
        code = int(any(result.changed for result in results))
    if output is Format.JSON:
        shown = [{**r.to_json(), "text": _text(r.after)} if stdin else r.to_json() for r in results]
        print_json({"schema": "stlspec.fmt/1", "files": shown})
        raise typer.Exit(code)
    for result in results:
        print_diagnostics(result.diagnostics, sys.stderr)
    if diff:
        _emit("".join(result.diff() for result in results).encode())
    elif stdin and not check and not code:
        _emit(results[0].after)
    print(_summary(results, planned=check or diff), file=sys.stderr if diff or stdin else sys.stdout)
    raise typer.Exit(code)


def _formatted(name: str) -> _Formatted:
    """Format one file; what is wrong with it is kept, not raised."""
    data = b""
    try:
        if name == _STDIN:
            name, data = _STDIN_NAME, standard_input().read(files.LARGEST_SPEC + 1)
            if len(data) > files.LARGEST_SPEC:
                limit = files.LARGEST_SPEC
                raise UsageError([diagnostic("S093", file=name, size=len(data), limit=limit)])
        else:
            data = files.read_bytes(name)
        if files.looks_like_bundle(name, data):
            what = f"`{name}` is a compiled bundle, which has one form only"
            raise UsageError([diagnostic("D880", what=what, help="format the spec that it was made from")])
        syntax = parse_with_uses(files.decode(data, name), files.read_used)
        after = format_syntax(syntax).encode()
    except StlspecError as error:
        return _Formatted(name, data, data, error.diagnostics, error.exit_code)
    return _Formatted(name, data, _MARK + after if data.startswith(_MARK) else after)


def _written(result: _Formatted) -> _Formatted:
    """Write a file that changes. Returns: the same, or what kept it from being written."""
    if not result.changed:
        return result
    try:
        files.write_bytes(result.name, result.after)
    except StlspecError as error:
        return _Formatted(result.name, result.before, result.before, error.diagnostics, error.exit_code)
    return result


def _emit(data: bytes) -> None:
    """Write bytes on stdout: a spec is UTF-8 whatever the terminal's encoding is."""
    sys.stdout.flush()
    sys.stdout.buffer.write(data)
    sys.stdout.buffer.flush()


def _text(data: bytes) -> str:
    return data.removeprefix(_MARK).decode("utf-8", errors="replace")


def _lines(data: bytes) -> list[str]:
    """Return the lines for a patch; one that ends in no line end says so."""
    lines = data.decode("utf-8", errors="replace").split("\n")
    last = [f"{lines[-1]}\n\\ No newline at end of file\n"] if lines[-1] else []
    return [f"{line}\n" for line in lines[:-1]] + last


def _summary(results: list[_Formatted], *, planned: bool) -> str:
    changed = [result for result in results if result.changed]
    failed = sum(bool(result.exit_code) for result in results)
    counts = [
        (len(changed), "would be reformatted" if planned else "reformatted"),
        (failed, "left alone because of errors"),
        (len(results) - len(changed) - failed, "already in canonical form"),
    ]
    lines = [f"{'would reformat' if planned else 'reformatted'} {result.name}" for result in changed]
    return "\n".join([*lines, ", ".join(f"{counted(n, 'file')} {what}" for n, what in counts if n)])
