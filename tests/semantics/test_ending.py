"""The three readings of the end of a trace."""

import pytest

from stlspec import api
from stlspec.errors import DataError, UsageError
from stlspec.semantics.algebra import log_sum_exp
from stlspec.semantics.ending import evaluate_ending
from stlspec.semantics.evaluation import Verdict

BUNDLE = api.compile("signal x in [0, 10]\nhard low: always[0, 3] (x <= 8)\nsoft high: eventually[0, 3] (x >= 5)\n")
SHORT = {"x": [2.0, 6.0]}


def test_clip_reads_a_short_trace_as_complete():
    found = evaluate_ending(BUNDLE, SHORT)
    assert [(r.robustness, r.verdict) for r in found.values()] == [(2.0, "satisfied"), (1.0, "satisfied")]
    assert found["low"].low is None


def test_strict_refuses_it():
    with pytest.raises(DataError, match="D809"):
        evaluate_ending(BUNDLE, SHORT, end="strict")


def test_interval_encloses_every_way_it_can_go_on():
    found = evaluate_ending(BUNDLE, SHORT, end="interval")
    low, high = found["low"], found["high"]
    assert (low.low, low.robustness, low.high, low.verdict) == (-2.0, 2.0, 2.0, Verdict.UNDECIDED)
    assert (high.low, high.robustness, high.high, high.verdict) == (1.0, 1.0, 5.0, Verdict.SATISFIED)


def test_a_trace_that_reaches_the_horizon_leaves_nothing_open():
    found = evaluate_ending(BUNDLE, {"x": [2, 6, 1, 4]}, end="interval")
    assert [(r.low, r.high) for r in found.values()] == [(2.0, 2.0), (1.0, 1.0)]


@pytest.mark.parametrize(
    ("signals", "options"),
    [
        (SHORT, {"end": "open"}),
        ({"x": [[1, 2], [3, 4]]}, {"end": "interval"}),
        (SHORT, {"end": "interval", "algebra": log_sum_exp(0.1)}),
    ],
)
def test_what_cannot_be_read_is_refused(signals, options):
    with pytest.raises(UsageError, match="D880"):
        evaluate_ending(BUNDLE, signals, **options)
