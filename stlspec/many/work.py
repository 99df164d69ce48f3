"""One file of demonstrations to its scores: the piece of work that processes share out.

In: a `Job`, which pickles small and is the same for all files, and the path of a file. Out: `FileScores`, which
holds no trace, or what is wrong with the file. One demonstration is evaluated at a time, so that memory is bounded by
one file.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from stlspec.api import Bundle
from stlspec.binding import bind, columns_of
from stlspec.demos import Demonstration, load_demonstrations
from stlspec.envs.catalogue import make_environment
from stlspec.envs.model import Environment
from stlspec.errors import Diagnostic, StlspecError, diagnostic
from stlspec.sampling import OnNan
from stlspec.scores import DemonstrationScore, RequirementScore, score_demonstration
from stlspec.semantics.ending import End, evaluate_ending


@dataclass(frozen=True, slots=True)
class Job:
    """What is done with every file.

    bundle: the compiled spec, which pickles as its file. env: the environment of the demonstrations, as it was asked
    for; None = the one that each demonstration names. end, at, on_nan, resample: as for `scores.score`.
    """

    bundle: Bundle
    env: tuple[str, tuple[tuple[str, Any], ...], tuple[str, ...] | None] | None = None
    end: End = "clip"
    at: int | None = None
    on_nan: OnNan = "refuse"
    resample: int | None = None

    def environment(self) -> Environment | None:
        """Return the environment; made once in each process."""
        return None if self.env is None else _environment(self.env)


@dataclass(frozen=True, slots=True)
class FileScores:
    """The scores of the demonstrations of one file, without ranks; or none, and what is wrong with it."""

    path: str
    scores: tuple[DemonstrationScore, ...]
    problems: tuple[Diagnostic, ...] = ()


def job_of(bundle: Bundle, environment: Environment | None, **options: Any) -> Job:
    """Make a job of an environment as it was made.

    Not in the paper: an interface.
    """
    if environment is None:
        return Job(bundle, **options)
    return Job(bundle, (environment.asked, tuple(environment.args.items()), environment.map), **options)


@lru_cache(maxsize=4)
def _environment(env: tuple[str, tuple[tuple[str, Any], ...], tuple[str, ...] | None]) -> Environment:
    env_id, args, rows = env
    named = dict(args)
    # A named map is kept by its name, and is looked up again.
    return make_environment(env_id, named, None if "map_name" in named else rows)


def score_file(job: Job, path: str) -> FileScores:
    """Score the demonstrations of one file.

    Paper: Algorithm 1, lines 3 to 7, for the demonstrations of one file.

    Returns: their scores in order, or the diagnostics of what cannot be used; nothing is raised for bad input.
    """
    try:
        environment = job.environment()
        loaded = load_demonstrations([Path(path)] if not path.startswith("minari:") else [path], _wanted(job))
        return FileScores(path, tuple(_scored(job, demonstration, environment) for demonstration in loaded))
    except StlspecError as error:
        return FileScores(path, (), tuple(error.diagnostics))
    except MemoryError:
        return FileScores(path, (), (diagnostic("D838", file=path, size="too many", limit="what memory holds"),))


def _wanted(job: Job) -> frozenset[str]:
    return columns_of(job.bundle, job.environment())


def _scored(job: Job, demonstration: Demonstration, environment: Environment | None) -> DemonstrationScore:
    bound = bind(job.bundle, demonstration, environment, job.on_nan, job.resample)
    file = demonstration.file or demonstration.name
    result = evaluate_ending(job.bundle, bound.signals, bound.time, end=job.end, at=job.at or 0, file=file)
    score = score_demonstration(job.bundle, bound, result, job.at)
    kept: dict[str, RequirementScore] = {name: x.settled() for name, x in score.requirements.items()}
    return replace(score, requirements=kept)
