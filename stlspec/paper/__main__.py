"""`python -m stlspec.paper`: the experiments of the paper, run again.

In: the words of the command line. Out: an exit code: 0, 2 for options or a folder that cannot be used, 130 for
Ctrl-C. Experiments and their libraries load only when the options are known to be right.
"""

import argparse
import os
import sys
from collections.abc import Sequence

from stlspec.errors import StlspecError, render

MOST_JOBS = 256

NAMES = (
    "table-1", "irl-demos", "demonstrations", "grids", "two-goals", "lakes", "hand-crafted", "transfer", "ablation",
    "rewards", "letter", "car",
)  # fmt: skip
"""What can be asked for; they stand here since the experiments take long to import. `car` is all of `car-50` and on."""


def parser() -> argparse.ArgumentParser:
    """Return the options."""
    found = argparse.ArgumentParser(
        prog="python -m stlspec.paper",
        description="Run the experiments of Puranic, Deshmukh and Nikolaidis (CoRL 2020) again, and write a report.",
        epilog=f"Experiments: {', '.join(NAMES)}.",
        allow_abbrev=False,
    )
    found.add_argument("--quick", action="store_true", help="a look in a few minutes: 3 seeds, short training")
    found.add_argument("--only", action="append", default=[], metavar="NAME", help="one experiment; may be repeated")
    found.add_argument("--out", default="paper-report", metavar="DIR", help="folder for results, figures, report")
    found.add_argument("--fresh", action="store_true", help="run experiments again whose results are there")
    found.add_argument("--jobs", type=_jobs, default=min(os.cpu_count() or 1, 8), metavar="N", help="processes")
    found.add_argument("--no-figures", dest="figures", action="store_false", help="no pictures, no matplotlib")
    return found


def _jobs(text: str) -> int:
    number = int(text) if text.isascii() and text.isdigit() else 0
    if not 1 <= number <= MOST_JOBS:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a whole number from 1 to {MOST_JOBS}")
    return number


def main(words: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit code."""
    options = parser().parse_args(words)
    try:
        from stlspec.paper import command

        command.run(options)
    except StlspecError as error:
        print("\n\n".join(map(render, error.diagnostics)), file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("\nstopped; run it again to go on from the last finished experiment", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
