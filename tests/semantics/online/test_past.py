"""Sliding windows and since, against their definitions."""

import random

import pytest

from stlspec.semantics.online.past import Greatest, Since, Sliding

INF = float("inf")
WINDOWS = [(0, 0), (0, 3), (2, 5), (1, None), (0, None), (4, 4)]


def samples(rng):
    time = 0
    for _ in range(60):
        yield time, rng.choice([-1.0, 0.5, 2.0, 3.0]), rng.choice([-2.0, 0.0, 1.0])
        time += rng.choice([1, 1, 2, 5])


def inside(low, high, age):
    return age >= low and (high is None or age <= high)


@pytest.mark.parametrize(("low", "high"), WINDOWS)
@pytest.mark.parametrize("seed", range(5))
def test_a_window_gives_its_least_and_its_greatest_value(low, high, seed):
    least, greatest, seen = Sliding(low, high), Greatest(low, high), []
    for time, value, _ in samples(random.Random(seed)):
        seen.append((time, value))
        window = [v for t, v in seen if inside(low, high, time - t)]
        assert least.step(time, value) == min(window, default=INF)
        assert greatest.step(time, value) == max(window, default=-INF)


@pytest.mark.parametrize(("low", "high"), WINDOWS)
@pytest.mark.parametrize("seed", range(5))
def test_since_holds_if_right_did_and_left_has_since(low, high, seed):
    since, seen = Since(low, high), []
    for time, left, right in samples(random.Random(seed)):
        seen.append((time, left, right))
        branches = [
            min([r, *(x for _, x, _ in seen[i + 1 :])])
            for i, (t, _, r) in enumerate(seen)
            if inside(low, high, time - t)
        ]
        assert since.step(time, left, right) == max(branches, default=-INF)
