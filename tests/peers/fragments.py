"""What each tool is compared on, and why not on more.

A `Fragment` lists what may be generated for a tool. Whatever else the language has is left out either because
the tool has no such operator, or because the tool differs from the definition there; each such difference is a
`Fault` with a case that shows it. `compare.py` runs these cases too, so that an exclusion which is no longer
needed comes to light.
"""

from dataclasses import dataclass

from tests.strategies import VALUES, random_times

X, Y = ["pred", "x", ">", 1.0], ["pred", "y", "<", 1.0]


@dataclass(frozen=True)
class Case:
    """A formula as nested lists, and a trace: signals by name, integer time stamps."""

    formula: list
    signals: dict
    times: list


@dataclass(frozen=True)
class Fault:
    """Where a tool differs from the definition: what it does, a case that shows it, its text for the tool."""

    reason: str
    case: Case
    text: str


@dataclass(frozen=True)
class Fragment:
    """What is generated for a tool.

    unary, timed, paired: operators without interval, with one operand and with two. endless: those of them
    that may go without an interval; late_end: those that may have [a, inf]. zero_width: [0, 0] may occur.
    late_pairs: `paired` may begin later than 0. widest: the longest interval. uneven: time stamps may be
    uneven. closed_until: q of an until is always p and q. absent: what the tool has no syntax for.
    """

    unary: tuple
    timed: tuple
    paired: tuple
    comparisons: tuple
    endless: tuple = ()
    late_end: tuple = ()
    zero_width: bool = True
    late_pairs: bool = True
    widest: int = 40
    booleans: bool = False
    uneven: bool = False
    closed_until: bool = False
    shortest: int = 1
    absent: str = ""
    faults: tuple = ()


def _case(formula, x, y=None, times=None):
    return Case(formula, {"x": x, "y": y or [0.0] * len(x)}, times or list(range(len(x))))


_FIVE = ([1.0, 3.0, 0.0, 2.0, -3.0], [2.0, -2.0, 1.0, 0.0, 1.0])
_ALL = ("<", "<=", ">", ">=", "==", "!=")

FRAGMENTS = {
    "rtamt": Fragment(
        unary=("not",),
        timed=("G", "F", "H", "O"),
        paired=("U", "S", "R", "W"),
        comparisons=_ALL,
        endless=("G", "F", "H", "O", "U", "S", "R"),
        shortest=2,
        absent="[a, inf] with a > 0, Boolean signals (discrete time has indices only: no uneven stamps)",
        faults=(
            Fault("a trace of one sample raises UnboundLocalError", _case(["G", None, X], [2.0]), "always (x > 1)"),
            Fault("next past the end gives +inf", _case(["next", X], *_FIVE), "next (x > 1)"),
            Fault("prev before the start gives +inf", _case(["prev", X], *_FIVE), "prev (x > 1)"),
            Fault("iff is -|p - q|, not a min of implications", _case(["iff", X, Y], *_FIVE), "(x > 1) iff (y < 1)"),
            Fault("xor is |p - q|, not the negation of a min", _case(["xor", X, Y], *_FIVE), "(x > 1) xor (y < 1)"),
            Fault(
                "unless without an interval raises AttributeError",
                _case(["W", None, X, Y], *_FIVE),
                "(x > 1) unless (y < 1)",
            ),
        ),
    ),
    "pybanquo": Fragment(
        unary=("not", "next"),
        timed=("G", "F"),
        paired=(),
        comparisons=("<=", ">="),
        endless=("G", "F"),
        uneven=True,
        absent="past operators, timed until, strict comparisons, ==, !=, [a, inf], iff, xor, Boolean signals",
        faults=(
            Fault(
                "until without an interval is something else",
                _case(
                    ["U", None, ["pred", "x", "<=", 1.0], ["pred", "y", "<=", 1.0]], [1.0, 3.0, 0.0], [2.0, -2.0, 1.0]
                ),
                "(x <= 1) U (y <= 1)",
            ),
        ),
    ),
    "reelay": Fragment(
        unary=("not", "prev"),
        timed=("H", "O"),
        paired=("S",),
        comparisons=_ALL,
        endless=("H", "O", "S"),
        late_end=("H", "O"),
        zero_width=False,
        late_pairs=False,
        booleans=True,
        absent="future operators, iff, xor (read as the left operand alone)",
        faults=(
            Fault("once[0:0] also sees the sample before", _case(["O", [0, 0], X], *_FIVE), "once[0:0] {x > 1}"),
            Fault("historically[0:0] too", _case(["H", [0, 0], X], *_FIVE), "historically[0:0] {x > 1}"),
            Fault(
                "since[a:b] with a > 0 does not ask the left operand at t",
                _case(["S", [1, 2], ["pred", "x", ">", 0.0], ["pred", "x", ">", -2.0]], [-2.0, 3.0, 1.0]),
                "{x > 0} since[1:2] {x > -2}",
            ),
            Fault("since[a:] with a > 0 neither", _case(["S", [1, "inf"], X, Y], *_FIVE), "{x > 1} since[1:] {y < 1}"),
        ),
    ),
    "mstlo": Fragment(
        unary=("not",),
        timed=("G", "F"),
        paired=("U",),
        comparisons=("<", "<=", ">", ">=", "=="),
        closed_until=True,
        widest=3,  # so that horizons fit into the traces
        absent="unbounded operators, past operators, next, !=, iff, xor, Boolean signals; time is dense, so "
        "uneven stamps mean something else; no value before the horizon has arrived",
        faults=(
            Fault(
                "until holds its left operand at t' too", _case(["U", [1, 2], X, Y], *_FIVE), "(x > 1) U[1, 2] (y < 1)"
            ),
        ),
    ),
}


def random_case(fragment, rng, depth=4, longest=40):
    """Make one case inside a fragment."""
    formula = random_formula(fragment, rng, rng.randint(1, depth))
    n = rng.randint(fragment.shortest, longest)
    times = random_times(rng, n, even=not fragment.uneven or rng.random() < 0.5)
    values = [*VALUES, float("inf"), float("-inf")] if rng.random() < 0.2 else VALUES
    signals = {name: [rng.choice(values) for _ in range(n)] for name in ("x", "y")}
    if fragment.booleans:
        signals["b"] = [rng.random() < 0.5 for _ in range(n)]
    return Case(formula, signals, times)


def random_formula(fragment, rng, depth):
    """Make one formula inside a fragment."""
    if depth == 0 or rng.random() < 0.08:
        return _random_atom(fragment, rng)
    op = rng.choice([*fragment.unary, "and", "or", "implies", *fragment.timed, *fragment.paired])
    if op in fragment.unary:
        return [op, random_formula(fragment, rng, depth - 1)]
    left, right = (random_formula(fragment, rng, depth - 1) for _ in range(2))
    if op in ("and", "or", "implies"):
        return [op, left, right]
    interval = _random_interval(fragment, rng, op)
    if op in fragment.timed:
        return [op, interval, left]
    if op == "U" and fragment.closed_until:
        right = ["and", left, right]
    return [op, interval, left, right]


def _random_atom(fragment, rng):
    if fragment.booleans and rng.random() < 0.1:
        return ["bool", "b"]
    return ["pred", rng.choice(["x", "y"]), rng.choice(fragment.comparisons), rng.choice(VALUES)]


def _random_interval(fragment, rng, op):
    low = rng.choice([0, 0, 0, 1, 2, 5]) if fragment.late_pairs or op not in fragment.paired else 0
    draw = rng.random()
    if op in fragment.endless and draw < 0.15:
        return None
    if op in fragment.late_end and draw < 0.3:
        return [low, "inf"]
    widths = [width for width in (0, 1, 3, 10, 40) if width <= fragment.widest]
    return [low, low + rng.choice(widths if fragment.zero_width or low > 0 else widths[1:])]
