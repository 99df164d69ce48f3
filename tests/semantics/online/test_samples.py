"""One sample at the door: numbers, Booleans, time stamps. How a monitor refuses is in test_monitor.py."""

from decimal import Decimal

import numpy as np
import pytest

from stlspec import api
from stlspec.errors import DataError, UsageError
from stlspec.semantics.online import Monitor, make_monitor
from stlspec.semantics.online.samples import Clock, as_boolean, as_real, missing
from tests.semantics.online.cases import PERIOD, STAMPS, STEP


@pytest.mark.parametrize("value", [1, True, np.float32(1), np.int64(1), Decimal(1), np.array(1.0)])
def test_whatever_is_a_number_is_taken(value):
    assert as_real("x", value, 0) == 1.0


@pytest.mark.parametrize("value", ["1", b"1", 1j, None, [1.0], {}, 10**400])
def test_whatever_is_none_is_refused(value):
    with pytest.raises(DataError, match="D806"):
        as_real("x", value, 0)


@pytest.mark.parametrize(("value", "expected"), [(1, True), (0.0, False), (np.True_, True), (False, False)])
def test_booleans_may_be_numbers(value, expected):
    assert as_boolean("b", value, 0, "0") is expected


@pytest.mark.parametrize(("value", "code"), [(2, "D806"), ("true", "D806"), (None, "D806"), (float("nan"), "D801")])
def test_other_values_are_no_booleans(value, code):
    with pytest.raises(DataError, match=code):
        as_boolean("b", value, 3, "3")


def test_a_missing_signal_is_named_with_a_close_one():
    with pytest.raises(DataError, match="did you mean 'd_obs'"):
        missing({"d_obs": 1}, ["d_ops"])
    with pytest.raises(DataError, match="the sample has no signals"):
        missing({}, ["x"])


def run(clock, *times):
    ticks = []
    for time in times:
        ticks.append(clock.read(time))
        clock.take(ticks[-1], time)
    return ticks


def test_time_is_counted_from_the_first_sample():
    assert run(Clock(STEP, False), None, None) == [0, 1]
    assert run(Clock(STEP, False), 7.0, 9.5) == [0, 1]
    assert run(Clock(PERIOD, False), None, None) == [0, 20]
    assert run(Clock(PERIOD, False), 5.0, 7.0, 11.0) == [0, 20, 60]
    assert run(Clock(STAMPS, False), 5.0, 5.3, 9.04) == [0, 3, 40]


def test_reading_a_time_does_not_count_it():
    clock = Clock(STAMPS, False)
    assert (clock.read(3.0), clock.read(4.0), clock.n) == (0, 0, 0)


def test_the_latest_time_is_shown_as_given():
    clock = Clock(STAMPS, False)
    run(clock, 5.0, 5.3)
    assert (clock.begin, clock.latest) == (5.0, 5.3)
    clock = Clock(PERIOD, False)
    run(clock, None, None)
    assert (clock.begin, clock.latest) == (0.0, 2.0)


def test_whole_stamps_stay_exact_where_floats_would_not():
    bundle = api.compile("time ns\nsignal x\nhard c: eventually[30 ms, 30 ms] (x >= 0)\n")
    monitor = make_monitor(bundle)
    for k, x in enumerate((-1.0, -1.0, -1.0, 1.0)):
        monitor.update({"x": x}, 1_700_000_000_123_456_789 + k * 10_000_000)
        monitor = Monitor.from_bytes(bundle, monitor.to_bytes())
    assert monitor.finish()["c"].robustness == 1.0
    with pytest.raises(DataError, match="D802"):
        monitor.update({"x": 1.0}, 1_700_000_000_153_456_789)


def test_a_bound_as_32_bits_have_it_is_the_bound_online_and_offline():
    bundle = api.compile("signal p in [-1.2, 0.07]\nhard r: always (p > -2)\n")
    edge = float(np.float32(-1.2))
    assert edge < -1.2
    assert bundle.monitor().update({"p": edge})["r"].current == -1.2 - -2
    assert bundle.evaluate({"p": [edge, 0.0]})["r"].robustness == -1.2 - -2
    for refused in (np.nextafter(np.float32(-1.2), np.float32(-2)), -1.3):
        with pytest.raises(DataError, match="D807"):
            bundle.monitor().update({"p": refused})


@pytest.mark.parametrize("base", ["step", "100 ms", "ms"])
@pytest.mark.parametrize("reading", ["start", "every"])
def test_a_sample_holds_its_stamp_under_the_key_time_as_in_files(base, reading):
    bundle = api.compile(f"time {base}\nsignal x\nhard a: eventually[0, {3 if base == 'step' else '300 ms'}] (x > 5)")
    apart, within = make_monitor(bundle, reading), make_monitor(bundle, reading)
    for x, t in zip([0, 0, 6, 0], [0, 100, 900, 1000], strict=True):
        assert within.update({"x": x, "time": t}) == apart.update({"x": x}, time=t)
        assert within.time == apart.time
        within = within.copy()
    assert within.finish() == apart.finish()


@pytest.mark.parametrize("base", ["step", "100 ms", "ms"])
def test_a_stamp_that_is_missing_or_given_twice_is_refused(base):
    monitor = make_monitor(api.compile(f"time {base}\nsignal x\nhard a: always (x > 5)"))
    with pytest.raises(UsageError, match="given twice"):
        monitor.update({"x": 1, "time": 0}, time=0)
    monitor.update({"x": 1, "time": 0})
    with pytest.raises(DataError, match="D810" if base == "ms" else "D891"):
        monitor.update({"x": 1})
    with pytest.raises(DataError, match="D802"):
        monitor.update({"x": 1, "time": 0})
    assert monitor.n_samples == 1


@pytest.mark.parametrize("base", ["step", "100 ms"])
def test_a_stamp_after_a_sample_without_one_is_refused(base):
    monitor = make_monitor(api.compile(f"time {base}\nsignal x\nhard a: always (x > 5)"))
    monitor.update({"x": 1})
    with pytest.raises(DataError, match="D891"):
        monitor.update({"x": 1, "time": 100})
