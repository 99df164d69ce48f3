"""Answers with mstlo: exact values, each as soon as the horizon has arrived."""

import mstlo_python
from protocol import serve


def evaluate(formula, signals, times):
    monitor = mstlo_python.Monitor(mstlo_python.parse_formula(formula), semantics="DelayedQuantitative")
    used = monitor.get_signal_identifiers()
    batch = {
        name: [(v, float(t)) for v, t in zip(values, times, strict=True)]
        for name, values in signals.items()
        if name in used
    }
    return monitor.update_batch(batch).verdicts()


serve("mstlo-python", evaluate)
