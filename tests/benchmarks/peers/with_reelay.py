"""Reelay, discrete time: one `update` a sample; past operators only, so traces come backwards."""

import itertools

import reelay
from serving import Ready, rows_of, serve


def made(text):
    return reelay.discrete_timed_monitor(pattern=text, semantics="robustness", condense=False)


def samples_of(job):
    signals = rows_of(job)
    return [{"x": a, "y": b} for a, b in zip(signals["x"], signals["y"], strict=True)]


def trace(job):
    text, samples = job["texts"][0], samples_of(job)[::-1]

    def call():
        monitor = made(text)
        for sample in samples:
            last = monitor.update(sample)
        return last

    return Ready(call, job["n"], lambda: [call()["value"]])


def every(job):
    monitor, samples = made(job["texts"][0]), itertools.cycle(samples_of(job))

    def call():
        monitor.update(next(samples))

    for _ in range(job["warm"]):
        call()
    return Ready(call)


serve("reelay", {"trace": trace, "every": every})
