"""Holes, units of stamps, and sampling again at a steady rate."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.compiler.bundle import TimeBase
from stlspec.errors import DataError, UsageError
from stlspec.readers.model import Recording
from stlspec.sampling import check_on_nan, in_unit_of, period_of, resampled, settled

SECONDS = TimeBase("stamps", "s", 10**9)
NAN = math.nan


def recording(time, **columns) -> Recording:
    return Recording(
        time=None if time is None else np.array(time), columns={k: np.array(v, float) for k, v in columns.items()}
    )


def again(given, period, on_nan="refuse", base=SECONDS, keys=None):
    found = resampled(given, keys or given.columns, base, period_of(period), on_nan, "log.csv")
    return found.time.tolist(), {name: values.tolist() for name, values in found.columns.items()}


def code(call, *arguments):
    with pytest.raises((DataError, UsageError)) as error:
        call(*arguments)
    (found,) = error.value.diagnostics
    return found.code


@pytest.mark.parametrize(
    ("text", "nanoseconds"),
    [
        ("100ms", 10**8),
        ("0.5 s", 5 * 10**8),
        (" 2 min ", 12 * 10**10),
        (".25us", 250),
        ("1h", 3600 * 10**9),
    ],
)
def test_a_period_is_a_number_with_a_unit(text, nanoseconds):
    assert period_of(text) == nanoseconds


@pytest.mark.parametrize("text", ["100", "0 s", "-1 s", "1 parsec", "", "0.5 ns", "1e3 s", "99999999999999 h", "nan s"])
def test_anything_else_is_no_period(text):
    assert code(period_of, text) == "D844"


def test_a_signal_has_the_value_of_its_newest_sample():
    given = recording([0.0, 0.25, 0.3, 1.0], x=[1, 2, 3, 4])
    assert again(given, "200ms") == ([0, 0.2, 0.4, 0.6, 0.8, 1.0], {"x": [1, 1, 3, 3, 3, 4]})


def test_every_sensor_holds_its_own_last_value_and_all_begin_together():
    given = recording([0.0, 0.1, 0.2, 0.3, 0.5], slow=[NAN, 7, NAN, NAN, 8], fast=[1, NAN, 2, 3, NAN])
    assert again(given, "0.2 s", "hold") == ([0.1, 0.3, 0.5], {"slow": [7, 7, 8], "fast": [1, 3, 3]})


def test_a_hole_is_refused_where_nothing_was_said_about_holes():
    given = recording([0.0, 0.05, 0.1], x=[1, NAN, 2])
    assert code(again, given, "100ms") == "D801", "though no new sample falls into the hole"
    assert again(given, "100ms", keys=["y"])[1] == {"x": [1, 2]}, "a column that no spec reads does no harm"


def test_a_signal_that_never_has_a_value_is_refused():
    assert code(again, recording([0.0, 0.1], x=[NAN, NAN]), "100ms", "hold") == "D801"


def test_whole_stamps_stay_whole():
    base = TimeBase("stamps", "ns", 1)
    begin = 1_700_000_000_000_000_001
    given = Recording(time=np.array([begin, begin + 5, begin + 9]), columns={"x": np.array([1.0, 2.0, 3.0])})
    assert again(given, "3ns", base=base) == ([begin, begin + 3, begin + 6, begin + 9], {"x": [1, 1, 2, 3]})


def test_without_stamps_the_period_of_the_spec_counts():
    base = TimeBase("period", "ms", 10**6, 100 * 10**6)
    assert again(recording(None, x=[1, 2, 3, 4]), "200ms", base=base) == ([0, 200], {"x": [1, 3]})
    assert code(again, recording(None, x=[1, 2]), "150ms", "refuse", base) == "D846"


def test_stamps_off_the_period_of_the_spec_are_brought_onto_it():
    base = TimeBase("period", "ms", 10**6, 100 * 10**6)
    assert again(recording([0.0, 130.0, 250.0], x=[1, 2, 3]), "100ms", base=base) == (
        [0, 100, 200],
        {"x": [1, 1, 2]},
    )


def test_a_spec_that_counts_samples_has_no_times_to_sample_at():
    assert code(again, recording([0.0, 1.0], x=[1, 2]), "1s", "refuse", TimeBase("step", "step", 1)) == "D846"


@pytest.mark.parametrize(
    ("time", "expected"), [([0.0, 2.0, 1.0], "D802"), ([0.0, math.inf, 2.0], "D812"), ([0.0, 1e8, 1.1e8], "D845")]
)
def test_stamps_that_cannot_be_used_are_refused(time, expected):
    assert code(again, recording(time, x=[1, 2, 3]), "1us") == expected


def test_stamps_are_needed_where_the_spec_has_no_period():
    assert code(again, recording(None, x=[1, 2]), "1s") == "D810"


@given(
    st.lists(st.tuples(st.integers(1, 40), st.one_of(st.none(), st.integers(-9, 9))), min_size=1, max_size=30),
    st.integers(1, 50),
)
def test_sampling_again_is_looking_up_the_newest_value(steps, period):
    """The definition: at each new time, the last value at or before it."""
    ticks = np.cumsum([step for step, _ in steps]).tolist()
    values = [NAN if value is None else float(value) for _, value in steps]
    known = [(t, v) for t, v in zip(ticks, values, strict=True) if v == v]
    if not known:
        return
    base = TimeBase("stamps", "ns", 1)
    given = Recording(time=np.array(ticks), columns={"x": np.array(values)})
    times, columns = again(given, f"{period}ns", "hold", base)
    assert times == list(range(known[0][0], ticks[-1] + 1, period))
    assert columns["x"] == [[v for t, v in known if t <= time][-1] for time in times]


def test_states_are_held_and_actions_are_gone():
    given = Recording(time=np.array([0.0, 1.0, 2.0]), columns={}, states=([0, 0], [0, 1], [1, 1]), actions=(2, 1))
    found = resampled(given, [], SECONDS, period_of("2s"), "refuse", "d")
    assert (found.states, found.actions, found.time.tolist()) == (([0, 0], [1, 1]), None, [0, 2])


@pytest.mark.parametrize(
    ("unit", "base", "expected"),
    [
        ("ns", SECONDS, [0.0, 0.5, 1.25]),
        ("ns", TimeBase("stamps", "ms", 10**6), [0, 500, 1250]),
        ("ns", TimeBase("stamps", "ns", 1), [0, 500_000_000, 1_250_000_000]),
        ("ns", TimeBase("step", "step", 1), [0, 500_000_000, 1_250_000_000]),
    ],
)
def test_stamps_with_a_unit_are_brought_to_the_unit_of_the_spec(unit, base, expected):
    given = Recording(time=np.array([0, 500_000_000, 1_250_000_000]), time_unit=unit)
    assert in_unit_of(given, base).time.tolist() == expected


def test_coarse_stamps_become_whole_fine_ones():
    given = Recording(time=np.array([1, 3]), time_unit="s")
    assert in_unit_of(given, TimeBase("stamps", "ms", 10**6)).time.tolist() == [1000, 3000]


def test_stamps_since_1970_keep_their_nanoseconds():
    begin = 1_700_000_000_000_000_000
    given = Recording(time=np.array([begin, begin + 1, begin + 1500]), time_unit="ns")
    assert in_unit_of(given, SECONDS).time.tolist() == [0, 1e-9, 1.5e-6]


def test_an_unknown_treatment_of_nan_is_refused():
    with pytest.raises(UsageError, match="hold"):
        check_on_nan("holds")


def test_holding_and_dropping_touch_the_columns_in_use_only():
    given = recording([0, 1, 2], x=[1, NAN, 3], y=[NAN, 5, 6])
    assert settled(given, ["x"], "hold", "d").columns["x"].tolist() == [1, 1, 3]
    assert settled(given, ["x"], "drop", "d").columns["y"].tolist()[1] == 6
    assert settled(given, ["x"], "refuse", "d") is given
