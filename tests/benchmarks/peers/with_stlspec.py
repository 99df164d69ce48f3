"""stlspec, and the passes over memory that it is measured by."""

import itertools
import sys
import tracemalloc
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))

from serving import Ready, rows_of, serve

import stlspec
from stlspec.semantics import expressions, robustness, scans, windows
from stlspec.semantics.online.monitor import make_monitor
from tests.counting import counting


def bundle_of(job):
    names = sorted(name for name in ("x", "y") if any(f"{name} " in text for text in job["texts"]))
    lines = [f"signal {name}" for name in names]
    lines += [f"hard r{i}: {text}" for i, text in enumerate(job["texts"])]
    return stlspec.compile("\n".join(lines) + "\n"), names


def arrays_of(job):
    with np.load(job["data"]) as data:
        return {name: np.ascontiguousarray(data[name][: job["n"]]) for name in ("x", "y")}


def at_start(result):
    return [float(np.ravel(result[name].robustness)[0]) for name in result]


def trace(job):
    bundle, names = bundle_of(job)
    source = rows_of(job) if job.get("lists") else arrays_of(job)
    signals = {name: source[name] for name in names}
    if job.get("signal"):
        return Ready(lambda: [r.signal for r in bundle.evaluate(signals).values()], job["n"])
    return Ready(lambda: bundle.evaluate(signals), job["n"], lambda: at_start(bundle.evaluate(signals)))


def batch(job):
    bundle, names = bundle_of(job)
    with np.load(job["data"]) as data:
        signals = {name: data[name] for name in names}
    count = signals[names[0]].size
    return Ready(lambda: bundle.evaluate(signals), count, lambda: at_start(bundle.evaluate(signals)))


def minimum(job):
    a, b = np.random.default_rng(0).normal(size=(2, job["n"]))
    c = np.empty(job["n"])
    return Ready(lambda: np.minimum(a, b, out=c), job["n"])


def memory(job):
    """Not a timing: the peak of what one call allocates, in arrays of n doubles."""
    bundle, names = bundle_of(job)
    arrays = arrays_of(job)
    signals = {name: arrays[name] for name in names}

    def peak():
        tracemalloc.start()
        try:
            result = bundle.evaluate(signals)
            kept, highest = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        del result
        return [highest / (8 * job["n"]), kept / (8 * job["n"])]

    return Ready(lambda: None, 1.0, peak)


def operations(job):
    """Not a timing: how many operations of ufuncs on single elements one call makes, a sample."""
    bundle, names = bundle_of(job)
    arrays = arrays_of(job)

    def count():
        with counting(expressions, robustness, scans, windows) as counter:
            bundle.evaluate({name: arrays[name] for name in names})
        return [counter.operations / job["n"]]

    return Ready(lambda: None, 1.0, count)


def samples_of(job, names):
    rows = rows_of(job)
    return itertools.cycle([{name: rows[name][i] for name in names} for i in range(job["n"])])


def stream(job, reading, each):
    bundle, names = bundle_of(job)
    monitor, samples = make_monitor(bundle, reading), samples_of(job, names)
    update = monitor.update
    for _ in range(job["warm"]):
        update(next(samples))
    return Ready((lambda: (update(next(samples)), monitor.pending())) if each else (lambda: update(next(samples))))


def nothing(job):
    """What the loop itself costs: a call that takes a sample and does nothing."""
    _, names = bundle_of(job)
    samples = samples_of(job, names)
    return Ready(lambda: next(samples))


def compiling(job):
    return Ready(lambda: stlspec.compile(job["spec"]))


serve(
    "stlspec",
    {
        "trace": trace,
        "batch": batch,
        "minimum": minimum,
        "memory": memory,
        "operations": operations,
        "every": lambda job: stream(job, "every", each=False),
        "start": lambda job: stream(job, "start", each=False),
        "pending": lambda job: stream(job, "every", each=True),
        "nothing": nothing,
        "compile": compiling,
    },
    stlspec.__version__,
)
