"""mstlo: `update_batch` on lists of (value, time) for a trace, `update` for a stream.

A call takes plain lists in and the verdicts out, as a user has to; `ready` has the pairs made before and leaves
the verdicts where they are.
"""

import itertools

import mstlo_python
from serving import Ready, rows_of, serve, traces_of


def monitor(job, text, semantics="DelayedQuantitative"):
    made = mstlo_python.Monitor(mstlo_python.parse_formula(text), semantics=semantics)
    return made, sorted(made.get_signal_identifiers())


def steps(signals, names):
    return {name: [(v, float(i)) for i, v in enumerate(signals[name])] for name in names}


def trace(job):
    made, names = monitor(job, job["texts"][0])
    signals = rows_of(job)
    batch = steps(signals, names)

    def ready():
        made.reset()
        return made.update_batch(batch)

    def whole():
        made.reset()
        return made.update_batch(steps(signals, names)).verdicts()

    return Ready(ready if job.get("ready") else whole, job["n"], lambda: [whole()[0][1]])


def batch(job):
    made = [monitor(job, text) for text in job["texts"]]
    traces = traces_of(job)

    def evaluated(signals):
        found = []
        for m, names in made:
            m.reset()
            found.append(m.update_batch(steps(signals, names)).verdicts())
        return found

    def call():
        for signals in traces:
            evaluated(signals)

    return Ready(call, len(traces) * job["n"], lambda: [verdicts[0][1] for verdicts in evaluated(traces[0])])


def stream(job, semantics):
    made, names = monitor(job, job["texts"][0], semantics)
    columns = rows_of(job)
    samples = itertools.cycle([[(name, columns[name][i]) for name in names] for i in range(job["n"])])
    clock = itertools.count()

    def whole():
        t = float(next(clock))
        for name, value in next(samples):
            output = made.update(name, value, t)
        # All signals of a sample are in with the last one, so only its output has verdicts.
        return output.verdicts()

    def ready():
        t = float(next(clock))
        for name, value in next(samples):
            made.update(name, value, t)

    call = ready if job.get("ready") else whole
    for _ in range(job["warm"]):
        call()
    return Ready(call)


serve(
    "mstlo-python",
    {
        "trace": trace,
        "batch": batch,
        "every": lambda job: stream(job, "DelayedQuantitative"),
        "pending": lambda job: stream(job, "Rosi"),
    },
)
