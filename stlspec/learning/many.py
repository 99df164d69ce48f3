"""Many runs of the learner at once: seeds, maps, methods, in as many processes as asked for.

In: the arguments of each run. Out: its outcome, the same as if the runs had been made one after the other. What goes
to a process and back is pickled here, with mappings that cannot be changed written out as plain ones.
"""

import copyreg
import pickle
from collections.abc import Callable, Iterable, Mapping
from io import BytesIO
from types import MappingProxyType
from typing import Any

from stlspec.learning.outcome import Outcome
from stlspec.learning.segments import pool_of
from stlspec.learning.training import count_processes, learn


def learn_many(
    runs: Iterable[Mapping[str, Any]], *, jobs: int = 1, done: Callable[[int], object] | None = None
) -> tuple[Outcome, ...]:
    """Learn many times, for instance with many seeds.

    Not in the paper: its figures are means over runs.

    With several processes a script needs `if __name__ == "__main__":` around what it does, as always in Python.

    Args:    runs: for each run the arguments of `learn` by name, such as {"bundle": b, "environment": e,
             "demonstrations": d, "seed": 3}. jobs: processes. done: called with the number of runs done so far.
    Returns: the outcomes, in the order of the runs; they do not depend on `jobs`.
    Raises:  as `learn`; the first run that cannot be made ends all.
    """
    outcomes: list[Outcome] = []
    given = [dict(run) for run in runs]

    def collect(outcome: Outcome) -> None:
        outcomes.append(outcome)
        if done is not None:
            done(len(outcomes))

    if count_processes(jobs) == 1 or len(given) < 2:
        for run in given:
            collect(learn(**run))
    else:
        with pool_of(min(jobs, len(given))) as pool:
            for data in pool.map(_learned, map(dumps, given)):
                collect(pickle.loads(data))  # noqa: S301 - written by our own process
    return tuple(outcomes)


def _learned(data: bytes) -> bytes:
    return dumps(learn(**pickle.loads(data)))  # noqa: S301 - written by our own parent


def dumps(value: Any) -> bytes:
    """Pickle a value in which there may be read-only mappings."""
    stream = BytesIO()
    pickler = pickle.Pickler(stream)
    pickler.dispatch_table = copyreg.dispatch_table | {MappingProxyType: _mapping}
    pickler.dump(value)
    return stream.getvalue()


def _mapping(mapping: MappingProxyType[Any, Any]) -> tuple[Callable[[dict[Any, Any]], Any], tuple[dict[Any, Any]]]:
    return read_only, (dict(mapping),)


def read_only(mapping: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    """Return a mapping that cannot be changed, as it was before it was pickled."""
    return MappingProxyType(mapping)
