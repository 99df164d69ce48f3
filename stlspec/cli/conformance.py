"""The command on conformance vectors: conform.

In: a file of vectors. Out: how many hold, and each that does not with what was expected and what came.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stlspec.cli.options import FormatOption
from stlspec.cli.output import Format, print_json
from stlspec.compiler.printing import counted

if TYPE_CHECKING:
    from stlspec.tools.conformance import Outcome


def conform(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="conformance vectors, JSON")],
    output: FormatOption = Format.TEXT,
) -> None:
    """Run conformance vectors through the compiler; exit with 1 if one fails."""
    from stlspec.tools.conformance import load_vectors, run_vector

    outcomes = [run_vector(vector) for vector in load_vectors(file)]
    failed = [outcome for outcome in outcomes if not outcome.holds]
    if output is Format.JSON:
        print_json(
            {
                "schema": "stlspec.conform/1",
                "vectors": len(outcomes),
                "held": len(outcomes) - len(failed),
                "failures": [_document(outcome) for outcome in failed],
            }
        )
    else:
        for outcome in failed:
            print(f"{outcome.vector.id}: expected {_expected(outcome)}, got {_got(outcome)}")
            print(f"    {outcome.vector.text}, at sample {outcome.vector.at}")
        print(f"{len(outcomes) - len(failed)} of {counted(len(outcomes), 'vector')} hold")
    raise typer.Exit(1 if failed else 0)


def _document(outcome: "Outcome") -> dict[str, Any]:
    vector = outcome.vector
    return {
        "id": vector.id,
        "formula": vector.text,
        "at": vector.at,
        "expected": {"robustness": _number(vector.expected), "verdict": vector.verdict},
        "got": {
            "robustness": _number(outcome.robustness),
            "verdict": outcome.verdict,
            "errors": list(outcome.codes),
        },
    }


def _number(value: float | str | None) -> float | str | None:
    """Return a number as JSON has it: infinities as text."""
    return str(value) if isinstance(value, float) and value in (float("inf"), -float("inf")) else value


def _expected(outcome: "Outcome") -> str:
    vector = outcome.vector
    if isinstance(vector.expected, str):
        return vector.expected
    return f"{vector.expected:.17g}" + (f" ({vector.verdict})" if vector.verdict else "")


def _got(outcome: "Outcome") -> str:
    if outcome.robustness is None:
        return f"error {outcome.codes[0]}: {outcome.message}" if outcome.codes else "an error"
    return f"{outcome.robustness:.17g} ({outcome.verdict})"
