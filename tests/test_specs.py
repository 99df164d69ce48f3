"""The specs of the paper's tasks run, and say what their comments say."""

from pathlib import Path

import pytest

import stlspec
from stlspec.tools.expectations import load_tests, run_tests

SPECS = Path(__file__).parents[1] / "specs"
PAIRS = {
    "frozenlake_4x4": ("frozenlake_4x4.jsonl", ["good", "incomplete", "bad"]),
    "frozenlake_8x8": ("frozenlake_8x8.jsonl", ["good", "incomplete", "incomplete", "bad"]),
    "grid_single_goal": ("grid_5x5.jsonl", ["good", "incomplete", "bad", "incomplete"]),
    "grid_two_goals": ("grid_5x5_two_goals.jsonl", ["good", "good", "bad"]),
    "grid_wet_dry": ("grid_wet_dry.jsonl", ["good", "incomplete", "bad"]),
    "mountain_car": ("mountain_car.jsonl", ["good", "incomplete", "incomplete"]),
    "example_1": ("example_1.json", ["bad", "good"]),
    "example_2": ("example_2.csv", ["incomplete"]),
}

LIVE = {"point_maze"}
"""Specs of environments that the tests do not have; tests/sb3 runs them."""


def test_every_spec_has_demonstrations_here() -> None:
    assert {path.stem for path in SPECS.glob("*.stl")} == PAIRS.keys() | LIVE
    for name in LIVE:
        assert [r.strength for r in stlspec.compile(SPECS / f"{name}.stl").requirements] == ["hard", "soft"]


@pytest.mark.parametrize("name", PAIRS)
def test_demonstrations_get_the_labels_that_they_were_made_for(name: str) -> None:
    file, labels = PAIRS[name]
    bundle = stlspec.compile(SPECS / f"{name}.stl")
    ranking = stlspec.score(bundle, stlspec.load_demonstrations([SPECS / "demos" / file]))
    assert [d.label for d in ranking.demonstrations] == labels


def test_the_sine_touches_its_bound_and_holds() -> None:
    bundle = stlspec.compile(SPECS / "example_2.stl")
    (row,) = stlspec.score(bundle, stlspec.load_demonstrations([SPECS / "demos" / "example_2.csv"])).demonstrations
    bounded = row.requirements["bounded"].result
    assert (bounded.robustness, bounded.verdict) == (0.0, stlspec.Verdict.SATISFIED)
    assert row.requirements["positive_for_a_period"].result.robustness == -1.0


@pytest.mark.parametrize("name", PAIRS)
def test_what_the_specs_expect_is_met(name: str) -> None:
    assert [o.text for o in run_tests(load_tests(SPECS / f"{name}.stl")) if o.result != "met"] == []
