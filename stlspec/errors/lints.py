"""L6xx: what a spec may say, and hardly means."""

from stlspec.errors.model import Code

_D = "signal d in [0, inf]\n"
_X = "signal x\n"
_P = "signal p: bool\nsignal q: bool\n"

CODES: tuple[Code, ...] = (
    Code(
        "L601",
        "a condition on time alone",
        "warning",
        message="`{text}` depends on time alone: whatever the signals do, the result is the same",
        help="ask for a signal in that time, such as `eventually[0, T] (x > 0)`",
        explanation="Under a temporal operator time runs by itself: `eventually (now <= T)` holds on every trace, "
        "because `now` is 0 at its first sample. A time limit belongs into the interval of the operator.",
        bad=_D + "soft fast: eventually[0, 8] (now <= 8 and now >= 0)\nsoft near: eventually (d < 1)\n",
        good=_D + "soft fast: eventually[0, 8] (d < 1)\n",
    ),
    Code(
        "L602",
        "a comparison that never holds",
        "warning",
        message="`{text}` never holds: {why}",
        help="is the number right, or the range of the signal?",
        explanation="By the declared ranges of the signals and the values of the params, no sample can meet it.",
        bad="signal x in [0, 10]\nsoft high: eventually (x > 12)\n",
        good="signal x in [0, 20]\nsoft high: eventually (x > 12)\n",
    ),
    Code(
        "L603",
        "a comparison that always holds",
        "warning",
        message="`{text}` always holds: {why}",
        help="is the number right, or the range of the signal?",
        explanation="By the declared ranges of the signals and the values of the params, every sample meets it: a "
        "sample outside its range is refused when data are read, before any requirement is judged.",
        bad="signal x in [0, 10]\nhard low: always (x < 12)\n",
        good="signal x in [0, 20]\nhard low: always (x < 12)\n",
    ),
    Code(
        "L604",
        "a robustness of one sign",
        "warning",
        message="the robustness of `{text}` can never be {sign}: {why}",
        help="{help}",
        explanation="Such a condition is met, or missed, only exactly on its bound, so that its robustness says "
        "nothing of how well: `eventually (d <= 0)` for a distance is worth 0 at the best, and near misses count as "
        "much as a hit.",
        bad=_D + "soft reach: eventually (d <= 0)\n",
        good=_D + "soft reach: eventually (d < 1)\n",
    ),
    Code(
        "L605",
        "requirements that contradict each other",
        "warning",
        message="`{name}` and `{other}` cannot both hold",
        help="change one of them: every trace fails at least one",
        explanation="What the two demand of the same sample leaves no value. No trace is good, whatever it does.",
        bad=_X + "hard high: always (x > 5)\nhard low: always (x < 3)\n",
        good=_X + "hard high: always (x > 3)\nhard low: always (x < 5)\n",
    ),
    Code(
        "L606",
        "a requirement that another one contains",
        "warning",
        message="`{name}` holds whenever `{other}` does",
        help="{help}",
        explanation="Beside a stronger hard requirement a weaker one adds a weight, but no demand. Where it is meant "
        "as a first step, for which there is credit already, let the stronger one depend on it; then this is not "
        "reported, nor is a soft one that goes further than another.",
        bad=_X + "hard long: always[0, 10] (x > 0)\nhard short: always[0, 5] (x > 0)\n",
        good=_X + "hard short: always[0, 5] (x > 0)\nhard long depends on short: always[0, 10] (x > 0)\n",
    ),
    Code(
        "L607",
        "an implication that is never triggered",
        "warning",
        message="the implication always holds, because `{text}` never does",
        help="is its left side right, or the range of the signal?",
        explanation="By the declared ranges and the values of the params the left side never holds, so nothing is "
        "asked of the right side.",
        bad="signal x in [0, 10]\nsignal y\nhard react: always (x > 12 implies y > 0)\n",
        good="signal x in [0, 20]\nsignal y\nhard react: always (x > 12 implies y > 0)\n",
    ),
    Code(
        "L608",
        "a hard requirement that is not step-wise",
        "warning",
        message="hard {names} cannot be judged step by step",
        help="for `learn`, state it as `always (...)` of the present and the past, bound what it waits for, or make it "
        "soft",
        explanation="`learn` keeps off steps that violate a hard requirement. It can see them where the requirement is "
        "`always` of a formula over the present and the past, or waits for no longer than a bound. What is violated "
        "only by never coming, such as `eventually p` or `p until q`, it learns from the end of an episode; it refuses "
        "the past of a future, such as `once eventually p`, and a rate of a rate or beside `now` (D868). Scores and "
        "monitors are not concerned.",
        bad=_X + "hard reach: eventually (x > 1)\n",
        good=_X + "hard safe: always (x > 1)\n",
    ),
    Code(
        "L609",
        "real numbers compared for equality",
        "warning",
        message="`{text}` compares measured quantities for equality",
        help="allow for a tolerance, such as `abs({left} - {right}) <= 0.01`",
        explanation="A measured or computed real number hardly ever equals another exactly. Whole numbers without a "
        "unit, such as a row, a gear or a mode, are not reported.",
        bad='signal v unit "m/s"\nsoft stop: eventually (v == 0 m/s)\n',
        good='signal v unit "m/s"\nsoft stop: eventually (abs(v) <= 0.1 m/s)\n',
    ),
    Code(
        "L610",
        "a next that fails at the last sample",
        "warning",
        message="`always (... implies next ...)` fails wherever the left side holds at the last sample",
        label="there is no next sample at the end",
        help="write `wnext` in place of `{word}`",
        explanation="`next p` is false at the last sample of a trace, where there is no next one. `wnext p` is true.",
        bad=_P + "soft step: always (p implies next q)\n",
        good=_P + "soft step: always (p implies wnext q)\n",
    ),
    Code(
        "L611",
        "a formula on the past at the first sample",
        "warning",
        message="`{name}` looks only at the past of the first sample, which has none",
        help="write `{meant}`, or `eventually (...)` if once is enough",
        explanation="A requirement is judged at the first sample of a trace. A formula with past operators only sees "
        "that one sample there.",
        bad=_P + "soft seen: once (p and not q)\n",
        good=_P + "hard seen: always (q implies once[0, 5] p)\n",
    ),
    Code(
        "L612",
        "nested operators that collapse",
        "warning",
        message="`{text}` means no more than {meaning}",
        help="{help}",
        explanation="Without bounds, two equal temporal operators say no more than one. On a trace that ends, "
        "`always eventually p` and `eventually always p` both say that p holds at the last sample; with a bound, as in "
        "`always eventually[0, 5] p`, they say more.",
        bad=_X + "hard twice: always always (x > 1)\n",
        good=_X + "hard once_is_enough: always (x > 1)\n",
    ),
    Code(
        "L613",
        "a mix that other tools read in another way",
        "warning",
        message="other tools read `{text}` in another way",
        label="here it is one operand of `{word}`",
        help="write brackets around `{child}`",
        explanation="In `always p and q`, here `(always p) and q`, other tools let `always` reach to the end; they "
        "differ in the order of `and`, `or` and `implies`, too. Brackets say what is meant; `stlspec fmt` writes them.",
        bad=_P + "soft both: eventually p and q\n",
        good=_P + "soft both: (eventually p) and q\n",
    ),
    Code(
        "L614",
        "a horizon longer than the demonstrations",
        "warning",
        message="`{name}` looks {horizon} ahead, further than {count} reach; the shortest lasts {shortest}",
        help="bounds that no demonstration reaches are not tested by them; `score --end interval` says what is open",
        explanation="A demonstration counts as a complete episode: windows are cut at its end. Reported by "
        "`stlspec check --demos`.",
        bad="# stlspec check spec.stl --demos short.csv",
        good="# stlspec check spec.stl --demos long.csv",
        kind="shown",
    ),
    Code(
        "L615",
        "a signal that nothing uses",
        "warning",
        message="signal `{name}` is used nowhere",
        help="remove it, or state what it has to do",
        explanation="Data must offer every signal that is used; one that is not used may be a requirement forgotten.",
        bad=_X + "signal y\nhard safe: always (x > 1)\n",
        good=_X + "hard safe: always (x > 1)\n",
    ),
    Code(
        "L616",
        "a param that nothing uses",
        "warning",
        message="param `{name}` is used nowhere: binding it changes nothing",
        help="remove it, or use it",
        explanation="A param is there to be bound by `-p`. This one is in no formula, interval or range.",
        bad=_X + "param T = 5\nhard safe: always (x > 1)\n",
        good=_X + "param T = 5\nhard safe: always[0, T] (x > 1)\n",
    ),
    Code(
        "L617",
        "a let that nothing uses",
        "warning",
        message="`{name}` is used nowhere",
        help="remove it, or use it",
        explanation="A let names an expression for use in formulas.",
        bad=_X + "let high = x > 5\nhard safe: always (x > 1)\n",
        good=_X + "let high = x > 5\nhard safe: always (high or x < 1)\n",
    ),
    Code(
        "L618",
        "an ignore that hides nothing",
        "warning",
        message="`{what}` is ignored here, but nothing of it is reported on this line",
        help="remove it from the comment",
        explanation="`# stlspec: ignore CODE` hides the warnings of its line, or, alone on a line, those of the next. "
        "One that hides nothing would hide the next mistake.",
        bad=_X + "hard safe: always (x > 1)  # stlspec: ignore L603\n",
        good=_X + "hard safe: always (x > 1)\n",
    ),
    Code(
        "L619",
        "an ignore that cannot be followed",
        "warning",
        message="this comment ignores nothing: {problem}",
        help="write `# stlspec: ignore L603`, with codes of warnings, or the beginning of codes, such as `L6`",
        explanation="Only warnings can be ignored. Errors keep a spec from being compiled, so they are always shown.",
        bad=_X + "hard safe: always (x > 1)  # stlspec: ignore\n",
        good=_X + "hard safe: always (x > 1)\n",
    ),
    Code(
        "L620",
        "a requirement without an operator of time",
        "warning",
        message="`{name}` speaks of the first sample only: it has no operator of time",
        help="write `{meant}`, or `eventually (...)` if once is enough",
        explanation="A requirement is judged at the first sample of a trace, so `x < 3` says nothing of any later one: "
        "`always (x < 3)` asks it of all samples, `eventually (x < 3)` of one. Where the first sample is meant, as for "
        "the start of an episode, or the spec is for `stlspec monitor --reading every`, which judges every sample, "
        "`# stlspec: ignore L620` says so.",
        bad=_X + "hard low: x < 3\n",
        good=_X + "hard low: always (x < 3)\n",
    ),
)
