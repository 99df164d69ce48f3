"""Answers with pybanquo."""

from banquo import Trace, stl
from protocol import serve


def evaluate(formula, signals, times):
    states = [dict(zip(signals, row, strict=True)) for row in zip(*signals.values(), strict=True)]
    return stl.parse(formula).evaluate(Trace.from_timed_states([float(t) for t in times], states))


serve("pybanquo", evaluate)
