"""Blocks are checked as a whole recording is, and pieces count from its first sample."""

import numpy as np
import pytest

from stlspec import api
from stlspec.errors import DataError
from stlspec.semantics.streaming.pieces import Pieces
from stlspec.traces import make_trace


def pieces(text="signal x in [0, 9]\nhard r: always (x > 1)\n"):
    return Pieces(api.compile(text), "here")


def test_a_piece_keeps_the_numbers_of_its_samples():
    held = pieces()
    held.add({"x": [1, 2]}, None, 2)
    held.add({"x": [3, 4, 5]}, None, 3)
    whole = held.joined()
    assert whole.times.tolist() == [0, 1, 2, 3, 4] and whole.first == 0
    held.drop(3)
    held.add({"x": [6]}, None, 1)
    left = held.joined()
    assert (left.first, left.times.tolist(), left.signals["x"].tolist()) == (3, [3, 4, 5], [4, 5, 6])
    assert (held.n, held.kept, held.waiting) == (6, 3, 0)


@pytest.mark.parametrize(
    ("header", "stamps"),
    [
        ("time s\n", [0.5, 0.75, 1.25, 4.0]),
        ("time ns\n", [1_700_000_000_000_000_001, 1_700_000_000_000_000_002, 1_700_000_000_000_000_004, 2**62]),
        ("time 100 ms\n", [3.0, 103.0, 303.5, 402.5]),
        ("", [1.0, 2.0, 5.0, 6.0]),
    ],
)
@pytest.mark.parametrize("cut", [1, 2, 3])
def test_ticks_are_those_of_the_whole(header, stamps, cut):
    bundle = api.compile(header + "signal x\nhard r: always (x > 1)\n")
    whole = make_trace(bundle.time, bundle.signals, {"x": [1.0] * 4}, stamps)
    held = Pieces(bundle, None)
    for part in (stamps[:cut], stamps[cut:]):
        held.add({"x": np.ones(len(part))}, np.array(part), len(part))
    found = held.joined()
    assert found.times.tolist() == whole.times.tolist() and found.spacing == whole.spacing
    assert (found.stamps is None) == (whole.stamps is None)
    assert whole.stamps is None or found.stamps.tolist() == whole.stamps.tolist()


@pytest.mark.parametrize(
    ("header", "x", "time", "code", "place"),
    [
        ("", [1, float("nan")], None, "D801", "at sample 4"),
        ("", [1, 10], None, "D807", "at sample 4"),
        ("", [1, "fast"], None, "D806", "at sample 4"),
        ("time s\n", [1, 1], [5, 5], "D802", "at sample 4"),
        ("time s\n", [1, 1], [2, 3], "D802", "at sample 3"),
        ("time s\n", [1, 1], [5, float("inf")], "D812", "at sample 4"),
        ("time 1 s\n", [1, 1], [5, 6.5], "D811", "sample 4"),
    ],
)
def test_what_is_refused_is_named_by_its_number_in_the_recording(header, x, time, code, place):
    held = pieces(header + "signal x in [0, 9]\nhard r: always (x > 1)\n")
    held.add({"x": [1, 2, 3]}, [0, 1, 2] if time else None, 3)
    with pytest.raises(DataError) as caught:
        held.add({"x": x}, None if time is None else np.array(time, dtype=float), 2)
    (found,) = caught.value.diagnostics
    assert found.code == code and place in found.message and found.file == "here"


def test_a_recording_has_samples():
    with pytest.raises(DataError, match="D803"):
        pieces().check_begun()
