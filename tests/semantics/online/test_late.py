"""Values that come late: each operator against its definition, with operands of different delays."""

import random

import pytest

from stlspec.semantics.online.late import LateBoolean, LateNext, LateUntil, LateWindow

INF = float("inf")


def times_of(rng, n=40):
    times = [0]
    for _ in range(n - 1):
        times.append(times[-1] + rng.choice([1, 1, 2, 6]))
    return times


def fed(operator, times, *columns):
    """Feed an operator sample by sample; return what it gave, with the number of samples then seen."""
    given, seen = [], [0]
    operator.sinks.append(lambda time, value, upto: given.append((time, value, seen[0], upto)))
    inlets = operator.inlets()
    for i, time in enumerate(times):
        seen[0] = i + 1
        for inlet, column in zip(inlets, columns, strict=True):
            inlet(time, column[i], time)
    return given


@pytest.mark.parametrize(("low", "high"), [(0, 0), (0, 4), (3, 3), (2, 9)])
@pytest.mark.parametrize("flip", [False, True])
def test_a_window_is_known_when_it_has_passed(low, high, flip):
    rng = random.Random(low + high)
    for _ in range(20):
        times = times_of(rng)
        values = [rng.choice([-1.0, 0.5, 2.0]) for _ in times]
        given = fed(LateWindow(low, high, flip), times, values)
        for i, (time, value, seen, upto) in enumerate(given):
            window = [v for t, v in zip(times, values, strict=True) if low <= t - times[i] <= high]
            expected = max(window, default=-INF) if flip else min(window, default=INF)
            assert (time, value) == (times[i], expected)
            assert times[seen - 1] >= time + high
            assert seen == 1 or times[seen - 2] < time + high
            assert time <= upto < (times[i + 1] if i + 1 < len(times) else INF)
        assert len(given) == sum(t + high <= times[-1] for t in times)


@pytest.mark.parametrize(("low", "high"), [(0, 0), (0, 4), (3, 3), (2, 9)])
def test_until_is_known_when_its_window_has_passed(low, high):
    rng = random.Random(low + high)
    for _ in range(20):
        times = times_of(rng)
        left, right = ([rng.choice([-1.0, 0.5, 2.0, 3.0]) for _ in times] for _ in range(2))
        given = fed(LateUntil(low, high), times, left, right)
        for i, (time, value, _, _) in enumerate(given):
            branches = [min([right[j], *left[i:j]]) for j in range(i, len(times)) if low <= times[j] - times[i] <= high]
            assert (time, value) == (times[i], max(branches, default=-INF))
        assert len(given) == sum(t + high <= times[-1] for t in times)


def test_next_is_known_a_sample_later():
    assert [x[:3] for x in fed(LateNext(), [0, 3, 4], [1.0, 2.0, 3.0])] == [(0, 2.0, 2), (3, 3.0, 3)]


def test_operands_of_different_delay_are_aligned():
    rng = random.Random(4)
    times = times_of(rng)
    values = [rng.random() for _ in times]
    both, window = LateBoolean(2, max), LateWindow(0, 5, False)
    given = []
    both.sinks.append(lambda time, value, upto: given.append((time, value, upto)))
    late, prompt = both.inlets()
    window.sinks.append(late)
    for time, value in zip(times, values, strict=True):
        window.take(time, value, time)
        prompt(time, -value, time)
    for i, (time, value, upto) in enumerate(given):
        least = min(v for t, v in zip(times, values, strict=True) if 0 <= t - time <= 5)
        assert (time, value) == (times[i], max(least, -values[i]))
        assert time <= upto < times[i + 1]
    assert len(given) == sum(t + 5 <= times[-1] for t in times)
