"""The loop of a contestant: jobs come as JSON lines on stdin, timings go as JSON lines to stdout.

A job names a kind; the contestant's `kinds` makes of it a `Ready`, a call that does the work once. Preparing
(parsing, bringing data into the tool's own form) is not timed. Uses the standard library only.
"""

import gc
import json
import math
import os
import sys
from dataclasses import dataclass
from importlib.metadata import version

from measuring import CoarseClockError, check_clock, quantiles, seconds_a_call


@dataclass
class Ready:
    """A prepared job: `call` does the work once, worth `per_call` units; `values` gives what came out."""

    call: object
    per_call: float = 1.0
    values: object = None


def serve(package, kinds, release=None):
    """Answer requests until stdin ends; release: of the tool, if it is not installed as a package."""
    # What the tool itself prints must not end up between the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)

    def answer(document):
        print(json.dumps(document), file=answers, flush=True)

    try:
        answer({"version": release or version(package), "step": check_clock()})
    except CoarseClockError as error:
        answer({"error": str(error)})
        return
    ready = None
    for line in sys.stdin:
        request = json.loads(line)
        try:
            if "prepare" in request:
                ready = None
                ready = kinds[request["prepare"]["kind"]](request["prepare"])
                # What was prepared stays out of garbage collections: they would be charged to the calls.
                gc.collect()
                gc.freeze()
                answer({"ready": True})
            elif "quantiles" in request:
                answer({"seconds": quantiles(ready.call, request["count"], request["quantiles"])})
            elif "values" in request:
                found = ready.values() if ready.values else []
                answer({"values": [float(v) if math.isfinite(v) else str(float(v)) for v in found]})
            else:
                answer({"seconds": seconds_a_call(ready.call, request["measure"]) / ready.per_call})
        except Exception as error:
            answer({"error": f"{type(error).__name__}: {error}"[:200]})


def rows_of(job):
    """Load the data of a job as Python lists: {signal: [values]}, cut to the job's samples."""
    import numpy as np

    with np.load(job["data"]) as data:
        return {name: data[name][: job["n"]].tolist() for name in ("x", "y")}


def traces_of(job):
    """Load a batch as a list of traces, each {signal: [values]}."""
    import numpy as np

    with np.load(job["data"]) as data:
        x, y = (data[name][: job["traces"]].tolist() for name in ("x", "y"))
    return [{"x": a, "y": b} for a, b in zip(x, y, strict=True)]
