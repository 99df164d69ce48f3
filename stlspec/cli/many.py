"""`score` for many files: over processes or a cluster, into a file, with progress and a way to go on.

In: a spec, paths or patterns, options. Out: a result file and one line about it, or scores in memory.
"""

import glob
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stlspec.cli.options import spare_inputs
from stlspec.cli.output import print_json, warn
from stlspec.compiler.printing import counted
from stlspec.errors import UsageError, diagnostic

if TYPE_CHECKING:
    from stlspec.many.run import Summary
    from stlspec.many.work import FileScores, Job
    from stlspec.scores import Ranking


class EngineName(StrEnum):
    """Who does the work."""

    LOCAL = "local"
    RAY = "ray"


Jobs = Annotated[int | None, typer.Option("--jobs", metavar="N", min=1, max=256, help="score files in N processes")]
EngineOption = Annotated[EngineName, typer.Option("--engine", help="processes of this machine, or a Ray cluster")]
Address = Annotated[str | None, typer.Option("--address", metavar="HOST:PORT", help="of the Ray cluster")]
KeepGoing = Annotated[
    bool, typer.Option("--keep-going", help="report files that cannot be used and go on; exits with 1 then")
]
Out = Annotated[
    Path | None,
    typer.Option("--out", "-o", metavar="FILE", help="write a row a demonstration as they come: .jsonl, .parquet"),
]


@dataclass(frozen=True, slots=True)
class Sharing:
    """How the work is shared out, as the user asked for it."""

    jobs: int | None
    engine: EngineName
    address: str | None
    keep_going: bool
    out: Path | None

    @property
    def wanted(self) -> bool:
        """Whether anything but one process that keeps all traces was asked for."""
        several = self.jobs is not None or self.engine is not EngineName.LOCAL
        return several or self.out is not None or self.keep_going

    def run(self) -> Any:
        """Return the engine."""
        from stlspec.many.engines import engine_of

        return engine_of(self.engine.value, self.jobs, self.address)

    def check(self, pictures: bool, gate: bool, inputs: Sequence[str | Path]) -> None:
        """Refuse, before any work, options that do not go together."""
        what, way = "", ""
        if self.address is not None and self.engine is not EngineName.RAY:
            what, way = "`--address` is that of a Ray cluster", "add --engine ray"
        elif self.wanted and pictures:
            what = "explanations, pictures and reports need the traces, which many files at once do not keep"
            way = "leave out --jobs, --engine, --out and --keep-going, or score the few files of interest"
        elif self.out is not None and gate:
            what, way = "`--require` asks for a table", "leave out --out, or look for failures in the file"
        if what:
            raise UsageError([diagnostic("D880", what=what, help=way)])
        if self.out is not None:
            spare_inputs(self.out, inputs, "--out")


def expanded(words: Sequence[str]) -> list[str]:
    """Replace the patterns among some paths by the files that match, sorted; for shells that leave them alone.

    Raises: UsageError D880: a pattern matches nothing.
    """
    found: list[str] = []
    for word in words:
        if not glob.has_magic(word) or word.startswith("minari:") or Path(word).exists():
            found.append(word)
            continue
        matches = sorted(glob.glob(word, recursive=True))  # noqa: PTH207 - a pattern may be absolute
        if not matches:
            raise UsageError([diagnostic("D880", what=f"no file matches '{word[:80]}'", help="check the pattern")])
        found += matches
    return found


def score_in_memory(job: "Job", paths: list[str], sharing: Sharing) -> tuple["Ranking", bool]:
    """Score files and rank their demonstrations; tell also whether files were left out."""
    from stlspec.many.run import gather
    from stlspec.scores import ranked

    with _progress(len(paths), sharing.keep_going) as told:
        scores, problems = gather(job, paths, sharing.run(), keep_going=sharing.keep_going, told=told)
    return ranked(job.bundle, scores, job.at), bool(problems)


def score_into(out: Path, job: "Job", paths: list[str], sharing: Sharing, as_json: bool) -> "Summary":
    """Score files into a file, and say what came of it."""
    from stlspec.many.journal import SCHEMA
    from stlspec.many.run import score_many

    with _progress(len(paths), sharing.keep_going) as told:
        summary = score_many(job, paths, out, sharing.run(), keep_going=sharing.keep_going, told=told)
    if as_json:
        counts = {"files": summary.files, "demonstrations": summary.demonstrations, "failed": summary.failed}
        print_json({"schema": SCHEMA, "out": str(out), **counts})
        return summary
    failed = f"; {counted(summary.failed, 'file')} left out" if summary.failed else ""
    print(f"{out}: {counted(summary.demonstrations, 'demonstration')} of {counted(summary.files, 'file')}{failed}")
    return summary


@contextmanager
def _progress(total: int, keep_going: bool) -> "Iterator[Callable[[FileScores, int], None]]":
    """Show how far the work is, on a terminal; report at once, anywhere, what is doubtful or left out."""
    from stlspec import report

    with report.files_progress(sys.stderr, total) as bar:
        began, shown = time.monotonic(), 0

        def told(found: "FileScores", done: int) -> None:
            nonlocal shown
            shown += len(found.scores)
            seconds = max(time.monotonic() - began, 1e-9)
            bar(done, f"{shown / seconds:,.0f} demonstrations/s")
            for score in found.scores:
                warn(score.warnings)
            if keep_going:
                warn(found.problems)

        yield told
