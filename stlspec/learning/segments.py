"""Training one segment: Q-learning from a state to a goal, in chunks, kept and resumed.

In: a `Job`, plain data. Out: a `Segment`, plain data too, so that a job may be done by another process: what it
gives back depends on the job alone, bit for bit, whoever does it and however often it was interrupted. After
every chunk of episodes the greedy path is looked at; whether it is any good is judged later, by the spec.
"""

import os
import signal
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from threading import Thread

from stlspec.errors import UsageError, diagnostic
from stlspec.learning import resume, storage
from stlspec.learning.policy import greedy_path
from stlspec.learning.qstl import CHUNK, Learner, run_chunk
from stlspec.learning.resume import Look
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL
from stlspec.learning.task import Task

CHECKPOINT_SECONDS = 1.0
"""How often the state of a run is kept; more rarely where keeping it takes long."""

CHECKPOINT_SHARE = 0.05
"""The largest share of the time that may go into keeping it."""

_WATCH_SECONDS = 0.5

Advance = Callable[[int, int], object]
"""Called between chunks with episodes and steps of the segment so far; what it raises ends training."""


@dataclass(frozen=True, slots=True)
class Job:
    """What to train.

    potential: in each learner state, see `Learner`. hopeful: values start at the potential, and nothing but
    trying lowers them (only with the method plain, which has no other use for it). forbidden: pairs of state
    and action to mask from the start. directory, key: where the state is kept, and the fingerprint of the run;
    None = nowhere.
    """

    task: Task
    settings: Settings
    potential: tuple[float, ...]
    forbidden: tuple[tuple[int, int], ...] = ()
    directory: Path | None = None
    key: str = ""
    hopeful: bool = False


@dataclass(frozen=True, slots=True)
class Segment:
    """A trained segment.

    q: (n_states, n_actions), -inf where masked. path, actions: the greedy path, n + 1 learner states and n
    actions. reached: whether it ends at the goal. steps, returns, outcomes: the log, one entry for each
    episode. looks: one for each chunk. violations: steps that violated. masked: pairs masked at the end.
    prefilled: those of them that were from the start. seconds: wall-clock time, all parts of a resumed run.
    """

    q: tuple[tuple[float, ...], ...]
    path: tuple[int, ...]
    actions: tuple[int, ...]
    reached: bool
    steps: tuple[int, ...]
    returns: tuple[float, ...]
    outcomes: tuple[int, ...]
    looks: tuple[Look, ...]
    violations: int
    masked: tuple[tuple[int, int], ...]
    prefilled: int
    seconds: float


def train(job: Job, advance: Advance | None = None) -> Segment:
    """Train a segment to the end, from the checkpoint of the same job if there is one.

    Paper: Algorithm 2, with a look at the greedy path after every chunk of episodes.

    Args:    job: what to train. advance: see `Advance`.
    Returns: the segment.
    """
    learner = Learner(job.task, job.settings, job.potential)
    if job.hopeful:
        learner.q[:] = [[value] * job.task.n_actions for value in job.potential]
    if job.settings.mask:
        learner.forbid(job.forbidden)
    prefilled = learner.masked
    state = None if job.directory is None else storage.load_checkpoint(job.directory, job.key)
    position = None if state is None else resume.restore(learner, state)
    position = position or resume.Position(0, (), 0.0)
    chunks, looks, spent = position.chunks, [*position.looks], position.seconds
    began = saved = time.perf_counter()
    pause = CHECKPOINT_SECONDS
    while chunks * CHUNK < job.settings.episodes:
        run_chunk(learner, chunks)
        chunks += 1
        last = chunks * CHUNK >= job.settings.episodes
        looks.append((len(learner.steps), learner.env_steps, _looked_at(learner, last)))
        now = time.perf_counter()
        if job.directory is not None and (now - saved >= pause if not last else bool(job.task.stream)):
            position = resume.Position(chunks, tuple(looks), spent + now - began)
            storage.save_checkpoint(job.directory, job.key, resume.to_state(learner, position))
            saved = time.perf_counter()
            pause = max(CHECKPOINT_SECONDS, (saved - now) / CHECKPOINT_SHARE)
        if advance is not None:
            advance(len(learner.steps), learner.env_steps)
    return _finished(learner, tuple(looks), prefilled, spent + time.perf_counter() - began)


def _path(learner: Learner) -> tuple[tuple[int, ...], tuple[int, ...]]:
    task = learner.task
    return greedy_path(learner.q, task.transitions, learner.endings, task.start, learner.settings.max_steps)


def _looked_at(learner: Learner, last: bool) -> tuple[int, ...]:
    """Return the greedy path; () where it does not arrive, since it may circle up to the step limit."""
    path, _ = _path(learner)
    return path if last or learner.task.endings[path[-1]] == GOAL else ()


def _finished(learner: Learner, looks: tuple[Look, ...], prefilled: int, seconds: float) -> Segment:
    path, actions = _path(learner)
    allowed = [set(row) for row in learner.choices]
    masked = [(s, a) for s, row in enumerate(allowed) for a in range(learner.task.n_actions) if a not in row]
    return Segment(
        tuple(map(tuple, learner.q)),
        path,
        actions,
        learner.task.endings[path[-1]] == GOAL,
        tuple(learner.steps),
        tuple(learner.returns),
        tuple(learner.outcomes),
        looks,
        learner.violations,
        tuple(masked),
        prefilled,
        seconds,
    )


Trainer = Callable[[list[Job]], list[Segment]]
"""Trains jobs that do not depend on each other, and returns their segments in the order of the jobs."""

Done = Callable[[int], object]
"""Called with the number of a job whenever one is done."""


@contextmanager
def trainer(jobs: int, advance: Callable[[int, int, int], object] | None = None) -> Iterator[Trainer]:
    """Offer a trainer of one process or several.

    Not in the paper: segments that start from known states can be trained at the same time.

    Args:    jobs: processes. advance: called with the number of a job in its list, its episodes and steps so
             far: between chunks in one process, when a job is done with several.
    """
    if jobs == 1:
        yield lambda work: [train(job, _numbered(advance, i)) for i, job in enumerate(work)]
        return
    with pool_of(jobs) as pool:

        def parallel(work: list[Job]) -> list[Segment]:
            if len(work) == 1:
                return [train(work[0], _numbered(advance, 0))]
            segments = []
            for number, segment in enumerate(pool.map(train, work)):
                if advance is not None:
                    advance(number, len(segment.steps), sum(segment.steps))
                segments.append(segment)
            return segments

        yield parallel


@contextmanager
def pool_of(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Offer processes that end with this one, however it ends.

    Not in the paper: training in parallel.

    Raises:  UsageError D882: a process ended by itself.
    """
    # a fresh interpreter for each process: a forked one would inherit locks that the progress bar holds
    with ProcessPoolExecutor(jobs, get_context("spawn"), _begin_process, (os.getpid(),)) as pool:
        try:
            yield pool
        except BrokenProcessPool:
            raise UsageError([diagnostic("D882", what="learn")]) from None
        except BaseException:
            processes = list((pool._processes or {}).values())
            pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.terminate()
            raise


def _numbered(advance: Callable[[int, int, int], object] | None, number: int) -> Advance | None:
    return None if advance is None else lambda episodes, steps: advance(number, episodes, steps)


def _begin_process(parent: int) -> None:
    """Let Ctrl-C reach the parent alone, which ends its processes; and end where the parent was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_outlive_not, args=(parent,), daemon=True).start()


def _outlive_not(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_WATCH_SECONDS)
    os._exit(1)


def shared_mask(task: Task, segments: Iterable[Segment], violating: Iterable[bool]) -> set[tuple[int, int]]:
    """Collect what segments learnt about hard requirements: steps into a state that violates one.

    Not in the paper: decision 8, the mask is shared by all segments.
    """
    lost = tuple(violating)
    return {(s, a) for segment in segments for s, a in segment.masked if lost[task.transitions[s][a]]}
