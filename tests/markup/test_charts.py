"""Charts: every value is on the picture, whatever it is, and the picture is small however long the trace."""

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stlspec.markup.charts import HEIGHT, WIDTH, Chart, chart_svg, robustness_svg


def drawn(values, times=None, **more) -> ElementTree.Element:
    values = np.array(values, dtype=float)
    times = np.arange(float(len(values))) if times is None else np.array(times, dtype=float)
    return ElementTree.fromstring(chart_svg(Chart("x", "", times, values, **more)))


def points(root: ElementTree.Element, name: str) -> list[tuple[float, float]]:
    path = next(e for e in root.iter("path") if name in (e.get("class") or "").split())
    line = re.match(r"M([^MaZ]*)", path.get("d")).group(1)
    return [tuple(map(float, p.split())) for p in line.split("L")]


def test_a_higher_value_is_drawn_higher_and_a_later_one_further_right() -> None:
    (x0, y0), (x1, y1), (x2, y2) = points(drawn([0, 2, 1]), "stl-curve")
    assert x0 < x1 < x2
    assert y1 < y2 < y0
    assert math.isclose(y2, (y0 + y1) / 2, abs_tol=0.11)
    assert math.isclose(x1, (x0 + x2) / 2, abs_tol=0.11)


@settings(max_examples=150, deadline=None)
@given(st.lists(st.floats(allow_nan=False), min_size=1, max_size=40))
def test_every_value_lies_within_the_picture(values: list[float]) -> None:
    root = drawn(values, zero=True, bounds=(1.0,))
    for x, y in points(root, "stl-curve"):
        assert 0 <= x <= WIDTH
        assert 0 <= y <= HEIGHT


def test_a_spike_in_a_long_trace_stays_and_the_picture_stays_small() -> None:
    values = np.zeros(100_000)
    values[77_777] = -9.0
    svg = chart_svg(Chart("x", "", np.arange(100_000.0), values))
    heights = [y for _, y in points(ElementTree.fromstring(svg), "stl-band")]
    assert max(heights) - min(heights) > 50
    assert len(svg) < 15_000


def test_infinities_are_named_and_beyond_all_finite_values() -> None:
    root = drawn([1, math.inf, 5])
    (_, y1), (_, top), (_, y5) = points(root, "stl-curve")
    assert top < y5 < y1
    assert "∞" in [e.text for e in root.iter("text")]


def test_booleans_are_steps_named_true_and_false() -> None:
    root = drawn([0, 1, 1], boolean=True)
    names = [e.text for e in root.iter("text")]
    assert "true" in names
    assert "false" in names
    heights = [y for _, y in points(root, "stl-curve")]
    assert heights[0] == heights[1] > heights[2] == heights[5]


def test_spans_are_shaded_and_witnesses_of_one_place_named_together() -> None:
    root = drawn([3, 1, 3], shaded=((0.5, 1.5),), marks=((1.0, 1.0, "near"), (1.0, 1.0, "far")), bounds=(2.0,))
    shade = next(e for e in root.iter("rect") if e.get("class") == "stl-shade")
    left, right = float(shade.get("x")), float(shade.get("x")) + float(shade.get("width"))
    (x0, _), (x1, _), (x2, _) = points(root, "stl-curve")
    assert x0 < left < x1 < right < x2
    assert "near, far" in [e.text for e in root.iter("text")]
    assert len([e for e in root.iter("path") if e.get("class") == "stl-mark"]) == 1


@pytest.mark.parametrize(("unit", "shown"), [("", "4"), ("s", "4 s")])
def test_the_last_time_has_the_unit(unit: str, shown: str) -> None:
    assert shown in [e.text for e in drawn([1, 1], times=[2, 4], unit=unit).iter("text")]


def test_a_robustness_says_its_verdict_in_words() -> None:
    svg = robustness_svg("avoid", np.arange(2.0), np.array([-1.0, 2.0]), "violated", 0.0, -1.0, vacuous=True)
    root = ElementTree.fromstring(svg)
    assert root.find("title").text == "avoid: violated, robustness -1, vacuous"
    assert any("stl-violated" in (e.get("class") or "") for e in root.iter("path"))
