"""The same results in the same order, whoever does the work."""

import importlib.util
import os
from functools import partial

import pytest

from stlspec.errors import UsageError
from stlspec.many.engines import AHEAD, engine_of, in_processes, on_ray, serially
from stlspec.many.work import score_file


def numbered(offset: int, path: str) -> str:
    return f"{offset + len(path)} {path}"


def dies(path: str) -> str:
    os._exit(1) if path == "b" else None
    return path


def test_processes_give_what_one_process_gives_in_the_same_order(job, paths):
    work = partial(score_file, job)
    alone = [[s.to_json() for s in found.scores] for found in serially(work, paths)]
    assert [[s.to_json() for s in found.scores] for found in in_processes(work, paths, 2)] == alone


def test_only_a_bounded_number_of_files_is_under_way():
    taken = []

    def paths():
        for number in range(50):
            taken.append(number)
            yield str(number)

    for done, _ in enumerate(in_processes(partial(numbered, 1), paths(), 2), 1):
        assert len(taken) <= done + 2 * AHEAD


def test_a_process_that_dies_is_told():
    with pytest.raises(UsageError, match="ended by itself"):
        list(in_processes(dies, ["a", "b", "c"], 2))


def test_one_job_needs_no_process():
    assert engine_of("local", None, None) is serially
    assert engine_of("local", 1, None) is serially
    assert engine_of("local", 3, None).keywords == {"jobs": 3}
    assert engine_of("ray", 3, "host:1").keywords == {"jobs": 3, "address": "host:1"}


@pytest.mark.skipif(importlib.util.find_spec("ray") is not None, reason="the extra ray is installed")
def test_without_the_extra_the_way_out_is_named():
    with pytest.raises(UsageError, match="not installed"):
        list(on_ray(partial(numbered, 1), ["a"], 1, None))
