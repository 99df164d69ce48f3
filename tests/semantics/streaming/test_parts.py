"""Folds give the value at sample 0 and its earliest reason, however the samples are cut; numbers by hand."""

import pytest

from stlspec import api
from stlspec.semantics.streaming import Stream


def outcome(formula, x, cut):
    stream = Stream(api.compile(f"signal x\nsignal y\nhard r: {formula}\n"), block=1)
    y = [0.0, 5.0, 1.0, 5.0, 2.0]
    for begin in range(0, len(x), cut):
        n = len(x[begin : begin + cut])
        stream.take({"x": x[begin : begin + n], "y": y[begin : begin + n]}, None, n)
    found = stream.finish()["r"]
    return found.robustness, None if found.witness is None else found.witness.sample, found.vacuous


@pytest.mark.parametrize("cut", [1, 2, 5])
@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("always (x > 0)", (1.0, 1, False)),  # 1 at samples 1 and 3
        ("eventually[2, 3] (x > 0)", (3.0, 2, False)),
        ("always[7, 9] (x > 0)", (float("inf"), None, True)),
        ("always (x > 0 or next (x > 0))", (2.0, 0, False)),  # 2 at sample 0 and for 1 from 1 and 3 with 3 and 4
        ("(x > 0) until (y > 4)", (1.0, 1, False)),
        ("(x > 0) until[3, 4] (y > 0)", (1.0, 1, False)),
        ("(x > 1.5) until (y > 0)", (0.5, 0, False)),
        ("x > 5", (-3.0, 0, False)),
        ("not always (x > 0) or next (y > 0)", (5.0, 1, False)),
    ],
)
def test_values_and_witnesses(formula, expected, cut):
    assert outcome(formula, [2.0, 1.0, 3.0, 1.0, 4.0], cut) == expected
