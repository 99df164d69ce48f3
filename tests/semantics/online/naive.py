"""The interval semantics of online monitoring, written naively: the definition that the engines are tested with.

Plain recursion, one sample at a time, in ticks. `Naive(...).enclosure(node, t)` encloses the value of a node at
sample t of a prefix over every way the trace can go on; `current` is its value if the trace ends here.
"""

import math

INF = math.inf
TIE = 5e-324
WHOLE = (-INF, INF)
PAST = ("historically", "once", "since", "prev")


class Naive:
    """A formula over a prefix of a trace; ranges: name -> (low, high) of the declared signals."""

    def __init__(self, nodes, base, signals, times, ranges=None, ends="any"):
        self.nodes, self.base, self.signals, self.times = nodes, base, signals, times
        self.ranges = ranges or {}
        self.n = len(times)
        self.stride = base.period or 1
        self.certain = ends == "horizon" and base.kind != "stamps"
        self.dense = base.kind == "step" or self.certain
        self.memo = {}

    def once_each(self, key, compute):
        if key not in self.memo:
            self.memo[key] = compute()
        return self.memo[key]

    # values at samples that exist

    def real(self, index, t):
        return self.once_each(("real", index, t), lambda: self._real(index, t))

    def _real(self, index, t):
        node = self.nodes[index]
        if node.op == "const":
            return node.value
        if node.op == "signal":
            return float(self.signals[node.value][t])
        if node.op == "now":
            return self.times[t] / self.base.ticks_per_unit
        if node.op in ("delta", "rate"):
            if t == 0:
                return 0.0
            change = self.real(node.children[0], t) - self.real(node.children[0], t - 1)
            if node.op == "delta":
                return change
            return change / ((self.times[t] - self.times[t - 1]) / self.base.ticks_per_unit)
        return arithmetic(node.op, [self.real(c, t) for c in node.children])

    def atom(self, index, t):
        """Value of a node without formulas under it; None if it has some."""
        node = self.nodes[index]
        if node.op in ("true", "false"):
            return INF if node.op == "true" else -INF
        if node.op == "bool":
            return INF if self.signals[node.value][t] else -INF
        if node.op in COMPARE:
            left, right = (self.real(c, t) for c in node.children)
            return tied(node.op, left, right, distance(node.op, left, right))
        return None

    def current(self, index, t):
        """Value at sample t if the trace ends here."""
        return self.once_each(("current", index, t), lambda: self._current(index, t))

    def _current(self, index, t):
        node = self.nodes[index]
        value = self.atom(index, t)
        if value is not None:
            return value
        below = node.children
        if node.op == "not":
            return -self.current(below[0], t)
        if node.op in ("and", "or"):
            return (min if node.op == "and" else max)(self.current(c, t) for c in below)
        if node.op in ("next", "prev"):
            other = t + 1 if node.op == "next" else t - 1
            return self.current(below[0], other) if 0 <= other < self.n else -INF
        window = self.window(node, t)
        if node.op in ("always", "historically"):
            return min((self.current(below[0], j) for j in window), default=INF)
        if node.op in ("eventually", "once"):
            return max((self.current(below[0], j) for j in window), default=-INF)
        p, q = below
        values = []
        for j in window:
            held = range(t, j) if node.op == "until" else range(j + 1, t + 1)
            values.append(min([self.current(q, j), *(self.current(p, k) for k in held)]))
        return max(values, default=-INF)

    # enclosures

    def window(self, node, t):
        """Known samples in the window of sample t."""
        low, high = node.interval
        sign = -1 if node.op in PAST else 1
        high = INF if high is None else high
        return [j for j in range(self.n) if low <= sign * (self.times[j] - self.times[t]) <= high]

    def nearest(self, node, t):
        """Time of the first possible sample to come in the window of sample t; None if there is none."""
        low, high = node.interval
        first = max(self.times[t] + low, self.times[-1] + self.stride)
        first = self.times[-1] - (self.times[-1] - first) // self.stride * self.stride
        return first if high is None or first <= self.times[t] + high else None

    def enclosure(self, index, t):
        """(low, high) of a formula at sample t, which exists."""
        return self.once_each(("enclosure", index, t), lambda: self._enclosure(index, t))

    def _enclosure(self, index, t):
        node = self.nodes[index]
        value = self.atom(index, t)
        if value is not None:
            return value, value
        below = node.children
        if node.op == "not":
            low, high = self.enclosure(below[0], t)
            return -high, -low
        if node.op in ("and", "or"):
            pick = min if node.op == "and" else max
            return tuple(pick(self.enclosure(c, t)[side] for c in below) for side in (0, 1))
        if node.op == "prev":
            return self.enclosure(below[0], t - 1) if t > 0 else (-INF, -INF)
        if node.op == "next":
            if t + 1 < self.n:
                return self.enclosure(below[0], t + 1)
            low, high = self.tail(below[0])
            return (low if self.certain else -INF), high
        return tuple(self.windowed(node, t, side) for side in (0, 1))

    def windowed(self, node, t, side):
        """One end of the enclosure of an operator with a window."""
        window = self.window(node, t)
        nearest = None if node.op in PAST else self.nearest(node, t)
        if len(node.children) == 1:
            pick, empty = (min, INF) if node.op in ("always", "historically") else (max, -INF)
            values = [self.enclosure(node.children[0], j)[side] for j in window]
            harmful = side == (0 if node.op == "always" else 1)
            if nearest is not None and (harmful or self.certain):
                values.append(self.tail(node.children[0])[side])
            return pick(values, default=empty)
        p, q = node.children
        values = []
        for j in window:
            held = range(t, j) if node.op == "until" else range(j + 1, t + 1)
            values.append(min([self.enclosure(q, j)[side], *(self.enclosure(p, k)[side] for k in held)]))
        if nearest is not None and (side == 1 or self.certain):
            branch = [self.tail(q)[side], *(self.enclosure(p, k)[side] for k in range(t, self.n))]
            if self.dense and nearest > self.times[-1] + self.stride:
                branch.append(self.tail(p)[side])
            values.append(min(branch))
        return max(values, default=-INF)

    # at samples that do not exist yet

    def tail(self, index, anywhere=False):
        """(low, high) at a sample to come; `anywhere`: at any sample of any trace."""
        return self.once_each(("tail", index, anywhere), lambda: self._tail(index, anywhere))

    def _tail(self, index, anywhere):
        node = self.nodes[index]
        below = node.children
        if node.op in ("true", "false"):
            return (INF, INF) if node.op == "true" else (-INF, -INF)
        if node.op == "bool":
            return WHOLE
        if node.op in COMPARE:
            return self.image(node)
        if node.op == "not":
            low, high = self.tail(below[0], anywhere)
            return -high, -low
        if node.op in ("and", "or"):
            pick = min if node.op == "and" else max
            return tuple(pick(self.tail(c, anywhere)[side] for c in below) for side in (0, 1))
        operands = [self.tail(c, anywhere or node.op in PAST) for c in below]
        if node.op == "prev":
            return (-INF if anywhere else operands[0][0]), operands[0][1]
        if node.op == "next":
            return (operands[0][0] if self.certain else -INF), operands[0][1]
        may_be_empty = node.interval[0] > 0
        promised = self.certain and node.op not in PAST
        low, high = operands[-1]
        if node.op in ("always", "historically"):
            return low, (INF if may_be_empty and not promised else high)
        if node.op in ("until", "since") and may_be_empty:
            low, high = min(low, operands[0][0]), min(high, operands[0][1])
        return (-INF if may_be_empty and not promised else low), high

    def image(self, node):
        """All values that a predicate can have: those at the corners, or 0 where both sides can be equal."""
        (a, b), (c, d) = (self.range(child) for child in node.children)
        corners = [tied(node.op, x, y, distance(node.op, x, y)) for x in (a, b) for y in (c, d)]
        if node.op in ("eq", "ne") and a <= d and c <= b:
            corners.append(tied(node.op, 0.0, 0.0, 0.0))
        return min(corners), max(corners)

    def range(self, index):
        """All values that a real expression can have; exact arithmetic only."""
        node = self.nodes[index]
        if node.op == "const":
            return node.value, node.value
        if node.op == "signal":
            return self.ranges.get(node.value, WHOLE)
        if node.op == "now":
            return 0.0, INF
        x = [self.range(c) for c in node.children]
        if node.op in ("delta", "rate"):
            low, high = x[0][0] - x[0][1], x[0][1] - x[0][0]
            shortest = 1 if self.base.kind == "step" else self.stride / self.base.ticks_per_unit
            scale = shortest if node.op == "rate" else 1
            return opened(low / scale, high / scale)
        if node.op == "neg":
            return -x[0][1], -x[0][0]
        if node.op == "abs":
            low, high = x[0]
            return (0.0 if low <= 0 <= high else min(abs(low), abs(high))), max(abs(low), abs(high))
        if node.op == "sub":
            return opened(x[0][0] - x[1][1], x[0][1] - x[1][0])
        if node.op in ("min", "max"):
            pick = min if node.op == "min" else max
            return pick(r[0] for r in x), pick(r[1] for r in x)
        assert node.op == "add", "the naive ranges know exact operators only"
        low, high = x[0]
        for r in x[1:]:
            low, high = opened(low + r[0], high + r[1])
        return low, high


def opened(low, high):
    return (-INF if math.isnan(low) else low), (INF if math.isnan(high) else high)


def arithmetic(op, values):
    if op == "neg":
        return -values[0]
    if op == "abs":
        return abs(values[0])
    if op == "sub":
        return values[0] - values[1]
    if op in ("min", "max"):
        return (min if op == "min" else max)(values)
    assert op == "add", "the naive arithmetic knows exact operators only"
    result = values[0]
    for value in values[1:]:
        result += value
    return result


COMPARE = {
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "gt": lambda a, b: a > b,
    "ge": lambda a, b: a >= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
}


def distance(op, a, b):
    difference = 0.0 if a == b else a - b
    if op in ("lt", "le"):
        return -difference
    if op == "eq":
        return -abs(difference)
    return abs(difference) if op == "ne" else difference


def tied(op, a, b, value):
    """Tell a 0 that holds from one that does not."""
    if value != 0:
        return value
    return TIE if COMPARE[op](a, b) else -TIE


def shown(value):
    return 0.0 if abs(value) <= TIE else value
