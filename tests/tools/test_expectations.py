"""Expectations are met, not met, or cannot be run; what is not met is explained by hand-computed values."""

import json
from pathlib import Path

import pytest

from stlspec.envs.catalogue import make_environment
from stlspec.errors import SpecError, UsageError
from stlspec.tools.expectations import load_tests, only, run_tests

SPEC = """spec t
signal d_obs
signal d_goal from "goal"
let at_goal = d_goal < 1
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually[0, 5] at_goal
soft late: always[7, 9] (d_obs > 0)
"""
GOOD, SLOW, BAD = "d_obs,goal\n3,2\n2,1\n2,0\n", "d_obs,goal\n3,2\n2,1\n2,1\n", "d_obs,goal\n3,2\n0,1\n2,0\n"


@pytest.fixture
def run(tmp_path):
    for name, text in (("good.csv", GOOD), ("slow.csv", SLOW), ("bad.csv", BAD)):
        (tmp_path / name).write_text(text)
    episodes = "episode,d_obs,goal\n" + "".join(
        f"{n},{row}\n" for n, text in (("3", GOOD), ("7", BAD)) for row in text.splitlines()[1:]
    )
    (tmp_path / "two.csv").write_text(episodes)

    def outcomes(statements, spec=SPEC, environment=None):
        path = tmp_path / "t.stl"
        path.write_text(spec + statements)
        return list(run_tests(load_tests(path), environment))

    return outcomes


@pytest.mark.parametrize(
    ("statement", "result"),
    [
        ("expect avoid holds on {d_obs: [2, 1, 1]}", "met"),
        ("expect avoid fails on {d_obs: [2, 1, 1]}", "not met"),
        ("expect avoid fails on {d_obs: [2, 0.5, 1], time: [0, 1, 2]}", "met"),
        ("expect avoid fails on {d_obs: [2, 0.5, 1]} margin >= 0.5", "met"),
        ("expect avoid fails on {d_obs: [2, 0.5, 1]} margin >= 0.6", "not met"),
        ("expect avoid holds on {d_obs: [0, 3, 5]} at 1 margin >= 2", "met"),
        ("expect avoid holds on {d_obs: [0, 3, 5]} at -1 margin >= 4", "met"),
        ("expect reach holds on {d_goal: [2, 1, 0]}", "met"),
        ("expect late holds on {d_obs: [1]}", "met"),
        ('expect avoid holds on "good.csv"', "met"),
        ('expect avoid holds on "two.csv"', "not met"),
        ('expect avoid holds on "two.csv" episode 3', "met"),
        ('expect avoid fails on "two.csv" episode 7', "met"),
        ('expect avoid fails on "two.csv" episode 1', "met"),
        ('expect avoid fails on "two.csv" episode "7"', "met"),
        ('expect avoid fails on "two.csv" episode 9', "not run"),
        ('expect "good.csv" is good', "met"),
        ('expect "slow.csv" is incomplete', "met"),
        ('expect "bad.csv" is bad', "met"),
        ('expect "two.csv" is good', "not met"),
        ('expect "good.csv" outranks "slow.csv"', "met"),
        ('expect "slow.csv" outranks "bad.csv"', "met"),
        ('expect "slow.csv" outranks "good.csv"', "not met"),
        ('expect "good.csv" outranks "good.csv"', "not met"),
        ('expect "good.csv" outranks "two.csv"', "not met"),
        ('expect avoid holds on "none.csv"', "not run"),
        ('expect avoid holds on "good.csv" at 9', "not run"),
    ],
)
def test_an_expectation_is_met_or_not_or_cannot_be_run(run, statement, result):
    (outcome,) = run(statement)
    assert outcome.result == result
    assert (outcome.line, outcome.column, outcome.text) == (8, 1, statement)
    assert bool(outcome.diagnostics) == (result == "not run")


def test_what_cannot_be_run_stops_no_other(run):
    found = run('expect avoid holds on "none.csv"\nexpect "good.csv" is good\nexpect "none.csv" is bad')
    assert [outcome.result for outcome in found] == ["not run", "met", "not run"]


def test_a_failure_shows_the_deciding_sample_the_formulas_there_and_the_margin(run):
    (outcome,) = run("expect reach holds on {d_goal: [4, 3, 3]}")
    (case,) = outcome.cases
    assert case.what == "reach fails with margin 2, and was expected to hold"
    text = "\n".join(case.details)
    assert "decided by  d_goal = 3, needs < 1, at sample 1" in text
    assert [line.split() for line in case.details[-3:]] == [
        ["eventually[0,", "5]", "at_goal", "-2", "at", "sample", "0"],
        ["at_goal:", "d_goal", "<", "1", "-2", "at", "sample", "1"],
        ["d_goal", "3", "there"],
    ]
    assert case.document["margin"] == 2.0
    assert case.document["witness"] == {"sample": 1, "time": 1.0}
    assert case.document["explanation"]["steps"][-1]["text"] == "d_goal < 1"


def test_a_margin_that_is_missed_and_a_vacuous_value_are_said(run):
    (outcome,) = run("expect avoid holds on {d_obs: [2, 3]} margin >= 4")
    assert outcome.cases[0].what == "avoid holds with margin 1, less than 4"
    (outcome,) = run("expect late fails on {d_obs: [1]}")
    assert "vacuously" in outcome.cases[0].what


def test_time_is_that_of_the_spec(run):
    spec = "time s\nsignal x\nhard up: eventually[0, 2 s] (x > 1)\n"
    met, unmet = run(
        "expect up holds on {x: [0, 2], time: [10, 12]}\nexpect up holds on {x: [0, 2], time: [0, 2.5]}", spec
    )
    assert (met.result, unmet.result) == ("met", "not met")
    assert "at sample 0 (0 s)" in "\n".join(unmet.cases[0].details)


def test_labels_and_ranks_say_why(run):
    label, rank = run('expect "bad.csv" is good\nexpect "bad.csv" outranks "slow.csv"')
    assert label.cases[0].what == "it is bad, and was expected to be good"
    assert label.cases[0].details[0] == "avoid fails at sample 1: d_obs = 0, needs >= 1"
    assert "ranks below" in rank.cases[0].what
    assert [line.rsplit("/", 1)[-1].split(",")[0] for line in rank.cases[0].details] == [
        "bad.csv: bad",
        "slow.csv: incomplete",
    ]


def test_signals_are_computed_from_states_by_the_own_environment_or_the_given_one(run, tmp_path):
    spec = "signal d_obs\nhard avoid: always (d_obs >= 1)\n"
    states = {"schema": "stlspec.demo/1", "name": "a", "states": [[0, 0], [0, 1]]}
    (tmp_path / "s.json").write_text(json.dumps(states))
    statement = 'expect avoid fails on "s.json" margin >= 1'
    assert run(statement, spec)[0].result == "not run"
    world = make_environment("stlspec/GridWorld-v0", {}, ["S#", ".G"])
    assert run(statement, spec, world)[0].result == "met"
    own = {**states, "env": {"id": "stlspec/GridWorld-v0", "args": {}, "map": ["S#", ".G"]}}
    (tmp_path / "s.json").write_text(json.dumps(own))
    assert run(statement, spec)[0].result == "met"


def test_bool_signals_take_true_and_false(run):
    spec = "signal on: bool\nhard lit: always on\n"
    assert [o.result for o in run("expect lit holds on {on: [true, 1]}\nexpect lit fails on {on: [false]}", spec)] == [
        "met"
    ] * 2


def test_expectations_of_used_files_are_theirs(run, tmp_path):
    (tmp_path / "base.stl").write_text('signal d\nhard a: d > 1\nexpect a holds on "none.csv"\n')
    (outcome,) = run("expect b holds on {d: [3]}", 'use "base.stl"\nhard b: d > 2\n')
    assert outcome.result == "met"


def test_a_bundle_and_a_broken_spec_have_no_tests(tmp_path):
    (tmp_path / "x.stlb").write_text("{}")
    with pytest.raises(UsageError, match="compiled bundle"):
        load_tests(tmp_path / "x.stlb")
    (tmp_path / "x.stl").write_text("hard a: x > 1\nexpect b holds on {x: [1]}")
    with pytest.raises(SpecError):
        load_tests(tmp_path / "x.stl")


def test_a_requirement_alone_keeps_its_formula_and_forgets_the_rest():
    tests = load_tests(Path(__file__).parents[2] / "specs" / "grid_single_goal.stl")
    alone = only(tests.bundle, "reach")
    assert [r.name for r in alone.requirements] == ["reach"] and alone.requirements[0].depends_on == ()
    assert {node.value for node in alone.nodes if node.op == "signal"} == {"d_goal"}
    assert alone.names["at_goal"] < len(alone.nodes) and alone.weights == (1.0,)


def test_data_in_a_spec_names_signals_even_where_two_are_read_from_one_column(run):
    spec = 'signal a from "c"\nsignal b from "c"\nsignal time\nhard h: always (a > b and time > 0)\n'
    assert [o.result for o in run("expect h holds on {a: [2], b: [1], time: [1]}", spec)] == ["met"]
    assert [o.result for o in run("expect h fails on {a: [1], b: [2], time: [1]} margin >= 1", spec)] == ["met"]
