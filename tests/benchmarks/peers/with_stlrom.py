"""STLRom: one value a call. `trace` and `batch` have the samples loaded; `loading` adds them in the call.

The signals are piecewise constant (its default interpolates).
"""

import stlrom
from serving import Ready, rows_of, serve, traces_of


def driver(texts):
    made = stlrom.STLDriver()
    names = [f"phi{i}" for i in range(len(texts))]
    lines = ["signal x, y", *(f"{name} := {text}" for name, text in zip(names, texts, strict=True))]
    if not made.parse_string("\n".join(lines) + "\n"):
        raise ValueError("STLRom does not parse this")
    made.set_interpol("PREVIOUS")
    return made, names


def samples_of(signals):
    return [[float(i), a, b] for i, (a, b) in enumerate(zip(signals["x"], signals["y"], strict=True))]


def load(made, samples):
    for sample in samples:
        made.add_sample(sample)


def trace(job):
    made, (name,) = driver(job["texts"])
    load(made, samples_of(rows_of(job)))

    def call():
        # A monitor remembers its value, so each call takes a fresh one.
        return made.get_monitor(name).eval_rob()

    return Ready(call, job["n"], lambda: [call()])


def values(made, names):
    return [made.get_monitor(name).eval_rob() for name in names]


def batch(job):
    loaded = []
    for signals in traces_of(job):
        made, names = driver(job["texts"])
        load(made, samples_of(signals))
        loaded.append((made, names))

    def call():
        for made, names in loaded:
            values(made, names)

    return Ready(call, len(loaded) * job["n"], lambda: values(*loaded[0]))


def loading(job):
    traces = [samples_of(signals) for signals in traces_of(job)]
    empty, names = driver(job["texts"])

    def evaluated(samples):
        made = empty.copy()
        load(made, samples)
        return values(made, names)

    def call():
        for samples in traces:
            evaluated(samples)

    return Ready(call, len(traces) * job["n"], lambda: evaluated(traces[0]))


serve("stlrom", {"trace": trace, "batch": batch, "loading": loading})
