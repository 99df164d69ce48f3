"""Answers with Reelay, discrete time, robustness, one value a sample."""

import sys

import reelay
from protocol import serve

INFINITY = sys.float_info.max
"""What Reelay begins unbounded operators and `pre` with, where infinity is meant."""


def evaluate(formula, signals, times):
    monitor = reelay.discrete_timed_monitor(pattern=formula, semantics="robustness", condense=False)
    rows = zip(*signals.values(), strict=True)
    values = [monitor.update(dict(zip(signals, row, strict=True)))["value"] for row in rows]
    return [(t, v if abs(v) < INFINITY else v * 2) for t, v in zip(times, values, strict=True)]


serve("reelay", evaluate)
