"""Random formulas, prefixes and spellings for the monitor, and the comparisons that all of them must pass.

Expressions use exact operators only, so that every number can be compared bit for bit with the naive one.
"""

from dataclasses import dataclass
from types import MappingProxyType

from stlspec.compiler.bundle import BundleData, Requirement, Signal, TimeBase
from stlspec.compiler.ir import Builder, reachable
from stlspec.semantics.evaluation import evaluate
from stlspec.semantics.online import Monitor, interval_evaluate, make_monitor
from tests.oracle import Oracle
from tests.semantics.online.naive import Naive, shown

VALUES = [-2.0, -1.0, 0.0, 0.5, 1.0, 2.0, 3.0]
STEP = TimeBase("step", "step", 1)
PERIOD = TimeBase("period", "ms", 10, 20)
STAMPS = TimeBase("stamps", "s", 10)
BOUNDED = ("always", "eventually", "until", "historically", "once", "since")
FUTURE = ["not", "and", "or", "always", "eventually", "until", "next"]
PAST = ["historically", "once", "since", "prev"]


@dataclass(frozen=True)
class Case:
    """A formula, a trace and what is declared and promised."""

    nodes: tuple
    root: int
    base: TimeBase
    ranges: dict
    signals: dict
    times: list
    ends: str = "any"
    stamped: bool = False

    @property
    def n(self):
        return len(self.times)

    def bundle(self):
        signals = tuple(
            Signal(name, *self._declared(name)) if name != "b" else Signal("b", "bool") for name in self.signals
        )
        requirement = Requirement("r", "hard", self.root, horizon=None)
        return bundle_of(self.nodes, (requirement,), signals, self.base)

    def _declared(self, name):
        return ("real", None, *self.ranges.get(name, (None, None)))

    def sample(self, i):
        return {name: values[i] for name, values in self.signals.items()}

    def stamp(self, i):
        return self.times[i] / self.base.ticks_per_unit if self.stamped else None

    def prefix(self, n):
        time = [self.stamp(i) for i in range(n)] if self.stamped else None
        return {name: values[:n] for name, values in self.signals.items()}, time

    def naive(self, n):
        return Naive(self.nodes, self.base, self.signals, self.times[:n], self.ranges, self.ends)

    def monitor(self, reading="start"):
        return make_monitor(self.bundle(), reading, self.ends)


def bundle_of(nodes, requirements, signals, base=STEP):
    """A compiled spec of given parts."""
    count = len(requirements)
    weights = (1.0 / count,) * count
    return BundleData(
        "t", None, base, signals, (), requirements, nodes, MappingProxyType({}), (1,) * count, weights, ()
    )


def random_case(rng, formula=None, depth=3, longest=9):
    """A formula of up to `depth` levels, over counted, periodic or uneven samples."""
    base = rng.choice([STEP, STEP, PERIOD, STAMPS])
    builder = Builder()
    root = (formula or random_formula)(builder, rng, rng.randint(0, depth), base.period or 1)
    nodes, order = reachable(builder.nodes, [root])
    n = rng.randint(1, longest)
    ranges = {name: (-2.0, 3.0) for name, share in (("x", 0.5), ("y", 0.3)) if rng.random() < share}
    signals = {
        "x": [rng.choice(VALUES) for _ in range(n)],
        "y": [rng.choice(VALUES) for _ in range(n)],
        "b": [rng.random() < 0.5 for _ in range(n)],
    }
    gaps = base is not STEP and rng.random() < 0.5
    ends = "any" if gaps and base is PERIOD else rng.choice(["any", "horizon"])
    stamped = base is STAMPS or (base is PERIOD and (gaps or rng.random() < 0.5))
    return Case(nodes, order[root], base, ranges, signals, random_times(rng, n, base, gaps), ends, stamped)


def random_times(rng, n, base, gaps):
    times = [0]
    for _ in range(n - 1):
        step = (base.period or 1) * (rng.choice([1, 1, 2]) if gaps else 1)
        times.append(times[-1] + (rng.choice([1, 1, 2, 3]) if base is STAMPS else step))
    return times


def random_interval(rng, scale):
    low = rng.choice([0, 0, 0, 1, 2, 3])
    high = rng.choice([None, low, low + 1, low + 2, low + 4])
    return low * scale, None if high is None else high * scale


def random_formula(builder, rng, depth, scale=1, past=True):
    """A formula with any operators at any place."""
    if depth <= 0 or rng.random() < 0.08:
        return random_predicate(builder, rng)
    op = rng.choice(FUTURE * 2 + PAST if past else FUTURE)
    count = {"and": rng.randint(2, 3), "or": 2, "until": 2, "since": 2}.get(op, 1)
    children = [random_formula(builder, rng, depth - 1, scale, past) for _ in range(count)]
    return builder.add(op, children, interval=random_interval(rng, scale) if op in BOUNDED else None)


def nested_formula(builder, rng, depth, scale=1):
    """always or eventually over a Boolean mix of settled formulas and operators over such."""
    interval = (0, rng.choice([None, 10 * scale])) if rng.random() < 0.6 else random_interval(rng, scale)
    inner = [builder.add("eventually", [settled_formula(builder, rng, scale)], interval=(0, 3 * scale))]
    body = _mix(builder, rng, max(1, depth), inner, scale)
    root = builder.add(rng.choice(["always", "eventually"]), [body], interval=interval)
    return builder.add("next", [root]) if rng.random() < 0.2 else root


def _mix(builder, rng, depth, inner, scale):
    if depth == 0:
        if rng.random() < 0.3:
            return settled_formula(builder, rng, scale)
        if rng.random() < 0.3:
            return rng.choice(inner)
        op = rng.choice(["always", "eventually", "until", "until", "next"])
        children = [settled_formula(builder, rng, scale) for _ in range(2 if op == "until" else 1)]
        inner.append(builder.add(op, children, interval=random_interval(rng, scale) if op in BOUNDED else None))
        return inner[-1]
    op = rng.choice(["and", "or", "or", "not"])
    return builder.add(op, [_mix(builder, rng, depth - 1, inner, scale) for _ in range(1 if op == "not" else 2)])


def settled_formula(builder, rng, scale=1):
    """A predicate, sometimes under a past operator."""
    if rng.random() < 0.85:
        return random_predicate(builder, rng)
    op = rng.choice(PAST)
    children = [random_predicate(builder, rng) for _ in range(2 if op == "since" else 1)]
    return builder.add(op, children, interval=random_interval(rng, scale) if op in BOUNDED else None)


def random_predicate(builder, rng):
    draw = rng.random()
    if draw < 0.12:
        return builder.add("bool", value="b")
    if draw < 0.15:
        return builder.add(rng.choice(["true", "false"]))
    sides = [random_expression(builder, rng, rng.choice([0, 0, 1, 2])), random_expression(builder, rng, 0)]
    return builder.add(rng.choice(["lt", "le", "gt", "ge", "eq", "ne"]), sides)


def random_expression(builder, rng, depth):
    if depth <= 0:
        draw = rng.random()
        if draw < 0.6:
            return builder.add("signal", value=rng.choice("xy"))
        return builder.add("now") if draw < 0.65 else builder.add("const", value=rng.choice(VALUES))
    op = rng.choice(["neg", "add", "sub", "abs", "min", "max", "delta", "rate"])
    count = {"add": 2, "sub": 2, "min": 2, "max": 3}.get(op, 1)
    return builder.add(op, [random_expression(builder, rng, depth - 1) for _ in range(count)])


def verdict(low, high):
    return "satisfied" if low > 0 else "violated" if high < 0 else "undecided"


def check_start(case):
    """Low, high, current and verdict equal the naive ones after every sample."""
    monitor = case.monitor()
    for n in range(1, case.n + 1):
        told = monitor.update(case.sample(n - 1), case.stamp(n - 1))["r"]
        naive = case.naive(n)
        low, high = naive.enclosure(case.root, 0)
        expected = (shown(low), shown(high), shown(naive.current(case.root, 0)), verdict(low, high))
        assert tuple(told) == expected, (n, told, expected, case)


def check_rest(case, rng):
    """Known values, pending enclosures, finish and interval evaluation agree with naive, offline and oracle.

    The monitors are copied or saved and restored in between, at random.
    """
    bundle = case.bundle()
    start, every = case.monitor("start"), case.monitor("every")
    known = []
    for n in range(1, case.n + 1):
        if rng.random() < 0.2:
            start, every = start.copy(), Monitor.from_bytes(bundle, every.to_bytes())
        elif rng.random() < 0.2:
            start, every = Monitor.from_bytes(bundle, start.to_bytes()), every.copy()
        told = start.update(case.sample(n - 1), case.stamp(n - 1))["r"]
        known += every.update(case.sample(n - 1), case.stamp(n - 1))
        _check_pending(case, n, len(known), every.pending()["r"])
        signals, time = case.prefix(n)
        offline = evaluate(bundle, signals, time)["r"]
        final = start.finish()["r"]
        assert (final.robustness.hex(), final.verdict) == (offline.robustness.hex(), offline.verdict)
        everything = known + every.finish()
        assert [k.sample for k in everything] == list(range(n))
        assert [k.time for k in everything] == [offline.origin.trace.time(i) for i in range(n)]
        assert [k.robustness.hex() for k in everything] == [v.hex() for v in offline.signal.tolist()]
        assert [k.verdict for k in everything] == [verdict(v, v) for v in offline.values.tolist()]
        enclosed = interval_evaluate(bundle, signals, time, ends=case.ends)["r"]
        assert (enclosed.low, enclosed.high, enclosed.robustness, enclosed.verdict) == told
    oracle = Oracle(case.nodes, case.signals, case.times, case.base.ticks_per_unit)
    assert [k.robustness for k in known + every.finish()] == oracle.rho(case.root)


def _check_pending(case, n, first, pending):
    naive = case.naive(n)
    assert pending.samples.tolist() == list(range(first, n))
    rows = zip(pending.low.tolist(), pending.high.tolist(), pending.current.tolist(), strict=True)
    for t, row in zip(range(first, n), rows, strict=True):
        low, high = naive.enclosure(case.root, t)
        assert row == (shown(low), shown(high), shown(naive.current(case.root, t))), (t, case)
