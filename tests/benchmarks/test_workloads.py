"""All contestants get the same work: the same numbers, and formulas that mean the same where they can."""

import numpy as np
import pytest

import stlspec
from tests.benchmarks.workloads import EIGHT, SHAPES, Data, P, Q, closed, mirrored, spec_of_30_lines, texts, wave


@pytest.mark.parametrize("tool", ["stlspec", "mstlo", "rtamt", "stlrom", "moonlight", "reelay"])
def test_the_eight_requirements_have_a_spelling_for_every_tool(tool):
    assert len(texts(tool, EIGHT)) == 8


def test_stlspec_compiles_what_it_is_timed_with():
    requirements = "\n".join(f"hard r{i}: {text}" for i, text in enumerate(texts("stlspec", EIGHT)))
    bundle = stlspec.compile(f"signal x\nsignal y\n{requirements}\n")
    assert bundle.horizon == 500
    # Shared sub-formulas are computed once: 3 predicates with x, y, 3 constants, 2 windows, 4 inner, 8 roots.
    assert len(bundle.nodes) <= 25


def test_the_past_of_a_formula_is_its_mirror_image():
    assert mirrored(["G", [0, 3], ["U", None, P, Q]]) == ["H", [0, 3], ["S", None, P, Q]]


def test_mstlo_is_asked_for_the_nearest_until_that_it_has():
    assert closed(["F", [0, 1], ["U", [0, 3], P, Q]]) == ["F", [0, 1], ["U", [0, 3], P, ["and", P, Q]]]
    assert texts("mstlo", [["U", [0, 3], P, Q]]) == ["(x >= -0.5) U[0, 3] (y >= 0.5)"]


@pytest.mark.parametrize("shape", SHAPES)
def test_streams_stay_in_the_same_range_whatever_their_shape(shape):
    values = wave(shape, 500, np.random.default_rng(0))
    assert values.shape == (500,)
    assert values.min() >= -1
    assert values.max() <= 2
    steps = np.diff(values)
    assert {"rising": (steps > 0).all(), "falling": (steps < 0).all()}.get(shape, not (steps > 0).all())


def test_the_data_are_the_same_in_every_run(tmp_path):
    first, second = Data(tmp_path / "a", 1000), Data(tmp_path / "b", 1000)
    for name in ("long", "short", "batch"):
        with np.load(getattr(first, name)) as a, np.load(getattr(second, name)) as b:
            assert all(np.array_equal(a[key], b[key]) for key in ("x", "y"))


def test_the_spec_of_30_lines_has_30_lines_and_compiles():
    text = spec_of_30_lines()
    assert len(text.splitlines()) == 30
    assert len(stlspec.compile(text).requirements) == 12
