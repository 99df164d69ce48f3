"""What a text declares, and which statements may stand only once."""

from dataclasses import replace

import pytest

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.names import declare
from stlspec.lang.parse import parse
from stlspec.source import SourceText


def declared(text):
    problems = []
    return declare(parse(SourceText.of("s", text)), problems), [d.code for d in problems]


def help_of(text):
    problems = []
    declare(parse(SourceText.of("s", text)), problems)
    return problems[0].help


def test_each_kind_of_name_has_its_table_and_its_place():
    found, problems = declared('spec s "T"\nsignal x\nparam p\nlet q = x > p\nhard a: q\nsoft b: q')
    assert problems == []
    assert (found.spec_name, found.title) == ("s", "T")
    assert [list(t) for t in (found.signals, found.params, found.lets, found.requirements)] == [
        ["x"],
        ["p"],
        ["q"],
        ["a", "b"],
    ]
    assert found.places["q"].start == len('spec s "T"\nsignal x\nparam p\nlet ')


@pytest.mark.parametrize("second", ["signal x", "param x = 1", "let x = 1", "hard x: true"])
def test_all_kinds_share_one_space_of_names(second):
    found, problems = declared(f"signal x\n{second}")
    assert problems == ["N102"]
    assert list(found.signals) == ["x"]


@pytest.mark.parametrize(
    ("statement", "expected"),
    [
        ("", TimeBase("step", "step", 1)),
        ("time step", TimeBase("step", "step", 1)),
        ("time 1 step", TimeBase("step", "step", 1)),
        ("time s", TimeBase("stamps", "s", 10**9)),
        ("time 100 ms", TimeBase("period", "ms", 10**6, 10**8)),
        ("time 0.5 h", TimeBase("period", "h", 3600 * 10**9, 1800 * 10**9)),
        ("time 0.1 us", TimeBase("period", "us", 1000, 100)),
    ],
)
def test_the_time_statement_gives_the_time_base(statement, expected):
    found, problems = declared(f"signal x\n{statement}")
    assert (found.time, found.time_known, problems) == (expected, True, [])


@pytest.mark.parametrize(
    ("statement", "code"),
    [
        ("time metres", "U305"),
        ("time 2 step", "U305"),
        ("time 0 s", "I406"),
        ("time 0.1 ns", "I406"),
        ("time 1e12 h", "I406"),
    ],
)
def test_a_wrong_time_statement_is_reported_and_the_time_base_is_not_known(statement, code):
    found, problems = declared(f"signal x\n{statement}")
    assert (problems, found.time_known) == ([code], False)


@pytest.mark.parametrize(
    ("written", "period"), [("10 Hz", "100 ms"), ("60 Hz", "16.6666667 ms"), ("0.5 kHz", "2 ms"), ("0.1 Hz", "10 s")]
)
def test_a_rate_is_answered_with_its_period(written, period):
    assert help_of(f"time {written}").endswith(f"; a rate of {written} is `time {period}`")


@pytest.mark.parametrize("rate", ["0 Hz", "1e12 MHz", "2 furlongs"])
def test_a_rate_without_a_period_is_not(rate):
    assert "rate" not in help_of(f"time {rate}")


def test_a_spec_or_time_statement_out_of_place_is_reported_once():
    assert declared("spec a\nsignal x\nspec b\nspec c\ntime s\ntime s\ntime s")[1] == ["S014"] * 4
    assert declared("signal x\nspec a")[1] == ["S014"]


def test_requirements_of_used_files_are_kept_apart():
    used = parse(SourceText.of("base.stl", "signal d\nhard safe: d > 1"))
    syntax = replace(parse(SourceText.of("s", "hard safe: d > 2")), used=(used,))
    problems = []
    found = declare(syntax, problems)
    assert (list(found.requirements), list(found.elsewhere), problems) == (["safe"], ["safe"], [])
    assert found.place("d").source.name == "base.stl" and found.place("safe").source.name == "s"
