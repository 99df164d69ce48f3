"""A stream says of a recording, however it is cut, just what an evaluation of the whole says."""

import random

import pytest

from stlspec import api
from stlspec.errors import DataError, UsageError
from stlspec.semantics.streaming import Stream, refusals, stream
from tests.semantics.streaming.cases import compare


@pytest.mark.parametrize("seed", range(4))
def test_random_recordings_cut_anywhere_give_what_the_whole_gives(seed):
    rng = random.Random(seed)
    kinds = {compare(rng) for _ in range(250)}
    assert kinds == {"same", "vacuous", "no value", "refused"}


def bundle_of(formula, head=""):
    return api.compile(f"{head}signal x\nsignal y\nhard r: {formula}\nhard other: always (x > -9)\n")


@pytest.mark.parametrize(
    ("formula", "reason"),
    [
        ("always (x > 0 implies eventually (y > 0))", "`eventually` without end under `always`"),
        ("eventually always (x > 0)", "`always` without end under `eventually`"),
        ("x > 0 or next always (x > 0)", "`always` without end under `next`"),
        ("always ((x > 0) since (y > 0))", "`since` without end under `always`"),
        ("always[0, 5] ((x > 0) until (y > 0))", "`until` without end under `always`"),
        ("(x > 0) until (eventually (y > 0))", "`eventually` without end under `until`"),
    ],
)
def test_what_needs_all_samples_is_refused_before_the_first(formula, reason):
    (found,) = refusals(bundle_of(formula))
    assert found.code == "D896" and "'r'" in found.message and reason in found.message
    with pytest.raises(UsageError, match="D896"):
        Stream(bundle_of(formula))


@pytest.mark.parametrize(
    "formula",
    [
        "always (x > 0 implies eventually[0, 5] (y > 0))",
        "always (x > 0 implies once (y > 0))",
        "eventually[3, 9] historically (x > 0)",
        "(x > 0) since (y > 0)",
        "((x > 0) until (y > 0)) and not (eventually (y > 3))",
    ],
)
def test_what_fits_is_taken(formula):
    assert refusals(bundle_of(formula)) == ()


def test_memory_is_bounded_by_what_the_spec_looks_at():
    following = Stream(
        bundle_of("always (x > 0 implies eventually[0, 20] (y > 0)) and historically (x > -1)"), block=50
    )
    for _ in range(100):
        following.take({"x": [1.0] * 10, "y": [2.0] * 10}, None, 10)
        assert following._pieces.kept <= 50 + 22 + 10
    assert following.finish()["r"].robustness == 2.0


def test_more_than_fits_is_refused_in_its_course(monkeypatch):
    monkeypatch.setattr(stream, "NUMBERS_AT_MOST", 1000)
    following = Stream(bundle_of("always (x > 0 implies eventually[0, 100000] (y > 0))"), block=50)
    with pytest.raises(DataError, match="D897"):
        for _ in range(100):
            following.take({"x": [1.0] * 10, "y": [2.0] * 10}, None, 10)


def test_strict_asks_for_the_horizon():
    following = Stream(bundle_of("always[0, 5] (x > 0)"))
    following.take({"x": [1.0] * 5, "y": [1.0] * 5}, None, 5)
    with pytest.raises(DataError, match="D809"):
        following.finish("strict")
