"""One trace, a batch and traces of unequal length are told apart by their shape."""

import numpy as np
import pytest

from stlspec.errors import DataError, UsageError
from stlspec.semantics.layout import arrange, own_time


def groups(signals, time=None, names=("x", "y")):
    return [(g.numbers if g.numbers is None else tuple(g.numbers)) for g in arrange(names, signals, time).groups]


@pytest.mark.parametrize("values", [[1, 2, 3], (1, 2), np.zeros(4), [], [True]])
def test_a_sequence_of_numbers_is_one_trace(values):
    assert groups({"x": values}) == [None]


@pytest.mark.parametrize("values", [np.zeros((2, 5)), [[1, 2], [3, 4]], [np.zeros(3), np.ones(3)]])
def test_rows_of_one_length_are_a_batch(values):
    assert groups({"x": values}) == [(0, 1)]


def test_rows_of_unequal_length_are_grouped_by_length():
    layout = arrange(["x"], {"x": [[1], [2, 3], [4], [5, 6]]})
    assert layout.ragged
    assert [(g.numbers, g.signals["x"]) for g in layout.groups] == [
        ((0, 2), [[1], [4]]),
        ((1, 3), [[2, 3], [5, 6]]),
    ]


def test_rows_with_their_own_times_are_grouped_by_these():
    layout = arrange(["x"], {"x": np.zeros((3, 2))}, [[0, 1], [0, 2], [0, 1]])
    assert [g.numbers for g in layout.groups] == [(0, 2), (1,)]
    assert not layout.ragged


def test_undeclared_columns_do_not_count():
    assert groups({"x": [1, 2], "image": np.zeros((2, 3, 3))}) == [None]


@pytest.mark.parametrize(
    ("signals", "time", "code"),
    [
        ([1, 2], None, "D813"),
        ({"x": [[1], [2, 3]], "y": [[1]]}, None, "D813"),
        ({"x": [[1], [2, 3]], "y": [1, 2]}, None, "D813"),
        ({"x": [1, 2]}, [[0, 1]], "D813"),
        ({"x": [[1], 2]}, None, "D813"),
        ({"x": [[1], [2, 3]], "y": [[1], [2]]}, None, "D805"),
        ({"x": [[1], [2]]}, [[0]], "D813"),
    ],
)
def test_rows_that_do_not_belong_together_are_refused(signals, time, code):
    with pytest.raises(DataError) as caught:
        arrange(["x", "y"], signals, time)
    assert caught.value.diagnostics[0].code == code


def test_the_trace_of_unequal_length_is_named():
    with pytest.raises(DataError, match=r"--> runs, trace 1"):
        arrange(["x", "y"], {"x": [[1], [2, 3]], "y": [[1], [2]]}, file="runs")


def test_traces_whose_whole_stamps_differ_by_a_nanosecond_do_not_share_them():
    stamps = [[10**18, 10**18 + 1], [10**18, 10**18 + 2]]
    assert groups({"x": [[1, 2], [3, 4]]}, stamps) == [(0,), (1,)]


@pytest.mark.parametrize(
    ("names", "signals", "time", "stamps"),
    [
        ({"x"}, {"x": [1, 2], "time": [0, 5]}, None, [0, 5]),
        ({"x"}, {"x": [1, 2], "time": None}, [0, 5], [0, 5]),
        ({"x"}, {"x": [1, 2]}, [0, 5], [0, 5]),
        ({"x", "time"}, {"x": [1, 2], "time": [0, 5]}, None, None),
        ({"x", "time"}, {"x": [1, 2], "time": [0, 5]}, [3, 4], [3, 4]),
        ({"x"}, 7, None, None),
    ],
)
def test_the_key_time_means_the_stamps_unless_a_signal_has_the_name(names, signals, time, stamps):
    assert own_time(names, signals, time) == stamps


def test_stamps_in_two_places_are_refused():
    with pytest.raises(UsageError, match="given twice") as caught:
        own_time({"x"}, {"x": [1, 2], "time": [0, 5]}, [0, 5])
    assert caught.value.diagnostics[0].code == "D880"
