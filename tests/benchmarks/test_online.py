"""Streams: every reading has its contestants, and no goal is left without a figure."""

import pytest

from tests.benchmarks import online
from tests.benchmarks.contest import Figure
from tests.benchmarks.workloads import SHAPES, texts


class FakeArena:
    quick = False

    def __init__(self):
        self.jobs = []

    def contest(self, jobs):
        self.jobs += jobs.values()
        return {label: Figure(1e-6, 1e-6, 1e-6) for label in jobs}

    def quantiles(self, tool, job, count, wanted):
        return [2e-6 for _ in wanted]


class FakeData:
    short = ""
    streams = dict.fromkeys(SHAPES, "")

    def job(self, tool, kind, formulas, data, n, **more):
        return tool, {"kind": kind, "texts": texts(tool, formulas), **more}


@pytest.mark.parametrize("part", ["every", "start", "pending"])
def test_every_reading_has_its_contestants_and_goals(part):
    arena = FakeArena()
    sections = getattr(online, part)(arena, FakeData())
    assert all(goal.value is not None for section in sections for goal in section.goals)
    kinds = {job["kind"] for tool, job in arena.jobs if tool == "stlspec"}
    assert part in kinds
    assert all(job["kind"] in (part, "nothing") for _, job in arena.jobs)


def test_windows_are_full_before_anything_is_timed():
    arena = FakeArena()
    online.every(arena, FakeData())
    online.pending(arena, FakeData())
    widest = [job for _, job in arena.jobs if job.get("warm", 0) > 8000]
    assert widest
    assert all("4000" in text for job in widest for text in job["texts"])


def test_two_microseconds_meet_a_goal_of_two():
    arena = FakeArena()
    start, shapes = online.start(arena, FakeData())
    assert all(goal.met for goal in start.goals)
    assert len(shapes.goals) == 3 * len(SHAPES)
