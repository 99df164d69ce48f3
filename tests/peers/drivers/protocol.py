"""What all drivers share: cases come as JSON lines on stdin, values go as JSON lines to stdout.

The first line out is {"version": ...}; then for each case {"values": [[time, value], ...]} or {"error": ...},
flushed one by one, so that a tool that kills the process betrays at which case. Runs in the tool's own
environment and knows nothing of stlspec.
"""

import json
import os
import sys
from importlib.metadata import version


def serve(package, evaluate):
    """Answer every case with `evaluate(formula, signals, times)`, a list of (time, value)."""
    # What the tool itself prints must not end up between the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    print(json.dumps({"version": version(package)}), file=answers, flush=True)
    for line in sys.stdin:
        case = json.loads(line)
        try:
            values = evaluate(case["formula"], case["signals"], case["times"])
            answer = {"values": [[float(t), float(v)] for t, v in values]}
        except Exception as error:
            answer = {"error": f"{type(error).__name__}: {error}"[:200]}
        print(json.dumps(answer), file=answers, flush=True)
