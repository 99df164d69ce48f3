"""Checkpoints: the same learner again, to the bit, or none."""

import json
import math
from dataclasses import replace

import pytest

from stlspec.learning.qstl import CHUNK, Learner, run_chunk
from stlspec.learning.resume import Position, fingerprint, restore, to_state
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import GOAL, RUNS, VIOLATION
from stlspec.learning.task import Task

TASK = Task("goal", 4, 2, 0, ((1, 3), (2, 3), (2, 2), (3, 3)), (RUNS, RUNS, GOAL, VIOLATION), ((1.0,),) * 4)
SETTINGS = Settings("shaped", 4 * CHUNK, 1, 9, 0.9, 0.3, 0.5, 0.01, True)
REWARD = (0.1, 0.2, 0.3, -1.0)


def run(chunks, state=None):
    learner = Learner(TASK, SETTINGS, REWARD)
    done = 0
    if state is not None:
        done = restore(learner, json.loads(json.dumps(state))).chunks
    for chunk in range(done, chunks):
        run_chunk(learner, chunk)
    return learner


def facts(learner):
    return (
        learner.q, learner.choices, learner.endings, learner.moves, learner.masked, learner.violations,
        learner.env_steps, learner.steps, learner.returns, learner.outcomes, learner.promises.to_state(),
        learner.promises.before, learner.promises.reached,
    )  # fmt: skip


@pytest.mark.parametrize("stop", [1, 2, 3])
def test_a_resumed_learner_goes_on_bit_for_bit(stop):
    state = to_state(run(stop), Position(stop, ((1, 2, (0, 1)),) * stop, 0.5))
    assert facts(run(4, state)) == facts(run(4))


GOOD = to_state(run(1), Position(1, ((25, 60, (0, 1, 2)),), 0.5))


def test_a_sound_state_is_taken_as_it_was():
    learner = Learner(TASK, SETTINGS, REWARD)
    assert restore(learner, GOOD) == Position(1, ((25, 60, (0, 1, 2)),), 0.5)


@pytest.mark.parametrize(
    "change",
    [
        {"q": None},
        {"q": [[0, 0]]},
        {"q": [[0]] * 4},
        {"q": [["x", 0]] * 4},
        {"steps": [1] * 24},
        {"steps": [-1] * 25},
        {"steps": [1.5] * 25},
        {"outcomes": [9] * 25},
        {"looks": []},
        {"looks": [[1, 2]]},
        {"looks": [[25, 60, 1]]},
        {"paths": [[0, 4]]},
        {"chunks": 2},
        {"seconds": None},
        {"violations": "3"},
        {"promises": None},
        {"promises": {"tried": [[0, 2]], "claims": [0.0] * 4}},
        {"promises": {"tried": [[4, 0]], "claims": [0.0] * 4}},
        {"promises": {"tried": [[0, 0]], "claims": [0.0] * 3}},
    ],
)
def test_a_state_that_does_not_fit_leaves_the_learner_fresh(change):
    learner, fresh = Learner(TASK, SETTINGS, REWARD), Learner(TASK, SETTINGS, REWARD)
    assert restore(learner, {**GOOD, **change}) is None
    assert facts(learner) == facts(fresh)
    assert restore(learner, {}) is None


def test_every_setting_changes_the_fingerprint(small):
    bundle, world, _ = small

    def key(settings, reward=REWARD, prefilled=()):
        return fingerprint(bundle, world, TASK, settings, reward, prefilled)

    changes = [{"seed": 2}, {"episodes": 7}, {"gamma": 0.8}, {"mask": False}, {"method": "plain"}]
    keys = [key(SETTINGS), *(key(replace(SETTINGS, **change)) for change in changes)]
    keys += [key(SETTINGS, (0.0,) * 4), key(SETTINGS, prefilled=((0, 1),))]
    assert len(set(keys)) == len(keys)
    assert key(SETTINGS) == keys[0]


def test_infinities_survive():
    learner = Learner(TASK, SETTINGS, REWARD)
    learner.forbid([(0, 1)])
    again = Learner(TASK, SETTINGS, REWARD)
    assert restore(again, json.loads(json.dumps(to_state(learner, Position(0, (), 0.0))))) is not None
    assert again.q[0][1] == -math.inf
    assert again.choices[0] == [0]
