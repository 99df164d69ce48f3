"""RTAMT, discrete time: `evaluate` on lists for a trace, `update` after `pastify` for a stream."""

import itertools

import rtamt
from serving import Ready, rows_of, serve, traces_of


def parsed(text):
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in ("x", "y"):
        spec.declare_var(name, "float")
    spec.spec = text
    spec.parse()
    return spec


def trace(job):
    spec, signals = parsed(job["texts"][0]), rows_of(job)
    data = {"time": list(range(job["n"])), **signals}
    return Ready(lambda: spec.evaluate(data), job["n"], lambda: [spec.evaluate(data)[0][1]])


def batch(job):
    specs = [parsed(text) for text in job["texts"]]
    traces = [{"time": list(range(job["n"])), **signals} for signals in traces_of(job)]

    def call():
        for data in traces:
            for spec in specs:
                spec.evaluate(data)

    return Ready(call, len(traces) * job["n"], lambda: [spec.evaluate(traces[0])[0][1] for spec in specs])


def every(job):
    spec, signals = parsed(job["texts"][0]), rows_of(job)
    spec.pastify()
    samples = itertools.cycle([[("x", a), ("y", b)] for a, b in zip(signals["x"], signals["y"], strict=True)])
    clock = itertools.count()

    def call():
        spec.update(next(clock), next(samples))

    for _ in range(job["warm"]):
        call()
    return Ready(call)


serve("rtamt", {"trace": trace, "batch": batch, "every": every})
