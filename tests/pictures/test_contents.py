"""A picture shows, as data, the signals, the violating spans, the witnesses and the robustness."""

from pathlib import Path

import numpy as np
import pytest

import stlspec
from stlspec.demos import make_demonstration
from stlspec.pictures.contents import (
    LARGEST_PANELS,
    Picture,
    joined,
    picture_of,
    plain,
    sample_edges,
    shaded_spans,
    thinned,
)
from stlspec.semantics.explain import explain

SPECS = Path(__file__).parents[2] / "specs"


def pictured(spec: str, signals: dict, time=None, name: str = "demo") -> Picture:
    bundle = stlspec.compile(spec)
    (score,) = stlspec.score(bundle, [make_demonstration(name, signals, time=time)]).demonstrations
    found = {n: explain(bundle, n, x.result) for n, x in score.requirements.items()}
    return picture_of(bundle, score, found)


SPEC = """time s
signal x unit "m"
signal door: bool
hard near: always (x <= 2)
soft closed: always not door
"""


def test_each_signal_and_each_requirement_has_a_panel() -> None:
    picture = pictured(SPEC, {"x": [1, 3, 2], "door": [False, False, False]}, time=[0, 1, 3])
    x, door = picture.signals
    assert (x.name, x.unit, x.boolean, x.bounds) == ("x", "m", False, (2.0,))
    assert (door.name, door.boolean, door.bounds, door.shaded) == ("door", True, (), ())
    assert picture.times.tolist() == [0, 1, 3]
    assert [(m.requirement, m.time, m.value) for m in x.marks] == [("near", 1.0, 3.0)]
    near, closed = picture.requirements
    assert near.values.tolist() == [-1, -1, 0]
    assert (near.strength, closed.strength) == ("hard", "soft")
    assert picture.label == "bad"
    assert picture.subtitle.startswith("bad, reward ")


def test_violating_samples_reach_half_way_to_their_neighbours() -> None:
    picture = pictured(SPEC, {"x": [1, 3, 3, 2, 5], "door": [False] * 5}, time=[0, 1, 3, 4, 5])
    assert picture.signals[0].shaded == (("near", (0.5, 3.5)), ("near", (4.5, 5.5)))


def test_nothing_is_shaded_where_nothing_is_violated() -> None:
    bundle = stlspec.compile("signal x\nhard h: eventually (x > 1)\n")
    found = explain(bundle, "h", bundle.evaluate({"x": [0, 0, 3]})["h"])
    assert shaded_spans(found, np.arange(3.0)) == []


def test_edges_of_samples() -> None:
    assert sample_edges(np.array([7.0])).tolist() == [6.5, 7.5]
    assert sample_edges(np.array([0.0, 1.0, 4.0])).tolist() == [-0.5, 0.5, 2.5, 5.5]


def test_spans_that_overlap_or_touch_become_one() -> None:
    assert joined([(3, 4), (0, 1), (1, 2), (0.5, 1.5)]) == [(0, 2), (3, 4)]
    assert joined([]) == []


def test_of_too_many_spans_the_nearest_are_joined_and_none_is_lost() -> None:
    spans = [(k + 0.4 + (k >= 500), k + 0.6 + (k >= 500)) for k in range(1000)]
    found = joined(spans)
    assert len(found) <= 400
    assert (found[0][0], found[-1][1]) == (0.4, 1000.6)
    assert not any(first < 500.9 and last > 500.1 for first, last in found), "the widest gap stays open"


def test_a_spike_survives_thinning() -> None:
    values = np.zeros(100_000)
    values[77_777] = 9.0
    middle, low, high = thinned(np.arange(100_000.0), values)
    assert len(middle) == len(low) == len(high) <= 1000
    assert (high.max(), low.max()) == (9.0, 0.0)
    assert abs(middle[high.argmax()] - 77_777) < 200


def test_there_are_never_more_than_the_most_panels_and_violations_come_first() -> None:
    n = LARGEST_PANELS + 5
    lines = [f"signal s{k}\nhard h{k}: always (s{k} > 0)\n" for k in range(n)]
    signals = {f"s{k}": [1, 1 if k < n - 1 else -1] for k in range(n)}
    picture = pictured("".join(lines), signals)
    assert len(picture.signals) == len(picture.requirements) == LARGEST_PANELS
    assert picture.signals[0].name == f"s{n - 1}"
    assert picture.left_out == 10


def test_names_are_made_to_fit_one_line() -> None:
    assert plain("a\nb\tc") == "a b c"
    assert len(plain("x" * 500)) == 60


@pytest.mark.parametrize(
    ("spec", "demos"), [("frozenlake_8x8", "frozenlake_8x8.jsonl"), ("example_2", "example_2.csv")]
)
def test_shaded_spans_hold_the_witness_of_a_violation(spec: str, demos: str) -> None:
    bundle = stlspec.compile(SPECS / f"{spec}.stl")
    for score in stlspec.score(bundle, stlspec.load_demonstrations([SPECS / "demos" / demos])).demonstrations:
        found = {n: explain(bundle, n, x.result) for n, x in score.requirements.items()}
        for panel in picture_of(bundle, score, found).signals:
            for mark in panel.marks:
                spans = [span for name, span in panel.shaded if name == mark.requirement]
                inside = any(first <= mark.time <= last for first, last in spans)
                assert inside == (mark.verdict.value == "violated")
