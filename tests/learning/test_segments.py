"""Segments: jobs done by whoever, with the same result."""

import os
from dataclasses import replace

import pytest

from stlspec.errors import UsageError
from stlspec.learning.qstl import CHUNK
from stlspec.learning.segments import Job, pool_of, shared_mask, train, trainer
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import AVOIDED, GOAL, RUNS, VIOLATION
from stlspec.learning.task import Task

TASK = Task(
    "goal", 5, 2, 0, ((1, 3), (2, 4), (2, 2), (3, 3), (4, 4)), (RUNS, RUNS, GOAL, VIOLATION, AVOIDED), ((1.0,),) * 5
)
SETTINGS = Settings("plain", 4 * CHUNK, 1, 9, 0.9, 0.3, 0.5, 0.01, True)
JOB = Job(TASK, SETTINGS, (0.0,) * 5)


def without_time(segment):
    return replace(segment, seconds=0.0)


def test_a_segment_tells_what_was_learned():
    found = train(JOB)
    assert found.path == (0, 1, 2)
    assert found.actions == (0, 0)
    assert found.reached
    assert len(found.steps) == len(found.returns) == len(found.outcomes) == 100
    assert [look[:2] for look in found.looks] == [(n, sum(found.steps[:n])) for n in (25, 50, 75, 100)]
    assert found.looks[-1][2] == found.path
    assert set(found.masked) == {(0, 1), (1, 1)}
    assert found.violations == found.outcomes.count(VIOLATION) == 1
    assert found.outcomes.count(AVOIDED) == 1


def test_what_is_forbidden_is_never_tried():
    found = train(replace(JOB, forbidden=((0, 1), (1, 1))))
    assert found.prefilled == 2
    assert set(found.outcomes) == {GOAL}


def test_hope_is_lowered_by_trying_alone():
    """Two ways to the goal: the long one is found first, and only hope makes the learner look for the short one."""
    ring = Task(
        "goal", 6, 2, 0, ((1, 5), (2, 0), (3, 1), (3, 3), (3, 5), (4, 0)), (RUNS,) * 3 + (GOAL, RUNS, RUNS), ((),) * 6
    )
    settings = replace(SETTINGS, episodes=200, epsilon=0.0, alpha=1.0, gamma=0.99)
    found = train(Job(ring, settings, (1.0,) * 6, hopeful=True))
    assert found.reached
    assert all(value <= 1 for row in found.q for value in row)
    assert {len(path) for *_, path in found.looks} == {4}
    assert found.q[5][0] < 1 and found.q[2][0] == pytest.approx(0.99)


def test_only_what_violates_a_hard_requirement_is_shared():
    """State 3 violates; state 4 only breaks what a soft requirement keeps up."""
    assert shared_mask(TASK, [train(JOB)], [False, False, False, True, False]) == {(0, 1)}


def test_a_segment_that_does_not_arrive_keeps_no_path_but_the_last():
    away = replace(TASK, endings=(RUNS,) * 3 + (VIOLATION, AVOIDED))
    found = train(replace(JOB, task=away))
    assert not found.reached
    assert [look[2] for look in found.looks[:-1]] == [()] * 3
    assert found.looks[-1][2] == found.path != ()


def test_several_processes_give_the_same_segments_in_the_same_order():
    jobs = [replace(JOB, settings=replace(SETTINGS, seed=seed)) for seed in range(3)]
    told = []
    with trainer(1) as one, trainer(2, lambda *n: told.append(n)) as two:
        alone, together = one(jobs), two(jobs)
    assert [without_time(s) for s in alone] == [without_time(s) for s in together]
    assert told == [(i, 100, sum(s.steps)) for i, s in enumerate(alone)]


def test_what_goes_wrong_in_a_process_reaches_the_caller():
    with pytest.raises(IndexError), trainer(2) as two:
        two([JOB, replace(JOB, potential=(0.5,), settings=replace(SETTINGS, method="shaped"))])


def leave():
    os._exit(7)


def test_a_process_that_ends_by_itself_is_a_diagnostic():
    with pytest.raises(UsageError) as caught, pool_of(1) as pool:
        pool.submit(leave).result()
    assert caught.value.diagnostics[0].code == "D882"
    assert "__main__" in caught.value.diagnostics[0].help
