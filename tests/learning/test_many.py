"""Many runs at once."""

import pickle
from dataclasses import replace
from types import MappingProxyType

import pytest

from stlspec.errors import UsageError
from stlspec.learning import learn, learn_many
from stlspec.learning.many import dumps


def facts(outcome):
    training = replace(outcome.training, seconds=0.0)
    return outcome.policy, outcome.log, outcome.states, outcome.reward, outcome.checks, training


def test_runs_in_several_processes_are_those_in_one(small):
    bundle, world, demos = small
    runs = [
        {
            "bundle": bundle,
            "environment": world,
            "demonstrations": demos,
            "episodes": 60,
            "seed": seed,
            "method": method,
        }
        for seed in (0, 1)
        for method in ("shaped", "plain")
    ]
    told = []
    apart = learn_many(runs, jobs=2, done=told.append)
    assert told == [1, 2, 3, 4]
    assert [facts(o) for o in apart] == [facts(o) for o in learn_many(runs)] == [facts(learn(**run)) for run in runs]
    for key in ("policy", "requirements", "files"):
        assert apart[0].to_json()[key] == learn(**runs[0]).to_json()[key]


def test_a_run_that_cannot_be_made_ends_all(small):
    bundle, world, _ = small
    runs = [{"bundle": bundle, "environment": world, "episodes": count} for count in (25, 0)]
    for jobs in (1, 2):
        with pytest.raises(UsageError) as caught:
            learn_many(runs, jobs=jobs)
        assert caught.value.diagnostics[0].code == "D871"


def test_read_only_mappings_come_back_read_only():
    again = pickle.loads(dumps({"a": MappingProxyType({"b": MappingProxyType({})})}))
    assert again == {"a": {"b": {}}}
    assert type(again["a"]["b"]) is MappingProxyType


def test_nothing_to_do_is_done():
    assert learn_many([], jobs=2) == ()
