"""Random formulas and traces: for loops with a `random.Random`, and as Hypothesis strategies.

Values come from a small set, so that ties, equal infinities and empty windows happen often.
"""

import random
from dataclasses import dataclass

from hypothesis import strategies as st

from stlspec.compiler.bundle import Signal, TimeBase
from stlspec.compiler.ir import Builder, reachable
from stlspec.traces import make_trace

VALUES = [-2.0, -1.0, 0.0, 0.5, 1.0, 2.0, 3.0]
STEP = TimeBase("step", "step", 1)
SECONDS = TimeBase("stamps", "s", 10)
"""Time stamps in tenths of a second, so that ticks are small enough to read."""

DECLARED = (Signal("x"), Signal("y"), Signal("b", "bool"))


@dataclass(frozen=True)
class Case:
    """A formula and a trace."""

    nodes: tuple
    root: int
    signals: dict
    times: list
    base: TimeBase

    @property
    def ticks_per_unit(self):
        return self.base.ticks_per_unit

    def trace(self):
        """The trace as the engine takes it."""
        time = None if self.base.kind == "step" else [t / self.ticks_per_unit for t in self.times]
        return make_trace(self.base, DECLARED, self.signals, time)


def random_case(rng, depth=5, longest=40):
    """One formula of at most `depth` levels over one trace of at most `longest` samples."""
    builder = Builder()
    root = random_formula(builder, rng, rng.randint(0, depth) or depth)
    nodes, order = reachable(builder.nodes, [root])
    even = rng.random() < 0.5
    n = rng.randint(1, longest)
    return Case(nodes, order[root], random_signals(rng, n), random_times(rng, n, even), STEP if even else SECONDS)


def random_times(rng, n, even):
    """Ticks from 0 on."""
    times = [0]
    for _ in range(n - 1):
        times.append(times[-1] + (1 if even else rng.choice([1, 1, 2, 3, 5])))
    return times


def random_signals(rng, n):
    """Two real signals and a Boolean one."""
    values = [*VALUES, float("inf"), float("-inf")] if rng.random() < 0.3 else VALUES
    return {
        "x": [rng.choice(values) for _ in range(n)],
        "y": [rng.choice(values) for _ in range(n)],
        "b": [rng.random() < 0.5 for _ in range(n)],
    }


def random_interval(rng):
    """A closed interval of ticks, often short, sometimes without end."""
    low = rng.choice([0, 0, 0, 1, 2, 5])
    return low, rng.choice([None, low, low + 1, low + 3, low + 10, low + 40])


def random_formula(builder, rng, depth):
    """Add a random formula, return its index."""
    if depth <= 0 or rng.random() < 0.08:
        return random_predicate(builder, rng)
    kind = rng.choice(
        ["not", "and", "or", "always", "eventually", "until", "historically", "once", "since", "next", "prev"]
    )
    n_children = {"and": rng.randint(2, 3), "or": rng.randint(2, 3), "until": 2, "since": 2}.get(kind, 1)
    children = [random_formula(builder, rng, depth - 1) for _ in range(n_children)]
    bounded = kind in ("always", "eventually", "until", "historically", "once", "since")
    return builder.add(kind, children, interval=random_interval(rng) if bounded else None)


def random_predicate(builder, rng):
    """Add a comparison, a Boolean signal or, seldom, a constant."""
    draw = rng.random()
    if draw < 0.1:
        return builder.add("bool", value="b")
    if draw < 0.14:
        return builder.add(rng.choice(["true", "false"]))
    left = random_side(builder, rng)
    right = random_expression(builder, rng, rng.choice([0, 0, 1]))
    return builder.add(rng.choice(["lt", "le", "gt", "ge", "eq", "ne"]), [left, right])


def random_side(builder, rng):
    """Add one side of a comparison.

    Mathematical libraries disagree in the last digit, and arithmetic may blow that up: functions that are
    not exact take plain operands here, and nothing is computed from them.
    """
    if rng.random() < 0.85:
        return random_expression(builder, rng, rng.choice([0, 0, 0, 1, 2]))
    op = rng.choice(["exp", "log", "sin", "cos", "pow", "hypot"])
    n_children = 2 if op in ("pow", "hypot") else 1
    return builder.add(op, [random_expression(builder, rng, 0) for _ in range(n_children)])


def random_expression(builder, rng, depth):
    """Add an exact real expression; of those that may have no value few, or hardly a case would have one."""
    if depth <= 0:
        draw = rng.random()
        if draw < 0.55:
            return builder.add("signal", value=rng.choice(["x", "y"]))
        return builder.add("now") if draw < 0.62 else builder.add("const", value=rng.choice(VALUES))
    often = ["neg", "add", "sub", "mul", "abs", "min", "max", "delta", "rate"]
    op = rng.choice(often if rng.random() < 0.9 else ["div", "sqrt"])
    n_children = rng.randint(2, 3) if op in ("add", "mul", "min", "max") else 2 if op in ("sub", "div") else 1
    return builder.add(op, [random_expression(builder, rng, depth - 1) for _ in range(n_children)])


def cases(depth=5, longest=40):
    """Hypothesis strategy for `random_case`; shrinks to short formulas and traces."""
    return st.randoms(use_true_random=False).map(lambda rng: random_case(rng, depth, longest))


def seeded_cases(count, seed, **sizes):
    """`count` random cases, the same for the same seed."""
    rng = random.Random(seed)
    return (random_case(rng, **sizes) for _ in range(count))
