"""The definition of robustness and of the Boolean semantics, written naively.

Plain recursion over the nodes and plain loops over the samples, on integer ticks; nothing is shared with the
engine, not even the tie rule: here a predicate on its bound is worth 0, and truth is computed beside it.
`python tests/oracle.py --cases 20000 --seed 0`, from the root of the repository, compares the two.
"""

import argparse
import math
import random
import sys
from pathlib import Path

INF = math.inf
INEXACT = {"exp", "log", "sin", "cos", "pow", "hypot"}
"""Operators whose last digit two mathematical libraries may disagree on."""


class NotANumberError(Exception):
    """A real expression has no value at some sample."""


class Oracle:
    """Values of nodes over one trace: signals (name -> list), times in ticks, ticks per unit."""

    def __init__(self, nodes, signals, times, ticks_per_unit):
        self.nodes, self.signals, self.times, self.ticks_per_unit = nodes, signals, times, ticks_per_unit
        self.n = len(times)
        self._memo = {}

    def real(self, index):
        """Values of a real expression at every sample."""
        return self._once("real", index, self._real)

    def rho(self, index):
        """Robustness of a formula at every sample."""
        return self._once("rho", index, lambda i: self._formula(i, _ROBUST))

    def holds(self, index):
        """Truth of a formula at every sample."""
        return self._once("holds", index, lambda i: self._formula(i, _BOOLEAN))

    def within(self, index, algebra):
        """Value of a formula at every sample in any algebra, a dictionary such as `_ROBUST`."""
        return self._once(algebra["name"], index, lambda i: self._formula(i, algebra))

    def _once(self, kind, index, compute):
        if (kind, index) not in self._memo:
            self._memo[kind, index] = compute(index)
        return self._memo[kind, index]

    def _real(self, index):
        node = self.nodes[index]
        if node.op == "const":
            return [node.value] * self.n
        if node.op == "signal":
            return [float(x) for x in self.signals[node.value]]
        if node.op == "now":
            return [(t - self.times[0]) / self.ticks_per_unit for t in self.times]
        operands = [self.real(c) for c in node.children]
        if node.op in ("delta", "rate"):
            x, values = operands[0], [0.0]
            for i in range(1, self.n):
                elapsed = (self.times[i] - self.times[i - 1]) / self.ticks_per_unit
                values.append((x[i] - x[i - 1]) / (elapsed if node.op == "rate" else 1.0))
        else:
            values = [arithmetic(node.op, [o[i] for o in operands]) for i in range(self.n)]
        if any(math.isnan(v) for v in values):
            raise NotANumberError(index)
        return values

    def _formula(self, index, algebra):
        node = self.nodes[index]
        meet, join, bottom, top = algebra["meet"], algebra["join"], algebra["bottom"], algebra["top"]
        if node.op in _COMPARE:
            left, right = (self.real(c) for c in node.children)
            return [algebra["predicate"](node.op, a, b) for a, b in zip(left, right, strict=True)]
        if node.op == "bool":
            return [top if x else bottom for x in self.signals[node.value]]
        if node.op in ("true", "false"):
            return [top if node.op == "true" else bottom] * self.n
        operands = [self._once(algebra["name"], c, lambda i: self._formula(i, algebra)) for c in node.children]
        if node.op == "not":
            return [algebra["negate"](x) for x in operands[0]]
        if node.op in ("and", "or"):
            pick = meet if node.op == "and" else join
            return [pick(column) for column in zip(*operands, strict=True)]
        if node.op == "next":
            return [*operands[0][1:], bottom]
        if node.op == "prev":
            return [bottom, *operands[0][:-1]]
        values = []
        for i in range(self.n):
            window = self.window(node, i)
            if node.op in ("always", "historically"):
                values.append(meet([operands[0][j] for j in window] or [top]))
            elif node.op in ("eventually", "once"):
                values.append(join([operands[0][j] for j in window] or [bottom]))
            else:
                left, right = operands
                span = range if node.op == "until" else lambda a, b: range(b + 1, a + 1)
                branches = [meet([right[j], *(left[k] for k in span(i, j))]) for j in window]
                values.append(join(branches or [bottom]))
        return values

    def window(self, node, i):
        """Samples in the window of a bounded operator at sample i."""
        low, high = node.interval
        past = node.op in ("historically", "once", "since")
        samples = []
        for j in range(self.n):
            ahead = self.times[i] - self.times[j] if past else self.times[j] - self.times[i]
            if ahead >= low and (high is None or ahead <= high):
                samples.append(j)
        return samples

    def deciding(self, root, at):
        """All (predicate, sample, sign) that decide the value at `at`, and whether a window ran out.

        Values here must tell ties apart, so the robustness used is that of `tied`.
        """
        seen, found, ran_out = set(), set(), False
        stack = [(root, at, 1)]
        while stack:
            state = stack.pop()
            if state in seen:
                continue
            seen.add(state)
            index, i, sign = state
            node = self.nodes[index]
            if node.op in _COMPARE or node.op == "bool":
                found.add(state)
            elif node.op == "not":
                stack.append((node.children[0], i, -sign))
            elif node.op not in ("true", "false"):
                operands, empty = self._operands(node, index, i)
                ran_out = ran_out or empty
                stack += [(child, j, sign) for child, j in operands]
        return found, ran_out

    def tied(self, index):
        """Robustness as pairs (value, 1 or -1): a value 0 that holds is greater than a 0 that does not."""
        return [(r, 1 if h else -1) for r, h in zip(self.rho(index), self.holds(index), strict=True)]

    def _operands(self, node, index, i):
        """Operands (child, sample) with the value of the node at i; whether its window is empty."""
        value = self.tied(index)[i]
        equal = [(c, j) for c in node.children for j in range(self.n) if self.tied(c)[j] == value]
        if node.op in ("and", "or"):
            return [(c, j) for c, j in equal if j == i], False
        if node.op in ("next", "prev"):
            j = i + 1 if node.op == "next" else i - 1
            return [(c, k) for c, k in equal if k == j], not 0 <= j < self.n
        window = self.window(node, i)
        if len(node.children) == 1:
            return [(c, j) for c, j in equal if j in window], not window
        left, right = (self.tied(c) for c in node.children)
        span = range if node.op == "until" else lambda a, b: range(b + 1, a + 1)
        chosen = set()
        for j in window:
            branch = [(node.children[1], j, right[j])] + [(node.children[0], k, left[k]) for k in span(i, j)]
            if min(v for _, _, v in branch) == value:
                chosen.update((c, k) for c, k, v in branch if v == value)
        return list(chosen), not window


_COMPARE = {
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "gt": lambda a, b: a > b,
    "ge": lambda a, b: a >= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
}


def distance(op, a, b):
    """Robustness of a predicate; equal infinities differ by 0."""
    difference = 0.0 if a == b else a - b
    if op in ("lt", "le"):
        return -difference
    if op == "eq":
        return -abs(difference)
    return abs(difference) if op == "ne" else difference


_ROBUST = {
    "name": "rho",
    "meet": min,
    "join": max,
    "negate": lambda x: -x,
    "bottom": -INF,
    "top": INF,
    "predicate": distance,
}
_BOOLEAN = {
    "name": "holds",
    "meet": all,
    "join": any,
    "negate": lambda x: not x,
    "bottom": False,
    "top": True,
    "predicate": lambda op, a, b: _COMPARE[op](a, b),
}


def arithmetic(op, values):
    """IEEE 754 arithmetic on Python floats, without exceptions."""
    if op in ("add", "mul"):
        result = values[0]
        for x in values[1:]:
            result = result + x if op == "add" else result * x
        return result
    if op in ("min", "max"):
        return (min if op == "min" else max)(values) + 0.0
    x, y = values[0], values[-1]
    if op == "neg":
        return -x
    if op == "abs":
        return abs(x)
    if op == "sub":
        return x - y
    if op == "div":
        if y != 0:
            return x / y
        return math.nan if x == 0 else math.copysign(INF, x) * math.copysign(1.0, y)
    if op == "log":
        return math.nan if x < 0 else -INF if x == 0 else math.log(x)
    if op == "sqrt":
        return math.nan if x < 0 else math.sqrt(x)
    if op in ("sin", "cos"):
        return math.nan if math.isinf(x) else getattr(math, op)(x)
    if op == "hypot":
        return math.hypot(x, y)
    return _exponential(op, x, y)


def _exponential(op, x, y):
    if op == "exp":
        return INF if x > 709.7 else math.exp(x)
    odd = y == math.floor(y) and math.fmod(y, 2) != 0 if math.isfinite(y) else False
    try:
        return math.pow(x, y)
    except OverflowError:
        return -INF if x < 0 and odd else INF
    except ValueError:
        return math.nan if x != 0 else math.copysign(INF, x) if odd else INF


def disagreement(case):
    """Compare the engine with the definition on one random case; None if they agree."""
    from stlspec.errors import DataError
    from stlspec.semantics.robustness import evaluate_nodes, shown

    oracle = Oracle(case.nodes, case.signals, case.times, case.ticks_per_unit)
    try:
        expected, truth = oracle.rho(case.root), oracle.holds(case.root)
    except NotANumberError:
        expected, truth = None, None
    try:
        values = evaluate_nodes(case.nodes, [case.root], case.trace())[0]
    except DataError:
        return None if expected is None else f"the engine sees a NaN, the definition does not: {case}"
    if expected is None:
        return f"the definition sees a NaN, the engine does not: {case}"
    exact = not any(case.nodes[i].op in INEXACT for i in range(len(case.nodes)))
    numbers = shown(values).tolist()
    for i in range(len(expected)):
        same = numbers[i] == expected[i]
        if not exact and not same:
            same = math.isclose(numbers[i], expected[i], rel_tol=1e-9, abs_tol=1e-9)
        clear = exact or expected[i] == numbers[i] or abs(expected[i]) > 1e-6
        if not same or (clear and bool(values[i] > 0) != truth[i]):
            return f"sample {i}: {values[i]} instead of {expected[i]}, {truth[i]}: {case}"
    return None


def main(arguments=None):
    """Compare engine and definition on random cases; return 1 if they ever disagree."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
    from tests.strategies import random_case

    rng = random.Random(options.seed)
    wrong = 0
    for _ in range(options.cases):
        found = disagreement(random_case(rng))
        if found is not None:
            wrong += 1
            if wrong <= 5:
                print(found)
    print(f"{options.cases} cases, {wrong} disagreements")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
