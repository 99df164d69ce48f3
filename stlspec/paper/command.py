"""The command `python -m stlspec.paper`: runs what is missing, then prints tables and writes figures and the report.

In: options. Out: a folder with results/NAME.json for each experiment, figures/NAME.png and report.md; tables on
stdout, progress on stderr. An experiment whose result is there already is not run again.
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from stlspec.compiler.files import write_bytes
from stlspec.errors import InputError, UsageError, diagnostic
from stlspec.paper import figures, journal, report
from stlspec.paper.budgets import FULL, QUICK, Budget
from stlspec.paper.experiments import EXPERIMENTS, Experiment
from stlspec.paper.spread import duration


def run(options: argparse.Namespace) -> None:
    """Do what the options ask for.

    Args:    options: quick, fresh, figures (bools), only (names), out (a folder), jobs (processes).
    Raises:  UsageError D880: an experiment is unknown, figures are wanted and matplotlib is missing, or a result that
             was kept is damaged.
             InputError S092: the folder cannot be written.
    """
    wanted = chosen(options.only)
    if options.figures:
        check_matplotlib()
    out, budget = Path(options.out), QUICK if options.quick else FULL
    prepare(out, figures=options.figures)
    began = time.perf_counter()
    for experiment in wanted:
        measure(experiment, budget, out, jobs=options.jobs, fresh=options.fresh)
    records = kept(out, budget)
    drawn = draw(records, out) if options.figures else []
    write_bytes(out / "report.md", report.write(records, drawn).encode("utf-8"))
    results = {name: record.result for name, record in records.items()}
    for heading, text in (("Claims of the paper", report.verdicts(results)), *report.sections(results)):
        print(f"{heading}\n\n{text}\n")
    say(f"{duration(time.perf_counter() - began)}; the report is {out / 'report.md'}")


def chosen(only: Sequence[str]) -> list[Experiment]:
    """Return the experiments of these names, or all if there are none. A name may be the beginning of several.

    Raises: UsageError D880: no experiment is called so.
    """
    found = []
    for name in only:
        matching = [e for e in EXPERIMENTS.values() if e.name == name or e.name.startswith(f"{name}-")]
        if not matching:
            help_ = f"known are {', '.join(EXPERIMENTS)}"
            raise UsageError([diagnostic("D880", what=f"there is no experiment '{name[:40]}'", help=help_)])
        found += matching
    return list(dict.fromkeys(found)) or list(EXPERIMENTS.values())


def check_matplotlib() -> None:
    """Refuse, before any work, figures that cannot be drawn.

    Raises: UsageError D880: matplotlib is missing.
    """
    if find_spec("matplotlib") is None:
        way = "install the extra: pip install 'stlspec[plot]'; or leave the figures out: --no-figures"
        raise UsageError([diagnostic("D880", what="the figures need matplotlib, which is not installed", help=way)])


def prepare(out: Path, *, figures: bool) -> None:
    """Make the folders: for results, and for figures if there will be any.

    Raises: InputError S092: they cannot be made.
    """
    for folder in [out / "results", *([out / "figures"] if figures else [])]:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            problem = (error.strerror or str(error)).lower()
            way = "name another folder: --out DIR"
            raise InputError([diagnostic("S092", file=str(folder), verb="write", problem=problem, help=way)]) from None


def measure(experiment: Experiment, budget: Budget, out: Path, *, jobs: int, fresh: bool) -> journal.Record:
    """Run an experiment and keep its result, unless it is kept already and nothing in it was skipped.

    Args: fresh: run it in any case.
    """
    known = None if fresh else journal.load(out, experiment.name, budget.to_json())
    if known is not None and not _was_skipped(known):
        say(f"{experiment.name}: kept from before, {duration(known.seconds)}")
        return known
    say(f"{experiment.name}: {experiment.title}")
    shown = [0.0]

    def progress(number: int, count: int) -> None:
        if time.monotonic() - shown[0] >= 1 or number == count:
            shown[0] = time.monotonic()
            print(f"\r  {number} of {count}", end="\n" if number == count else "", file=sys.stderr, flush=True)

    began, load = time.perf_counter(), journal.load_of_machine()
    result = experiment.run(budget, jobs, progress)
    seconds = time.perf_counter() - began
    loads = (load, journal.load_of_machine())
    record = journal.Record(experiment.name, budget.to_json(), seconds, loads, journal.machine(), result)
    journal.save(out, record)
    say(f"  {duration(seconds)}")
    return record


def _was_skipped(record: journal.Record) -> bool:
    irl = record.result.get("irl")
    return isinstance(irl, dict) and bool(irl.get("skipped"))


def kept(out: Path, budget: Budget) -> dict[str, journal.Record]:
    """Return what is kept of all experiments with a budget, in their order.

    Raises: UsageError D880: a result is damaged.
    """
    found = {name: journal.load(out, name, budget.to_json()) for name in EXPERIMENTS}
    records = {name: record for name, record in found.items() if record is not None}
    for name, record in records.items():
        with _undamaged(journal.place_of(out, name), f"--only {name} --fresh"):
            report.write({name: record})
    return records


def draw(records: dict[str, journal.Record], out: Path) -> list[str]:
    """Draw all figures, with progress; returns their names.

    Raises: UsageError D880: a result is damaged.
    """
    results = {name: record.result for name, record in records.items()}
    with _undamaged(out / "results", "--fresh"):
        return figures.draw_all(results, out / "figures", lambda name: say(f"  figures/{name}"))


@contextmanager
def _undamaged(place: Path, again: str) -> Iterator[None]:
    """Blame a result that was kept for what is missing or of another kind in it: there is no other input."""
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        way = f"measure it again: {again}"
        raise UsageError([diagnostic("D880", what=f"what was kept in '{place}' is damaged", help=way)]) from error


def say(text: str) -> None:
    """Print a line of progress."""
    print(text, file=sys.stderr, flush=True)
