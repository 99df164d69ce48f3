"""D89x: monitoring, that is samples that come one at a time."""

from stlspec.errors.model import Code

CODES: tuple[Code, ...] = (
    Code(
        "D890",
        "a line that is no sample",
        "error",
        message="line {line} is not a sample: {reason}",
        help="{help}",
        explanation="`stlspec monitor` reads one sample a line: CSV with a header, or one JSON object a line, "
        'such as {"x": 1, "time": 0.1}. The first character decides: "{" means JSON.',
        bad="x,y\n1,2\n1\n",
        good="x,y\n1,2\n1,3\n",
        kind="shown",
    ),
    Code(
        "D891",
        "time stamps on some samples only",
        "error",
        message="sample {sample} {problem}",
        help="give every sample a time stamp, or none of them",
        explanation="Without time stamps samples are one period apart; a stamp that comes later, or that is "
        "missing in between, leaves open when a sample was taken.",
        bad='{"x": 1, "time": 0}\n{"x": 2}\n',
        good='{"x": 1, "time": 0}\n{"x": 2, "time": 100}\n',
        kind="shown",
    ),
    Code(
        "D892",
        "a sample that was promised is left out",
        "error",
        message="sample {sample} at {time} comes {periods} periods after the one before",
        help="monitor with ends `any`, which promises nothing",
        explanation="With ends `horizon` the trace is promised to reach the horizon, sample by sample, and the "
        "enclosures rely on it.",
        bad="# time 100 ms, stlspec monitor spec.stl --ends horizon\ntime,x\n0,1\n300,1\n",
        good="# time 100 ms, stlspec monitor spec.stl --ends any\ntime,x\n0,1\n300,1\n",
        kind="shown",
    ),
    Code(
        "D893",
        "a saved monitor that cannot be restored",
        "error",
        message="the saved monitor cannot be restored: {problem}",
        help="start a new monitor, or restore with the spec, the reading and the version it was saved with",
        explanation="A saved monitor holds what it must remember of the samples so far, for one spec. It is "
        "data only; nothing in it is executed, and what is not well formed is refused.",
        bad="Monitor.from_bytes(other_bundle, saved)",
        good="Monitor.from_bytes(bundle, saved)",
        kind="shown",
    ),
    Code(
        "D894",
        "a value that is known at the end only",
        "warning",
        message="'{requirement}' looks ahead without end: with the reading `every` its values come when the "
        "input ends, and all samples are kept until then",
        help="bound its operators, or use the reading `start`",
        explanation="The value of an operator without end depends on every later sample.",
        bad="# hard a: eventually (x > 0); stlspec monitor spec.stl --reading every",
        good="# hard a: eventually[0, 5] (x > 0); stlspec monitor spec.stl --reading every",
        kind="shown",
    ),
    Code(
        "D895",
        "a state that does not exist",
        "error",
        message="sample {sample} is the state {state}, but states are numbered 0 to {last}",
        help="give the number of one of the states that the monitor was made for",
        explanation="A monitor made with `states` takes the number of a state in place of the values of signals: "
        "the row in the arrays that it was made with.",
        bad='bundle.monitor(states={"x": [1, 2]}).update(2)',
        good='bundle.monitor(states={"x": [1, 2]}).update(1)',
        kind="shown",
    ),
)
