"""Clocks that cannot time anything are refused, and the others are used for long enough."""

import resource

import pytest

from tests.benchmarks.peers.measuring import (
    CoarseClockError,
    check_clock,
    process_step,
    quantiles,
    seconds_a_call,
)

UNLIMITED = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)


class Clock:
    """A clock that moves by itself at each look, in whole ticks."""

    def __init__(self, a_look, tick=0.0):
        self.time, self.a_look, self.tick = 0.0, a_look, tick

    def __call__(self):
        self.time += self.a_look
        return self.time if not self.tick else self.time // self.tick * self.tick


def test_a_cpu_limit_is_refused_with_the_way_out():
    with pytest.raises(CoarseClockError, match="4 ms: run without `ulimit -t`"):
        check_clock(Clock(1e-6), lambda _: (600, 600))


def test_a_clock_that_ticks_every_four_milliseconds_is_refused():
    with pytest.raises(CoarseClockError, match="steps of 4 ms"):
        check_clock(Clock(1e-4, tick=4e-3), lambda _: UNLIMITED)


def test_a_fine_clock_is_accepted_with_its_step():
    assert check_clock(Clock(1e-6), lambda _: UNLIMITED) == pytest.approx(1e-6)


def test_a_clock_that_stands_still_has_no_step():
    assert process_step(lambda: 1.0, longest=0.01) == float("inf")


def test_calls_are_repeated_until_they_take_long_enough_together():
    clock, calls = Clock(0.0), []

    def call():
        calls.append(1)
        clock.time += 0.002

    assert seconds_a_call(call, 0.05, clock) == pytest.approx(0.002)
    assert 25 <= len(calls) <= 30


def test_at_least_one_call_is_made():
    calls = []
    seconds_a_call(lambda: calls.append(1), 0.0, Clock(1e-6))
    assert calls == [1]


def test_quantiles_are_of_single_calls():
    ticks = Clock(0)
    slow = iter([100] * 99 + [5000])

    def call():
        ticks.time += next(slow)

    assert quantiles(call, 100, [0.5, 0.99], ticks) == [pytest.approx(100e-9), pytest.approx(5000e-9)]
