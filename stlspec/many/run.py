"""The whole line: many files to a result file, or to scores in memory.

In: a `Job`, paths, an engine. Out: a `Summary`, and a file of one row a demonstration, in the order of the files.
Rows carry no rank, which would need all of them at once: sorted by label and reward they are ranked.
"""

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.errors import DataError, Diagnostic
from stlspec.many.journal import Journal
from stlspec.many.work import FileScores, Job, score_file
from stlspec.scores import DemonstrationScore

Engine = Callable[[Callable[[str], FileScores], Iterable[str]], Iterator[FileScores]]
Told = Callable[[FileScores, int], object]
"""Called for each file that is done, with the number of files done so far."""


@dataclass(frozen=True, slots=True)
class Summary:
    """What came of many files: how many there were, how many demonstrations in them, how many files failed."""

    files: int
    demonstrations: int
    failed: int


def identity_of(job: Job, paths: Sequence[str]) -> Callable[[int], str]:
    """Return what tells the work on the first so many files from any other: spec, options, files in their order.

    Not in the paper: resuming.

    Returns: a function from a number of files to a hash.
    """
    options = [meaning_sha256(job.bundle), job.env, job.end, job.at, job.on_nan, job.resample]
    begun = hashlib.sha256(json.dumps(options, default=str).encode())
    done, so_far = 0, begun.copy()

    def of(files: int) -> str:
        # It is asked for ever more files, so it goes on where it stopped: a million of them are hashed once.
        nonlocal done, so_far
        if files < done:
            done, so_far = 0, begun.copy()
        for path in paths[done:files]:
            so_far.update(json.dumps(path).encode())
        done = files
        return so_far.hexdigest()

    return of


def score_many(
    job: Job,
    paths: Sequence[str],
    out: Path,
    engine: Engine,
    *,
    keep_going: bool = False,
    told: Told = lambda _file, _done: None,
) -> Summary:
    """Score many files into one, going on where an interrupted run of the same work stopped.

    Paper: Algorithm 1, lines 3 to 7, for any number of demonstrations.

    Args:    out: .jsonl or .parquet. keep_going: leave out files that cannot be used; else the first one ends it.
             told: hears of every file.
    Returns: counts, those of the interrupted run included.
    Raises:  DataError: a file cannot be used, without `keep_going`; UsageError, InputError: see `Journal`, `engines`.
    """
    with Journal(out, identity_of(job, paths)) as journal:
        for found in engine(partial(score_file, job), paths[journal.files :]):
            if found.problems and not keep_going:
                raise DataError(found.problems)
            journal.add([_line(found.path, score, job) for score in found.scores], bool(found.problems))
            told(found, journal.files)
        journal.finish()
    return Summary(journal.files, journal.counts[0], journal.counts[1])


def gather(
    job: Job,
    paths: Sequence[str],
    engine: Engine,
    *,
    keep_going: bool = False,
    told: Told = lambda _file, _done: None,
) -> tuple[list[DemonstrationScore], list[Diagnostic]]:
    """Score files and keep the scores, without their traces.

    Paper: Algorithm 1, lines 3 to 7. Arguments and errors as for `score_many`; without `keep_going` the diagnostics of
    all files come at once.

    Returns: the scores in the order of the files, and what is wrong with files that were left out.
    """
    scores: list[DemonstrationScore] = []
    problems: list[Diagnostic] = []
    for done, found in enumerate(engine(partial(score_file, job), paths), 1):
        scores += found.scores
        problems += found.problems
        told(found, done)
    if problems and not (keep_going and scores):
        raise DataError(problems)
    return scores, problems


def _line(path: str, score: DemonstrationScore, job: Job) -> str:
    document: dict[str, Any] = {"file": path, **score.to_json()}
    for key in ("rank", *(() if job.at is None else ("label", "reward"))):
        del document[key]
    return json.dumps(document, ensure_ascii=False, allow_nan=False)
