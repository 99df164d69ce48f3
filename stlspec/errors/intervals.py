"""I4xx: intervals and periods."""

from stlspec.errors.model import Code

_D = "signal d\n"

CODES: tuple[Code, ...] = (
    Code(
        "I401",
        "a reversed interval",
        "error",
        message="the interval ends before it begins",
        label="{low} comes after {high}",
        help="write [{high}, {low}]",
        explanation="A window from 5 to 2 has no sample: other tools call every formula over it true, or fail at run "
        "time.",
        bad=_D + "hard safe: always[5, 2] (d > 1)\n",
        good=_D + "hard safe: always[2, 5] (d > 1)\n",
    ),
    Code(
        "I402",
        "a negative bound",
        "error",
        message="a bound cannot be negative",
        label="{value}",
        help="{help}",
        explanation="Future operators look ahead from the present sample, past operators back; the bounds are "
        "distances in time.",
        bad=_D + "hard safe: always[-1, 2] (d > 1)\n",
        good=_D + "hard safe: always historically[0, 1] (d > 1)\n",
    ),
    Code(
        "I403",
        "a bound between two samples",
        "warning",
        message="the bound {value} is no multiple of the period: the window covers {covers}",
        help="{help}",
        explanation="A window is the set of samples whose time lies in the interval, so a bound between two samples "
        "acts as the sample inside.",
        bad="time 100 ms\n" + _D + "hard safe: always[0, 250 ms] (d > 1)\n",
        good="time 100 ms\n" + _D + "hard safe: always[0, 200 ms] (d > 1)\n",
    ),
    Code(
        "I404",
        "a window without a sample",
        "error",
        message="no sample lies in this window: {problem}",
        help="{help}",
        explanation="A window that begins at infinity, or between two neighbouring samples, is always empty.",
        bad=_D + "hard safe: always[inf, inf] (d > 1)\n",
        good=_D + "hard safe: always[0, inf] (d > 1)\n",
    ),
    Code(
        "I405",
        "a bound too large",
        "error",
        message="the bound {value} is too large to be kept",
        help="write `inf` if no bound is meant",
        explanation="Time is kept as 64-bit nanoseconds, 292 years; samples are counted in 64 bits.",
        bad=_D + "hard safe: always[0, 1e30] (d > 1)\n",
        good=_D + "hard safe: always[0, inf] (d > 1)\n",
    ),
    Code(
        "I406",
        "a period without sense",
        "error",
        message="the sampling period must be at least 1 ns and at most 146 years",
        help="write for instance `time 100 ms`",
        explanation="Time is kept as 64-bit nanoseconds.",
        bad="time 0 ms\n" + _D + "hard safe: always (d > 1)\n",
        good="time 10 ms\n" + _D + "hard safe: always (d > 1)\n",
    ),
)
