"""The command on the `expect` statements of specs: test.

In: spec files. Out: one line for each expectation as soon as it is known, what decided where it is not met, and a
summary; or one JSON document. What cannot be run stops nothing else.
"""

import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stlspec.cli.data import DemoEnv, DemoMap, EnvArgs, EnvOption, MapOption
from stlspec.cli.options import FormatOption, Params, read_params
from stlspec.cli.output import Format, coloured, print_diagnostics, print_json
from stlspec.compiler.printing import counted
from stlspec.errors import StlspecError

if TYPE_CHECKING:
    from stlspec.envs.model import Environment
    from stlspec.tools.expectations import Case, Outcome

_MARKS = {"met": ("✓", "green"), "not met": ("✗", "red"), "not run": ("!", "red")}


def test_specs(
    specs: Annotated[list[Path], typer.Argument(metavar="FILE...", help="spec files with `expect` statements")],
    params: Params = None,
    env: EnvOption = None,
    env_arg: EnvArgs = None,
    map_file: MapOption = None,
    demo_env: DemoEnv = None,
    demo_map: DemoMap = None,
    output: FormatOption = Format.TEXT,
) -> None:
    """Run the `expect` statements of specs; exit with 1 if one is not met."""
    from stlspec.cli.data import demonstration_environment, environment_from

    environment = demonstration_environment(env, env_arg, map_file, demo_env, demo_map) or environment_from(
        env, env_arg, map_file
    )
    tally = _Tally(output is Format.TEXT)
    for path in specs:
        _test(path, read_params(params), environment, tally)
    if output is Format.JSON:
        print_json(tally.to_json())
    else:
        print(tally.summary(len(specs)))
    raise typer.Exit(tally.exit_code)


def _test(path: Path, params: dict[str, str], environment: "Environment | None", tally: "_Tally") -> None:
    """Run the expectations of one file; errors of the spec are counted, and stop no other file."""
    from stlspec.tools.expectations import load_tests, run_tests

    try:
        tests = load_tests(path, params)
    except StlspecError as error:
        tally.refuse(path, error)
        return
    outcomes = tally.begin(path)
    for outcome in run_tests(tests, environment):
        outcomes.append(outcome)
        tally.count(path, outcome)


@dataclass
class _Tally:
    """What came out so far; printed as it comes if `shows`."""

    shows: bool
    files: list[dict[str, Any]] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=lambda: dict.fromkeys(_MARKS, 0))
    exit_code: int = 0

    def begin(self, path: Path) -> "list[Outcome]":
        """Go on to another file."""
        outcomes: list[Outcome] = []
        self.files.append({"file": str(path), "expectations": outcomes, "diagnostics": []})
        return outcomes

    def refuse(self, path: Path, error: StlspecError) -> None:
        """Note a file that cannot be tested at all."""
        self.begin(path)
        self.files[-1]["diagnostics"] = [problem.to_json() for problem in error.diagnostics]
        self.exit_code = max(self.exit_code, error.exit_code)
        if self.shows:
            sys.stdout.flush()
            print_diagnostics(error.diagnostics, sys.stderr)

    def count(self, path: Path, outcome: "Outcome") -> None:
        """Note what came of one expectation."""
        self.counts[outcome.result] += 1
        self.exit_code = max(self.exit_code, {"met": 0, "not met": 1, "not run": 2}[outcome.result])
        if not self.shows:
            return
        mark, colour = _MARKS[outcome.result]
        print(f"{_painted(mark, colour)} {path}:{outcome.line}: {outcome.text}")
        for case in outcome.cases:
            if not case.met:
                _print_case(case)
        print_diagnostics(outcome.diagnostics, sys.stdout)

    def summary(self, n_files: int) -> str:
        """Say in one line what came out."""
        met, unmet, unrun = (self.counts[key] for key in ("met", "not met", "not run"))
        if not met + unmet + unrun:
            refused = sum(bool(entry["diagnostics"]) for entry in self.files)
            return "nothing was tested" if refused else f"{counted(n_files, 'file')} without an `expect` statement"
        parts = [f"{met} met", *([f"{unmet} not met"] if unmet else []), *([f"{unrun} not run"] if unrun else [])]
        return f"{counted(met + unmet + unrun, 'expectation')}: {', '.join(parts)}"

    def to_json(self) -> dict[str, Any]:
        """Return the `stlspec.test/1` document."""
        files = [{**entry, "expectations": [o.to_json() for o in entry["expectations"]]} for entry in self.files]
        summary = {"met": self.counts["met"], "not_met": self.counts["not met"], "not_run": self.counts["not run"]}
        return {"schema": "stlspec.test/1", "exit": self.exit_code, "files": files, "summary": summary}


def _print_case(case: "Case") -> None:
    print(f"    {_painted(case.what, 'red')}  ({case.name})")
    for line in case.details:
        print(f"      {line}")


def _painted(text: str, colour: str) -> str:
    return typer.style(text, fg=colour) if coloured(sys.stdout) else text
