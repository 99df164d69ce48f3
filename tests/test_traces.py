"""Recorded columns become a trace once, on integer time, or are refused with the offending sample."""

import numpy as np
import pytest

from stlspec import traces
from stlspec.compiler.bundle import Signal, TimeBase
from stlspec.errors import DataError
from stlspec.traces import make_trace, ticks_array

STEP = TimeBase("step", "step", 1)
SECONDS = TimeBase("stamps", "s", 10**9)
TENTHS = TimeBase("period", "ms", 10**6, period=100 * 10**6)
X = Signal("x")
INF = float("inf")


def refused(code, *arguments, **named):
    with pytest.raises(DataError) as caught:
        make_trace(*arguments, **named)
    (found,) = caught.value.diagnostics
    assert found.code == code
    return found.message


@pytest.mark.parametrize(
    "values",
    [[1, 0, 2], (1.0, 0.0, 2.0), np.array([1, 0, 2], np.int8), np.array([1, 0, 2], np.float32), [True, False, 2]],
)
def test_lists_and_arrays_of_any_real_type_are_samples(values):
    trace = make_trace(STEP, [X], {"x": values})
    assert trace.signals["x"].tolist() == [1.0, 0.0, 2.0]
    assert trace.signals["x"].dtype == np.float64


def test_booleans_are_stored_as_one_and_zero():
    trace = make_trace(STEP, [Signal("b", "bool")], {"b": [True, 0, 1.0]})
    assert trace.signals["b"].tolist() == [1.0, 0.0, 1.0]


def test_a_trace_shares_no_memory_with_the_callers_arrays_and_cannot_be_written_to():
    x, stamps = np.array([1.0, 2.0]), np.array([0.0, 1.0])
    trace = make_trace(SECONDS, [X], {"x": x}, stamps)
    x[0] = stamps[1] = 9
    assert trace.signals["x"].tolist() == [1.0, 2.0]
    assert trace.time(1) == 1.0
    with pytest.raises(ValueError, match="read-only"):
        trace.signals["x"][0] = 3


@pytest.mark.parametrize("order", ["C", "F"])
def test_a_batch_is_laid_out_time_major_and_copied(order):
    x = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], order=order)
    trace = make_trace(STEP, [X], {"x": x})
    x[0, 0] = 9
    assert trace.shape == (3, 2)
    assert trace.signals["x"].tolist() == [[1, 4], [2, 5], [3, 6]]
    assert trace.signals["x"].flags.c_contiguous


def test_steps_are_counted_and_their_stamps_only_checked_to_increase():
    trace = make_trace(STEP, [X], {"x": [1, 2, 3]}, [5.0, 5.5, 9.0])
    assert trace.times.tolist() == [0, 1, 2]
    assert (trace.spacing, trace.time(2)) == (1, 2.0)


def test_stamps_become_nanoseconds_since_the_first():
    trace = make_trace(SECONDS, [X], {"x": [1, 2, 3]}, [0.1, 0.2, 0.4])
    assert trace.times.tolist() == [0, 100_000_000, 300_000_000]
    assert trace.spacing is None
    assert trace.time(2) == 0.4


def test_large_epoch_stamps_keep_their_differences():
    trace = make_trace(SECONDS, [X], {"x": [1, 2, 3]}, [1.7e9, 1.7e9 + 0.5, 1.7e9 + 1])
    assert trace.times.tolist() == [0, 500_000_000, 1_000_000_000]
    assert trace.spacing == 500_000_000


def test_a_period_needs_no_stamps():
    trace = make_trace(TENTHS, [X], {"x": [1, 2, 3]})
    assert trace.times.tolist() == [0, 100_000_000, 200_000_000]
    assert (trace.spacing, trace.time(2)) == (100_000_000, 200.0)


def test_stamps_within_one_percent_of_a_period_are_taken_as_that_period():
    trace = make_trace(TENTHS, [X], {"x": [1, 2, 3]}, [10, 111, 309])
    assert trace.times.tolist() == [0, 100_000_000, 300_000_000]
    assert trace.spacing is None


@pytest.mark.parametrize(("stamps", "sample"), [([0, 101.1], 1), ([0, 100, 250], 2), ([0, 100, 100.5], 2)])
def test_a_stamp_off_the_period_is_refused(stamps, sample):
    message = refused("D811", TENTHS, [X], {"x": [0] * len(stamps)}, stamps)
    assert f"sample {sample} at {stamps[sample]:g} ms is not a multiple of the period 100 ms" in message


def test_one_sample_counts_as_evenly_spaced():
    assert make_trace(SECONDS, [X], {"x": [1]}, [3.0]).spacing is not None


def test_undeclared_columns_are_ignored_and_declared_ones_may_be_absent_if_not_required():
    trace = make_trace(STEP, [X, Signal("y")], {"x": [1, 2], "note": ["a"]}, required={"x"})
    assert list(trace.signals) == ["x"]


def test_an_undeclared_column_tells_the_number_of_samples_if_no_declared_one_is_there():
    assert make_trace(STEP, [], {"note": [1, 2, 3]}).n_samples == 3
    assert make_trace(SECONDS, [], {}, [0, 1]).n_samples == 2


def test_a_missing_signal_is_refused_with_a_suggestion():
    with pytest.raises(DataError) as caught:
        make_trace(STEP, [Signal("d_obs")], {"dobs": [1.0]})
    (found,) = caught.value.diagnostics
    assert found.code == "D804"
    assert "did you mean 'dobs'?" in found.help


def test_nan_is_refused_with_signal_sample_and_time():
    message = refused("D801", SECONDS, [X], {"x": [1, np.nan]}, [0, 0.5])
    assert message == "signal 'x' is NaN at sample 1 (time 0.5)"


def test_nan_in_a_batch_is_refused_with_the_trace():
    message = refused("D801", STEP, [X], {"x": [[1, 2], [1, np.nan]]}, numbers=(4, 7))
    assert "sample 1 of trace 7" in message


def test_infinite_samples_are_values():
    assert make_trace(STEP, [X], {"x": [INF, -INF]}).signals["x"].tolist() == [INF, -INF]


@pytest.mark.parametrize(
    ("values", "sample"),
    [
        *[([1, "2"], 1), (["a"], 0), ([1, 2j], 1), (np.array(["x"]), 0), ([10**400], 0)],
        *[([1.5, 2.5, b"3"], 2), ((True, "1"), 1), ([1.0, 10**400], 1)],
    ],
)
def test_a_value_that_is_no_number_is_refused(values, sample):
    assert f"at sample {sample}" in refused("D806", STEP, [X], {"x": values})


def test_a_bool_signal_takes_truth_values_only():
    message = refused("D806", STEP, [Signal("b", "bool")], {"b": [1, 0, 2]})
    assert message == "signal 'b' has 2 at sample 2, which is not a bool value"


def test_a_bad_value_in_a_batch_names_its_trace():
    batch = {"b": [[1, 0], [1, 7]]}
    assert "7 at sample 1 of trace 1" in refused("D806", STEP, [Signal("b", "bool")], batch)
    assert "'z' at sample 0 of trace 1" in refused("D806", STEP, [X], {"x": [[1.0], ["z"]]})


def test_a_sample_outside_its_declared_range_is_refused():
    message = refused("D807", STEP, [Signal("x", low=0, high=5)], {"x": [0, 5, 5.5]})
    assert message == "signal 'x' is 5.5 at sample 2 (time 2), outside its range [0, 5]"
    refused("D807", STEP, [Signal("x", low=0)], {"x": [-INF]})


def test_signals_and_time_are_of_one_length():
    assert "'y' has 2 samples, but 'x' has 1" in refused("D805", STEP, [X, Signal("y")], {"x": [1], "y": [1, 2]})
    assert "'time' has 1 sample" in refused("D805", STEP, [X], {"x": [1, 2]}, [0])


@pytest.mark.parametrize(
    ("signals", "time"),
    [
        ({"x": 3}, None),
        ({"x": [[[1]]]}, None),
        ({"x": [[1, 2], [3]]}, None),
        ({"x": [[1], "a"]}, None),
        ({"x": [1, 2], "y": [[1, 2]]}, None),
        ({"x": [[1], [2]], "y": [[1]]}, None),
        ({"x": [1, 2]}, [[0, 1]]),
    ],
)
def test_data_of_a_wrong_shape_are_refused(signals, time):
    refused("D813", STEP, [X, Signal("y")], signals, time, required={"x"})


@pytest.mark.parametrize("signals", [{"x": []}, {"x": [[], []]}, {"x": np.empty((0, 3))}, {}])
def test_no_samples_are_refused(signals):
    refused("D803", STEP, [X], signals, required=())


@pytest.mark.parametrize("base", [STEP, SECONDS, TENTHS])
def test_time_must_increase(base):
    assert "sample 2: 100 comes after 100" in refused("D802", base, [X], {"x": [1, 2, 3]}, [0, 100, 100])


def test_stamps_less_than_a_nanosecond_apart_count_as_equal():
    refused("D802", SECONDS, [X], {"x": [1, 2]}, [0, 1e-10])


@pytest.mark.parametrize("stamp", [INF, np.nan, 1e300, 5e9])
def test_a_stamp_that_does_not_fit_is_refused(stamp):
    assert "at sample 1" in refused("D812", SECONDS, [X], {"x": [1, 2]}, [0, stamp])


@pytest.mark.parametrize(("base", "step"), [(STEP, 1), (TENTHS, 100 * 10**6)])
def test_evenly_spaced_ticks_take_no_memory_and_are_the_same_as_an_array(base, step):
    trace = make_trace(base, [X], {"x": [1.0] * 5})
    assert trace.ticks == range(0, 5 * step, step)
    assert trace.times.tolist() == list(trace.ticks)
    assert trace.times.dtype == np.int64
    assert not trace.times.flags.writeable
    assert trace.time(3) == 3 * step / base.ticks_per_unit


@pytest.mark.parametrize("n", [4, traces._LONGEST_SHARED + 1])
def test_a_part_of_the_ticks_is_a_part_of_the_array(n):
    whole = range(0, 3 * n, 3)
    assert np.array_equal(ticks_array(whole[2:]), ticks_array(whole)[2:])


def test_a_unit_needs_stamps():
    assert "measures time in s" in refused("D810", SECONDS, [X], {"x": [1]})


def test_the_file_is_named():
    with pytest.raises(DataError, match=r"run\.csv"):
        make_trace(STEP, [X], {"x": [np.nan]}, file="run.csv")


EPOCH = 1_700_000_000_123_456_789
NANOSECONDS = TimeBase("stamps", "ns", 1)


@pytest.mark.parametrize("kind", [list, np.array, lambda stamps: np.array(stamps, dtype=np.uint64)])
def test_whole_stamps_keep_every_nanosecond(kind):
    stamps = [EPOCH + k * 10_000_000 for k in range(5)]
    trace = make_trace(NANOSECONDS, [X], {"x": range(5)}, kind(stamps))
    assert trace.times.tolist() == [0, 10_000_000, 20_000_000, 30_000_000, 40_000_000]
    assert trace.spacing == 10_000_000
    assert trace.time(4) == float(stamps[4])


@pytest.mark.parametrize("base", [STEP, NANOSECONDS, TimeBase("period", "ns", 1, period=1)])
def test_whole_stamps_closer_than_floats_can_tell_still_increase(base):
    assert make_trace(base, [X], {"x": [1, 2, 3]}, [EPOCH, EPOCH + 1, EPOCH + 2]).times.tolist() == [0, 1, 2]
    message = refused("D802", base, [X], {"x": [1, 2]}, [EPOCH + 1, EPOCH])
    assert f"{EPOCH} comes after {EPOCH + 1}" in message


def test_whole_stamps_too_far_apart_are_refused():
    refused("D812", NANOSECONDS, [X], {"x": [1, 2]}, np.array([-(2**63), 2**63 - 1]))


@pytest.mark.parametrize(
    "values",
    [
        np.ma.array([1, 2], mask=[0, 1]),
        np.ma.array([1.0, 2.0], mask=[0, 1]),
        np.ma.array([1, 2], mask=[0, 1], dtype=object),
        [np.ma.array([1, 2], mask=[0, 1]), np.array([1, 2])],
    ],
)
def test_a_masked_value_is_no_sample(values):
    assert "NaN at sample 1" in refused("D801", STEP, [X], {"x": values})


def test_a_masked_boolean_and_a_masked_stamp_are_no_samples():
    refused("D801", STEP, [Signal("b", "bool")], {"b": np.ma.array([True, False], mask=[0, 1])})
    refused("D812", SECONDS, [X], {"x": [1, 2]}, np.ma.array([0, 1], mask=[0, 1]))


@pytest.mark.parametrize(
    ("period", "unit", "size", "stamps", "said"),
    [
        (10**8, "ms", 10**6, [0, 0.1, 0.2], "look like seconds: write `time 0.1 s`"),
        (6 * 10**9, "s", 10**9, [0, 0.1, 0.3], "look like minutes: write `time 0.1 min`"),
        (10**8, "ms", 10**6, [0, 130, 230], "stamps are read in ms"),
        (10**8, "ms", 10**6, [0, 0.13, 0.26], "stamps are read in ms"),
    ],
)
def test_stamps_of_another_unit_are_told_theirs(period, unit, size, stamps, said):
    with pytest.raises(DataError) as error:
        make_trace(TimeBase("period", unit, size, period), [X], {"x": [0] * len(stamps)}, stamps)
    (found,) = error.value.diagnostics
    assert found.code == "D811" and said in found.help
