"""Enclosures at open samples from those of the last call: the same as computed anew, whenever they are asked for."""

import random

import numpy as np
import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online import Monitor, make_monitor
from stlspec.semantics.online.opening import Opening
from stlspec.semantics.online.plan import make_plan
from stlspec.semantics.online.suffixes import make_suffixes
from tests.semantics.online.cases import bundle_of

RANGED = (Signal("x", low=-2.0, high=3.0), Signal("y", low=0.0, high=5.0))
FREE = (Signal("x"), Signal("y"))


def bundle(op, interval, signals=FREE):
    b = Builder()
    operands = [
        b.add("ge", [b.add("signal", value=name), b.add("const", value=0.0)])
        for name in "xy"[: 2 if op == "until" else 1]
    ]
    root = b.add(op, operands, interval=interval)
    return bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), signals)


@pytest.mark.parametrize("signals", [FREE, RANGED])
@pytest.mark.parametrize("ends", ["any", "horizon"])
@pytest.mark.parametrize("op", ["always", "eventually", "until"])
@pytest.mark.parametrize("interval", [(0, 0), (0, 5), (0, 90), (2, 7)])
def test_they_are_the_enclosures_that_are_computed_anew(op, interval, ends, signals):
    rng = random.Random(f"{op} {interval} {ends}")
    spec = bundle(op, interval, signals)
    monitor = make_monitor(spec, "every", ends)
    asked = rng.random()
    for n in range(1, 250):
        monitor.update({"x": rng.choice([0.0, rng.uniform(-2, 3)]), "y": rng.choice([0.0, rng.uniform(0, 5)])})
        if rng.random() < 0.02:
            monitor = rng.choice([monitor.copy, lambda m=monitor: Monitor.from_bytes(spec, m.to_bytes())])()
        if rng.random() > asked:
            continue
        found = monitor.pending()["r"]
        ((first, expected),) = Opening.shown_samples(monitor._opening(), n)
        assert found.samples.tolist() == list(range(first, n))
        assert found.times.tolist() == found.samples.tolist()
        for mine, anew in zip((found.low, found.high, found.current), expected, strict=True):
            assert mine.tobytes() == anew.tobytes(), (n, mine, anew)


def test_arrays_that_were_handed_out_stay_as_they_are():
    monitor = make_monitor(bundle("always", (0, 3)), "every")
    monitor.update({"x": 5.0})
    monitor.update({"x": 4.0})
    before = monitor.pending()["r"]
    monitor.update({"x": 1.0})
    assert monitor.pending()["r"].high.tolist() == [1.0, 1.0, 1.0]
    assert (before.samples.tolist(), before.high.tolist()) == ([0, 1], [4.0, 4.0])
    for array in (before.samples, before.times, before.low, before.high, before.current):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@pytest.mark.parametrize(("op", "interval"), [("always", (0, None)), ("until", (1, 4)), ("until", (0, None))])
def test_other_formulas_are_computed_anew(op, interval):
    spec = bundle(op, interval)
    plan = make_plan(spec)
    assert make_suffixes(plan, len(plan.nodes) - 1) is None
    monitor = make_monitor(spec, "every")
    for x in (1.0, 2.0):
        monitor.update({"x": x, "y": -1.0})
    assert np.array_equal(monitor.pending()["r"].samples, [0, 1])
