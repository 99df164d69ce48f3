"""The comparison of imported specs is repeatable, and its values are those of the definition."""

import random

from tests.peers.imports import case, own_values


def test_the_same_seed_gives_the_same_cases():
    assert [case(random.Random(7)) for _ in range(3)] == [case(random.Random(7)) for _ in range(3)]


def test_values_are_those_of_every_sample():
    signals = {"a": [1.0, 3.0, -2.0], "b": [0.0, 0.0, 0.0], "c": [2.0, 2.0, 2.0]}
    assert own_values("out = always[0:1](a > b)", signals) == [1.0, -2.0, -2.0]
    assert own_values("out = rise(a > c)", signals) == [-1.0, 1.0, -4.0]
