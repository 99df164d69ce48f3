"""Figures become text with ratios and goals, and a document with the same numbers."""

import json

import pytest

from tests.benchmarks.contest import Figure
from tests.benchmarks.table import Goal, Section, document_of, number, text_of

FIGURES = {"stlspec": Figure(1e-8, 5e-9, 2e-8, (1.0,)), "other": Figure(1e-6, 1e-6, 1e-6), "none": Figure(error="gone")}


@pytest.fixture
def section():
    made = Section("a title")
    made.contest(FIGURES, notes={"other": "a note"})
    made.goals = [Goal("times faster", 100.0, 70), Goal("passes", 9.0, 8, at_least=False), Goal("x", None, 1)]
    return made


def test_the_text_shows_ratios_spreads_and_goals(section):
    lines = text_of(section).splitlines()
    assert lines[1].split() == ["stlspec", "100", "M", "samples/s", "1x", "50", "to", "200"]
    assert lines[2].split() == ["other", "1", "M", "samples/s", "100x", "1", "to", "1", "a", "note"]
    assert lines[3].split() == ["none", "-", "gone"]
    assert lines[4] == "  goal: times faster >= 70: 100  met"
    assert lines[5] == "  goal: passes <= 8: 9  MISSED"
    assert lines[6] == "  goal: x >= 1: -  not measured"


def test_the_document_is_json_with_the_same_numbers(section):
    document = json.loads(json.dumps(document_of([section], {"python": "3"}), allow_nan=False))
    (found,) = document["sections"]
    assert found["rows"][1]["median"] == pytest.approx(1.0)
    assert found["rows"][1]["ratio"] == pytest.approx(100.0)
    assert found["rows"][2] | {"error": "gone", "median": None, "unit": None} == found["rows"][2]
    assert [goal["met"] for goal in found["goals"]] == [True, False, None]


@pytest.mark.parametrize(
    ("goal", "text"),
    [
        (Goal("t", 5.1, 5, least=4.6, most=5.5), "  goal: t >= 5: 5.1  met, but the rounds allow 4.6 to 5.5"),
        (Goal("t", 5.1, 5, least=5.05, most=5.5), "  goal: t >= 5: 5.1  met"),
        (Goal("t", 4.9, 5, least=4.6, most=5.5), "  goal: t >= 5: 4.9  MISSED, but the rounds allow 4.6 to 5.5"),
    ],
)
def test_a_bound_within_the_spread_is_said_to_be_close(goal, text):
    assert text_of(Section("title", goals=[goal])).splitlines()[1] == text


@pytest.mark.parametrize(("unit", "shown"), [("M samples/s", 0.5), ("us", 2.0), ("ms", 2e-3), ("s", 2e-6)])
def test_two_microseconds_in_every_unit(unit, shown):
    assert number(2e-6, unit) == pytest.approx(shown)
