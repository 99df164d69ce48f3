"""Ratios compare the right figures, with what the rounds allow."""

import pytest

from tests.benchmarks import offline
from tests.benchmarks.contest import Figure

FIGURES = {"stlspec": Figure(2.0, 1.0, 4.0, (1.0,)), "other": Figure(20.0, 16.0, 24.0, (2.0,)), "none": Figure()}


def test_a_peer_that_takes_ten_times_as_long_makes_us_ten_times_faster():
    goal = offline.faster("t", FIGURES, "other", 5)
    assert (goal.value, goal.least, goal.most) == (10.0, 4.0, 24.0)
    assert goal.met
    assert goal.close
    assert offline.ratio(FIGURES, "other") == 10.0


def test_a_missing_peer_leaves_the_goal_open():
    assert offline.faster("t", FIGURES, "none", 5).met is None
    assert offline.ratio(FIGURES, "none") is None


def test_the_exponent_is_that_of_passes_not_of_seconds():
    figures = {n: (Figure(3 * n**1.25), Figure(float(n))) for n in (10, 100, 1000)}
    assert offline.exponent(figures) == pytest.approx(0.25)


def test_other_values_are_marked():
    notes = offline.agreement(FIGURES)
    assert notes["stlspec"] == ""
    assert notes["other"].startswith("other values")


class FakeArena:
    """Gives every contestant the same figure: only the wiring of a section is tested."""

    quick = False

    def contest(self, jobs):
        return {label: Figure(1e-8, 1e-8, 1e-8, (1.0,)) for label in jobs}

    def values(self, tool, job):
        return [7.0] if job["kind"] == "operations" else [14.0, 11.0]


class FakeData:
    long = short = batch = ""

    def job(self, tool, kind, formulas, data, n, **more):
        return tool, {"kind": kind, "n": n}


@pytest.mark.parametrize("part", ["windows", "until", "batch", "passes", "memory"])
def test_every_part_gives_sections_with_figures_and_goals(part):
    found = getattr(offline, part)(FakeArena(), FakeData())
    for section in found if isinstance(found, list) else [found]:
        assert section.rows or section.notes
        assert all(goal.value is not None for goal in section.goals)
