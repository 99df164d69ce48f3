"""Extents enclose every value: by hand where they are tight, on random traces where they are not."""

import math
import random

import pytest

import stlspec
from stlspec.compiler.checks import check
from stlspec.compiler.extents import Extents
from stlspec.lang.parse import parse
from stlspec.source import SourceText

HEAD = "signal x in [0, 10]\nsignal y in [-2, 3]\nsignal z\nparam k = 4\nlet far(p, r) = p > r\nlet gap = x - y\n"
INF = math.inf


def extent(formula):
    model, problems = check(parse(SourceText.of("s", f"{HEAD}hard a: {formula}")))
    assert not [p for p in problems if p.severity == "error"]
    return Extents(model).of(model.declared.requirements["a"].formula)


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("x > 2", (-2, 8)),
        ("x < k", (-6, 4)),
        ("2 <= x <= 9", (-2, 8)),
        ("x == 4", (-6, 0)),
        ("x != 14", (4, 14)),
        ("abs(y) > 1", (-1, 2)),
        ("gap > 0", (-3, 12)),
        ("x * y > 0", (-20, 30)),
        ("x / (y + 3) > 0", (0, 10)),
        ("x / y > 0", (-INF, INF)),
        ("min(x, y) > 0", (-2, 3)),
        ("-x > 0", (-10, 0)),
        ("z > 0", (-INF, INF)),
        ("not x > 2", (-8, 2)),
        ("x > 2 and y > 0", (-2, 3)),
        ("x > 2 or y > 0", (-2, 8)),
        ("x > 2 implies y > 0", (-2, 3)),
        ("far(x, k)", (-4, 6)),
        ("far(y, 1) and far(x, 1)", (-3, 2)),
        ("always[0, 3] (x > 2)", (-2, 8)),
        ("always[1, 3] (x > 2)", (-2, INF)),
        ("eventually[1, 3] (x > 2)", (-INF, 8)),
        ("sqrt(x + 6) > 0", (math.sqrt(6), 4)),
        ("sin(x) > 0", (-1, 1)),
        ("delta(x) > 0", (-INF, INF)),
        ("next (x > 2)", (-INF, 8)),
        ("wprev (x > 2)", (-2, INF)),
        ("(y > 0) until (x > 2)", (-2, 8)),
        ("(y > 0) until[1, 2] (x > 2)", (-INF, 8)),
        ("true", (INF, INF)),
        ("x > 2 iff y > 0", (-INF, INF)),
    ],
)
def test_what_ranges_say_of_a_formula(formula, expected):
    assert extent(formula) == expected


def test_powers_leave_room_for_the_last_digits():
    low, high = extent("y ** 2 > 0")
    assert low == 0
    assert 9 <= high < 9 + 1e-12


def test_random_traces_stay_inside():
    rng = random.Random(3)
    atoms = ["x > 2", "y <= 1", "abs(x - y) < k", "x * y > 3", "far(x, y)", "0 <= gap <= 5", "max(x, 2 * y) != 4"]
    atoms += ["sqrt(x) > 1", "exp(y) < 3", "hypot(x, y) >= 2", "y ** 2 > 1", "x / (y + 3) > 1", "sin(x) * y > 0"]

    def formula(depth):
        if not depth:
            return f"({rng.choice(atoms)})"
        a, b = formula(depth - 1), formula(depth - 1)
        return rng.choice(
            [
                f"(not {a})",
                f"({a} and {b})",
                f"({a} or {b})",
                f"({a} implies {b})",
                f"(always[1, 2] {a})",
                f"(once {a})",
                f"({a} until[0, 2] {b})",
                f"({a} since[1, 2] {b})",
                f"(wnext {a})",
            ]
        )

    for _ in range(120):
        text = formula(rng.randint(1, 3))
        low, high = extent(text)
        bundle = stlspec.compile(f"{HEAD}hard a: {text}")
        signals = {"x": [rng.randint(0, 10) for _ in range(6)], "y": [rng.randint(-2, 3) for _ in range(6)]}
        for value in bundle.evaluate(signals)["a"].signal.tolist():
            assert low <= value <= high, text


def test_units_that_are_converted_are_left_open():
    model, _ = check(parse(SourceText.of("s", 'signal t1 unit "ms" in [0, 10]\nhard a: t1 > 0.005 s')))
    assert Extents(model).of(model.declared.requirements["a"].formula) == (-INF, INF)
