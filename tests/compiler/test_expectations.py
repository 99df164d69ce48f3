"""What is wrong with an `expect` statement that can be told without any data file."""

import pytest

from stlspec.compiler.checks import check
from stlspec.compiler.compiling import check_source
from stlspec.compiler.expectations import signals_of
from stlspec.lang.parse import parse
from stlspec.source import SourceText

HEAD = """signal x
signal b: bool
signal z
let near = x < 1
let far(p) = p > 2
let unused = z > 0
hard safe: always (near or b)
soft quick: eventually far(x)
"""


def said(statement, head=HEAD):
    """Code and text of the place of each diagnostic."""
    problems = check_source(SourceText.of("s", head + statement)).diagnostics
    return [(p.code, p.source.slice(p.span)) for p in problems if p.severity == "error"]


@pytest.mark.parametrize(
    "statement",
    [
        'expect safe holds on "d.csv"',
        'expect safe fails on "d.jsonl" episode 3 at -1 margin >= 0',
        "expect safe holds on {x: [1, 2], b: [true, 0]} at 1",
        "expect safe holds on {x: [1, 2], b: [1, false], z: [0, 0], time: [0, 1]} at -2",
        "expect quick holds on {x: [inf]}",
        'expect "a" is incomplete',
        'expect "a" episode "x" outranks "b" episode 1',
    ],
)
def test_what_can_be_expected_is_accepted(statement):
    assert said(statement) == []


@pytest.mark.parametrize(
    ("statement", "expected"),
    [
        ('expect saef holds on "d.csv"', ("N116", "saef")),
        ('expect near holds on "d.csv"', ("N116", "near")),
        ('expect safe holds on ""', ("T205", '""')),
        ('expect safe holds on "d" episode 1.5', ("T205", "1.5")),
        ('expect safe holds on "d" at 0.5', ("T205", "0.5")),
        ('expect safe holds on "d" at 1e999', ("T205", "1e999")),
        ('expect safe holds on "d" margin >= 1e999', ("S023", "1e999")),
        ("expect quick holds on {x: [1, 2]} at 2", ("T205", "2")),
        ("expect quick holds on {x: [1, 2]} at -3", ("T205", "-3")),
        ("expect safe holds on {x: [1, 2]}", ("N117", "{x: [1, 2]}")),
        ("expect safe holds on {x: [1, 2], b: [true]}", ("T205", "b: [true]")),
        ("expect safe holds on {x: [1], b: [2]}", ("T205", "2")),
        ("expect quick holds on {x: [true]}", ("T205", "true")),
        ("expect quick holds on {x: [1], x: [2]}", ("T205", "x")),
        ("expect quick holds on {x: [1], y: [2]}", ("N101", "y")),
        ("expect quick holds on {x: [1], near: [2]}", ("N101", "near")),
        ('expect "d" is god', ("T205", "god")),
        ('expect "" outranks "d"', ("T205", '""')),
    ],
)
def test_what_cannot_be_is_one_diagnostic_at_its_place(statement, expected):
    assert said(statement) == [expected]


def test_stamps_are_needed_where_they_come_with_the_data():
    head = "time s\nsignal x\nhard safe: always (x > 1)\n"
    assert said("expect safe holds on {x: [2]}", head) == [("N117", "{x: [2]}")]
    assert said("expect safe holds on {x: [2], time: [0]}", head) == []


def test_what_is_broken_elsewhere_is_not_blamed_on_the_expectation():
    assert said("hard sound: always (x >\nexpect sound holds on {x: [1]}")[0][0] == "S002"
    assert len(said("hard sound: always (x >\nexpect sound holds on {x: [1]}")) == 1
    assert [code for code, _ in said("signal w in\nexpect quick holds on {x: [1], w: [1]}")] == ["S002"]


def test_a_formula_needs_the_signals_of_its_lets_and_not_those_of_arguments():
    text = "signal p\nsignal q\nsignal r\nlet f(p) = p > q\nlet g = f(r)\nhard a: always g"
    model, problems = check(parse(SourceText.of("s", text)))
    assert problems == ()
    assert signals_of(model.declared, model.declared.requirements["a"].formula) == ("q", "r")


def test_suggestions_and_declarations_are_given():
    (problem,) = check_source(SourceText.of("s", HEAD + 'expect saef holds on "d"')).diagnostics[-1:]
    assert problem.help == "did you mean `safe`?"
    found = check_source(SourceText.of("s", HEAD + 'expect near holds on "d"')).diagnostics
    (problem,) = [p for p in found if p.code == "N116"]
    assert problem.labels[0].text == "declared here" and "always near" in problem.help


@pytest.mark.parametrize(
    ("statement", "fits"),
    [
        ("expect safe holds on {d: [9]} margin >= 8", True),
        ("expect safe holds on {d: [9]} margin >= 8.1", False),
        ("expect safe fails on {d: [1]} margin >= 2", True),
        ("expect safe fails on {d: [1]} margin >= 2.5", False),
        ("expect late holds on {d: [1]} margin >= 1000", True),
    ],
)
def test_a_margin_that_no_trace_can_give_is_refused(statement, fits):
    head = "signal d in [0, 10]\nhard safe: always (d > 2)\nhard late: always[3, 4] (d > 2)\n"
    assert said(statement, head) == ([] if fits else [("T208", statement.split(">= ")[1])])
