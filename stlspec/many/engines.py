"""Who does the work: this process, processes of this machine, or a Ray cluster.

In: a function of one path, and paths. Out: the results in the order of the paths, whoever was done first. Only a
bounded number of files is under way at a time, so that memory does not grow with their number, however slow the
reader of the results is.
"""

import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context
from typing import Any, TypeVar

from stlspec.errors import UsageError, diagnostic

Result = TypeVar("Result")
Work = Callable[[str], Result]

AHEAD = 2
"""Files under way for each process: one in work, and one that it finds when it is done."""


def serially(work: Work[Result], paths: Iterable[str]) -> Iterator[Result]:
    """Do one file after the other in this process.

    Not in the paper: scale.
    """
    return map(work, paths)


def in_processes(work: Work[Result], paths: Iterable[str], jobs: int) -> Iterator[Result]:
    """Share files out to processes of this machine.

    Not in the paper: scale.

    Args:    work: pickles, and so do its results. jobs: the number of processes, >= 1.
    Returns: the results in the order of the paths.
    Raises:  UsageError D848: a process ended by itself, for want of memory, say.
    """
    # Fresh processes, as everywhere but on Linux: forking one that has threads may leave a lock held for ever.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_ignore_interrupts) as pool:
        waiting: deque[Future[Result]] = deque()
        try:
            for path in paths:
                waiting.append(pool.submit(work, path))
                if len(waiting) >= jobs * AHEAD:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        except BrokenProcessPool:
            raise UsageError([diagnostic("D848", what="a process ended by itself", jobs=jobs)]) from None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _ignore_interrupts() -> None:
    # Ctrl-C goes to the whole group; the parent takes it and ends the pool.
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def on_ray(work: Work[Result], paths: Iterable[str], jobs: int | None, address: str | None) -> Iterator[Result]:
    """Share files out over a Ray cluster, which must see them under the same paths.

    Not in the paper: scale.

    Args:    jobs: files in work at a time; None = one for each processor of the cluster. address: of the cluster;
             None starts one on this machine for the time of the run.
    Returns: the results in the order of the paths.
    Raises:  UsageError D847: the extra is missing; D848: the cluster cannot be reached, or a task failed.
    """
    try:
        import ray
    except ImportError:
        raise UsageError([diagnostic("D847", what="Ray", extra="ray")]) from None
    try:
        started = ray.init(address=address, num_cpus=jobs if address is None else None, **_QUIET)
    except (ConnectionError, RuntimeError, ValueError) as error:
        raise UsageError([diagnostic("D848", what=f"Ray at {address}: {_first(error)}", jobs=1)]) from None
    try:
        yield from _on_cluster(ray, work, paths, jobs or _processors(ray))
    except ray.exceptions.RayError as error:
        raise UsageError([diagnostic("D848", what=f"Ray: {_first(error)}", jobs=1)]) from None
    finally:
        del started
        ray.shutdown()


_QUIET: dict[str, Any] = {"logging_level": "error", "log_to_driver": False, "include_dashboard": False}


def _first(error: Exception) -> str:
    return (str(error) or type(error).__name__).splitlines()[0][:200]


def _processors(ray: Any) -> int:
    return int(ray.cluster_resources().get("CPU", 1))


def _on_cluster(ray: Any, work: Work[Result], paths: Iterable[str], jobs: int) -> Iterator[Result]:
    # The work is the same for all files, so the cluster is handed it once.
    shared = ray.put(work)
    task = ray.remote(_call).options(num_cpus=1, max_retries=2)
    waiting: deque[Any] = deque()
    for path in paths:
        waiting.append(task.remote(shared, path))
        if len(waiting) >= jobs * AHEAD:
            yield ray.get(waiting.popleft())
    while waiting:
        yield ray.get(waiting.popleft())


def _call(work: Work[Result], path: str) -> Result:
    return work(path)


def engine_of(
    name: str, jobs: int | None, address: str | None
) -> Callable[[Work[Result], Iterable[str]], Iterator[Result]]:
    """Choose an engine.

    Not in the paper: an interface.

    Args:    name: "local" or "ray". jobs: processes; None = one, or as many as the cluster has processors.
    """
    if name == "ray":
        return partial(on_ray, jobs=jobs, address=address)
    return serially if jobs is None or jobs == 1 else partial(in_processes, jobs=jobs)
