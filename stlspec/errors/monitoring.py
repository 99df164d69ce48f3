"""D89x: samples that come one at a time, or a piece at a time: monitoring and streams."""

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
    Code(
        "D896",
        "a requirement that a stream cannot be scored against",
        "error",
        message="'{requirement}' needs every sample at once: {reason}",
        help="give the operator an end, or score a file, which is read whole; `stlspec monitor` follows it without "
        "naming the deciding sample",
        explanation="`stlspec score SPEC -` keeps only the samples that operators with an end look at. The value of an "
        "operator without end that stands under another one may be decided by any sample to come, at every sample "
        "anew; what would have to be kept grows with the recording. An outermost `always`, `eventually` or `until` "
        "without end is no such case, nor is `once` or `historically` anywhere.",
        bad="# always (a implies eventually b); stlspec score spec.stl -",
        good="# always (a implies eventually[0, 50] b); stlspec score spec.stl -",
        kind="shown",
    ),
    Code(
        "D897",
        "a stream of which too much must be kept",
        "error",
        message="the requirements look at {kept} samples at once, in {nodes} expressions and sub-formulas: more than a "
        "stream is kept of",
        help="shorten the bounds of the nested operators, or score a file, which is read whole",
        explanation="`stlspec score SPEC -` keeps the samples between the farthest look back and the farthest look "
        "ahead of the nested operators, so that memory is bounded by the spec. With time stamps their number depends "
        "on the data; where it does not fit, the stream is refused.",
        bad="# always (a implies eventually[0, 1000 h] b), a sample each ms; stlspec score spec.stl -",
        good="# always (a implies eventually[0, 1 min] b), a sample each ms; stlspec score spec.stl -",
        kind="shown",
    ),
    Code(
        "D898",
        "several recordings in one stream",
        "error",
        message="episode '{other}' comes after episode '{first}', but a stream is one recording",
        help="score a file, which may hold several, or send each recording on its own",
        explanation="`stlspec score SPEC -` follows one recording from its first sample to its last.",
        bad="episode,x\na,1\nb,1\n",
        good="episode,x\na,1\na,1\n",
        kind="shown",
    ),
)
