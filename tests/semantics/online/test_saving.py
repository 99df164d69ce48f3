"""Saved state is plain JSON, and what is not well formed is refused."""

from array import array
from collections import deque
from typing import ClassVar

import pytest

from stlspec.semantics.online.saving import (
    Remembering,
    Unsound,
    column,
    line_of,
    number,
    numbers,
    optional,
    plain,
    row_of,
    rows,
    times,
    whole,
)

INF = float("inf")


def test_infinities_are_texts():
    assert plain([1.5, INF, (-INF, 2), deque([3]), array("d", [0.5])]) == [1.5, "inf", ["-inf", 2], [3], [0.5]]
    assert numbers(["inf", 1, -0.5]) == [INF, 1.0, -0.5]


@pytest.mark.parametrize(
    ("read", "value"),
    [
        (number, None),
        (number, True),
        (number, "nan"),
        (number, float("nan")),
        (number, 10**400),
        (whole, 1.0),
        (whole, True),
        (whole, 2**80),
        (numbers, {"a": 1}),
        (row_of(whole, number), [1]),
        (rows(whole, number), [[1, 2], [1, 3]]),
        (line_of(whole), [[2], [1]]),
        (times, [0, 0]),
        (column, [None]),
        (optional(number), "x"),
    ],
)
def test_values_of_another_kind_are_refused(read, value):
    with pytest.raises(Unsound):
        read(value)


def test_null_is_for_what_is_optional():
    assert optional(number)(None) is None


class Box(Remembering):
    """Two numbers, and queues of others in a box inside."""

    STATE: ClassVar = {"a": number, "queue": line_of(whole, number)}
    TIMED = ("queue",)

    def __init__(self, inner=None):
        self.a, self.queue, self.inner = 1.0, deque([(3, 2.0)]), inner

    def parts(self):
        return [self.inner] if self.inner else []


def test_an_object_comes_back_with_its_parts():
    box, copy = Box(Box()), Box(Box())
    box.inner.a = -INF
    box.queue.append((5, 0.5))
    copy.load(box.save())
    assert copy.save() == box.save()
    assert (copy.inner.a, copy.queue[1]) == (-INF, (5, 0.5))


@pytest.mark.parametrize("change", [{"a": None}, {"parts": []}, {"parts": 3}, {"b": 1}, {"queue": [[1]]}])
def test_a_state_of_another_shape_is_refused(change):
    box = Box(Box())
    with pytest.raises(Unsound):
        box.load(box.save() | change)


def test_times_after_the_newest_sample_are_refused():
    Box(Box()).check(4, 3)
    with pytest.raises(Unsound):
        Box(Box()).check(3, 2)
