"""D80x to D83x: traces and demonstrations that cannot be used."""

from stlspec.errors.model import Code

CODES: tuple[Code, ...] = (
    Code(
        "D801",
        "a sample is not a number",
        "error",
        message="signal '{signal}' is NaN at sample {sample} (time {time})",
        help="repair the recording, or choose what to do: --on-nan hold, --on-nan drop",
        explanation="Robustness of a sample that is not a number means nothing, and a NaN that is let "
        "through hides whatever comes after it. The file is refused with the first such sample.",
        bad="time,x\n0,1\n1,nan\n",
        good="time,x\n0,1\n1,2\n",
        kind="data",
    ),
    Code(
        "D802",
        "time does not increase",
        "error",
        message="time does not increase at sample {sample}: {time} comes after {previous}",
        help="sort the rows by time, and keep one row for each time; rows of several recordings need an "
        "'episode' column",
        explanation="Windows are sets of samples between two times, so time stamps must strictly increase. "
        "Stamps less than a nanosecond apart count as equal.",
        bad="time,x\n0,1\n2,1\n1,1\n",
        good="time,x\n0,1\n1,1\n2,1\n",
        kind="data",
    ),
    Code(
        "D803",
        "no samples",
        "error",
        message="there are no samples{where}",
        help="a trace needs at least one sample",
        explanation="The value of a requirement is its value at the first sample, so there must be one.",
        bad="time,x\n",
        good="time,x\n0,1\n",
        kind="data",
    ),
    Code(
        "D804",
        "a signal is missing",
        "error",
        message="signal '{signal}' is not in the data",
        help="{help}",
        explanation="Every signal that a requirement uses must be a column of the data, or be computed from "
        'states by an environment. A signal with `from "name"` is read from the column of that name.',
        bad="time,speed\n0,1\n",
        good="time,x\n0,1\n",
        kind="data",
    ),
    Code(
        "D805",
        "signals of unequal length",
        "error",
        message="'{signal}' has {length} samples, but '{other}' has {expected}",
        help="all signals of one trace have a value at every sample",
        explanation="A trace is a table: one row a sample, one column a signal, no holes.",
        bad='{"signals": {"x": [1, 2, 3], "y": [1, 2]}}',
        good='{"signals": {"x": [1, 2, 3], "y": [1, 2, 3]}}',
        kind="shown",
    ),
    Code(
        "D806",
        "a value that is no number or Boolean",
        "error",
        message="signal '{signal}' has {value} at sample {sample}, which is not a {type} value",
        help="{help}",
        explanation="A real signal takes numbers, inf and -inf; a bool signal takes true, false, 1 and 0.",
        bad="time,x\n0,fast\n",
        good="time,x\n0,1\n",
        kind="data",
    ),
    Code(
        "D807",
        "a sample outside the declared range",
        "error",
        message="signal '{signal}' is {value} at sample {sample} (time {time}), outside its range "
        "[{low}, {high}]",
        help="widen the range in the declaration of '{signal}', or repair the data",
        explanation="A declared range is a promise: the online enclosures and the lints rely on it, so a "
        "sample outside it is refused everywhere.",
        bad="# signal x in [0, 1]\ntime,x\n0,3\n",
        good="# signal x in [0, 1]\ntime,x\n0,0.5\n",
        kind="shown",
    ),
    Code(
        "D808",
        "an expression without a value",
        "error",
        message="{expression} is not a number at sample {sample}: {operands}",
        help="guard the expression, or keep its operands in the range where it is defined",
        explanation="An expression such as sqrt(x) with x below 0, or inf - inf, has no value; a requirement "
        "over it would have none either.",
        bad="# hard ok: sqrt(x) < 2\ntime,x\n0,-1\n",
        good="# hard ok: sqrt(x) < 2\ntime,x\n0,1\n",
        kind="shown",
    ),
    Code(
        "D809",
        "a trace shorter than the horizon",
        "error",
        message="the trace ends before the horizon of '{requirement}': it lasts {length}, the formula looks "
        "{horizon} ahead",
        help="record longer, or use --end clip, which reads the trace as a complete episode",
        explanation="With --end strict a trace must reach as far as the bounded operators of a formula look.",
        bad="# stlspec score spec.stl short.csv --end strict",
        good="# stlspec score spec.stl short.csv --end clip",
        kind="shown",
    ),
    Code(
        "D810",
        "no time stamps",
        "error",
        message="the spec measures time in {unit}, but the data has no 'time'",
        help="add a 'time' column in {unit}, or declare the sampling period: `time 100 ms`",
        explanation="With `time s` the stamps come with the data. Without them bounds in seconds mean "
        "nothing.",
        bad="# time s\nx\n1\n2\n",
        good="# time s\ntime,x\n0,1\n0.5,2\n",
        kind="shown",
    ),
    Code(
        "D811",
        "a time stamp off the sampling period",
        "error",
        message="sample {sample} at {time} is not a multiple of the period {period} after the first",
        help="for uneven stamps write `time {unit}` in the spec",
        explanation="With a sampling period, stamps within 1 % of the period of k periods from the first are "
        "taken as k; anything else means that the declaration and the data disagree.",
        bad="# time 100 ms\ntime,x\n0,1\n130,1\n",
        good="# time 100 ms\ntime,x\n0,1\n100,1\n",
        kind="shown",
    ),
    Code(
        "D812",
        "a time stamp that cannot be kept",
        "error",
        message="time {time} at sample {sample} is not a finite number within 146 years of the first",
        help="give time stamps relative to the start of the recording",
        explanation="Time is kept as 64-bit nanoseconds, and a window ends at most one length of the trace "
        "after its sample, so half of what 64 bits hold is left for the trace.",
        bad="time,x\n0,1\ninf,1\n",
        good="time,x\n0,1\n1,1\n",
        kind="data",
    ),
    Code(
        "D813",
        "data of a wrong shape",
        "error",
        message="{what} {problem}",
        help="give one value for each sample; for a batch (n_traces, n_samples) values, or a list with one "
        "sequence for each trace",
        explanation="One trace is one sequence of values for each signal. A batch has one row for each "
        "trace, and all signals have the same traces. Traces of unequal length come as lists of sequences.",
        bad='{"signals": {"x": 3}}',
        good='{"signals": {"x": [3]}}',
        kind="shown",
    ),
)
