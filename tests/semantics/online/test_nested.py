"""Queues of clamps, against the clamps one by one."""

import random

import pytest

from stlspec.semantics.online.nested import FOREVER, Clamps
from stlspec.semantics.online.saving import Unsound

INF = float("inf")


def clamp(low, high, x):
    return max(low, min(high, x))


def test_a_queue_gives_the_least_of_its_clamps_and_the_oldest_back():
    rng = random.Random(1)
    for _ in range(200):
        queue, model = Clamps(forget=True), []
        for time in range(40):
            low, high = sorted(rng.random() for _ in range(2))
            queue.push(time, low, high)
            model.append((time, lambda x, a=low, b=high: clamp(a, b, x)))
            for _ in range(rng.choice([0, 1, 1, 2])):
                a, b = sorted(rng.random() for _ in range(2))
                queue.change(a, b)
                model = [(t, lambda x, f=f, a=a, b=b: f(clamp(a, b, x))) for t, f in model]
            while model and rng.random() < 0.5:
                t, f = model.pop(0)
                assert queue.pop() == (t, f(-INF), f(INF))
            assert queue.front == (model[0][0] if model else FOREVER)
            for x in (-INF, 0.3, INF):
                assert queue.least(x) == min((f(x) for _, f in model), default=INF)


def test_a_queue_that_gives_nothing_back_keeps_no_samples():
    queue = Clamps(forget=False)
    for time in range(1000):
        queue.push(time, 0.0, 1.0 + time)
        queue.change(0.5, 0.5 + time)
    assert (queue.newer, queue.older, queue.front) == ([], [], FOREVER)
    assert queue.least(-INF) == 0.5


@pytest.mark.parametrize("change", [{"newer": [[-1, 0.0, 1.0]]}, {"front": 3}, {"newer": [[5, 0, 1], [4, 0, 1]]}])
def test_a_queue_out_of_order_is_refused(change):
    queue = Clamps(forget=True)
    with pytest.raises(Unsound):
        queue.load(queue.save() | change)
        queue.check(9, 9)
