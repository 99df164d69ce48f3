"""How far ahead a formula looks."""

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.source import SourceText


def horizon(formula, time="step"):
    return compile_source(
        SourceText.of("s", f"time {time}\nsignal x\nlet p = x > 1\nlet q = x < 3\nhard a: {formula}")
    ).horizon


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("p", 0),
        ("always[0, 5] p", 5),
        ("always[0, 5] eventually[1, 3] q", 8),
        ("always[0, 5] p and eventually[0, 9] q", 9),
        ("p until[2, 7] always[0, 2] q", 9),
        ("(always[0, 20] p) until[2, 7] q", 27),
        ("next next p", 2),
        ("next always[0, 3] p", 4),
        ("wnext p", 1),
        ("once[0, 9] p", 0),
        ("once[0, 9] eventually[0, 4] p", 4),
        ("p since[0, 3] next q", 1),
        ("prev p", 0),
        ("p unless[1, 4] q", 4),
        ("p release[1, 4] q", 4),
        ("always p", None),
        ("always[3, inf] p", None),
        ("p and (p until q)", None),
    ],
)
def test_the_horizon_is_the_sum_of_bounds_along_the_deepest_path(formula, expected):
    assert horizon(formula) == expected


@pytest.mark.parametrize(
    ("formula", "time", "expected"),
    [
        ("always[0, 2 s] p", "s", 2 * 10**9),
        ("next p", "100 ms", 10**8),
        ("next always[0, 1 s] p", "100 ms", 11 * 10**8),
        ("next p", "s", 0),
    ],
)
def test_with_a_unit_it_is_in_nanoseconds_and_a_step_is_a_period(formula, time, expected):
    assert horizon(formula, time) == expected


def test_the_horizon_of_a_spec_is_the_longest_of_its_requirements():
    text = "signal x\nhard a: always[0, 3] x > 1\nhard b: always[0, 5] x > 1"
    bundle = compile_source(SourceText.of("s", text))
    assert ([r.horizon for r in bundle.requirements], bundle.horizon) == ([3, 5], 5)
    assert compile_source(SourceText.of("s", text + "\nhard c: always x > 1")).horizon is None
