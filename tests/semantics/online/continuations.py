"""Hold enclosures to brute force: every way a short trace can go on, every early end included.

`python -m tests.semantics.online.continuations --formulas 5000 --seed 0`, from the root of the repository.
"""

import argparse
import random
import sys
from dataclasses import replace
from itertools import pairwise

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.evaluation import evaluate
from stlspec.semantics.online import make_monitor
from tests.semantics.online.cases import STEP, bundle_of, nested_formula, random_case, random_formula, random_times

VALUES = (-2.0, 0.5, 3.0)
RANGED = (Signal("x", low=-2.0, high=3.0), Signal("y", low=-2.0, high=3.0))
LONGEST = 13
"""Samples that the horizon of no formula of `one_polarity` goes beyond."""


def check_continuations(rng, formula, ahead=3):
    """Go on in all ways of up to `ahead` more samples, and end at each of them; return how many ends there were."""
    case = random_case(rng, formula, depth=2, longest=2)
    # One signal is enough for brute force; a trace of "horizon" would have to reach it.
    nodes = tuple(replace(n, value="x") if n.value == "y" else n for n in case.nodes)
    case = replace(case, nodes=nodes, ends="any")
    monitor = case.monitor()
    told = [monitor.update(case.sample(k), case.stamp(k))["r"] for k in range(case.n)]
    return _branch(case, rng, monitor, told, case.times[-1], ahead)


def _branch(case, rng, monitor, told, time, ahead):
    """End here, or go on; copies must not disturb each other."""
    newest = told[-1]
    final = monitor.finish()["r"].robustness
    assert final == newest.current
    for before in told:
        assert before.low <= final <= before.high, (case, told)
    for before, after in pairwise(told):
        assert before.low <= after.low <= after.high <= before.high, (case, told)
    if ahead == 0:
        return 1
    time += random_times(rng, 2, case.base, case.base is not STEP)[1] if case.stamped else 0
    stamp = time / case.base.ticks_per_unit if case.stamped else None
    ends = 1
    for x in VALUES:
        copy = monitor.copy()
        after = copy.update({"x": x, "y": x, "b": x > 0}, stamp)["r"]
        ends += _branch(case, rng, copy, [*told, after], time, ahead - 1)
    return ends


def one_polarity(b, rng, depth):
    """x only positive, y only negative, nothing past."""
    if depth == 0:
        name, op = rng.choice([("x", "gt"), ("x", "ge"), ("y", "lt"), ("y", "le")])
        bound = b.add("const", value=rng.choice([-1.0, 0.0, 1.0]))
        return b.add(op, [b.add("signal", value=name), bound])
    op = rng.choice(["and", "or", "always", "eventually", "until", "next"])
    children = [one_polarity(b, rng, depth - 1) for _ in range(2 if op in ("and", "or", "until") else 1)]
    low = rng.choice([0, 0, 1])
    interval = None if op in ("and", "or", "next") else (low, low + rng.choice([0, 1, 2]))
    return b.add(op, children, interval=interval)


def check_hull(rng):
    """A trace that reaches the horizon, each signal in one polarity: low and high are values that it can have."""
    b = Builder()
    root = one_polarity(b, rng, rng.randint(1, 3))
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), RANGED)
    monitor = make_monitor(bundle, ends="horizon")
    x, y = [], []
    for n in range(1, 5):
        x.append(rng.choice([-2.0, 0.0, 1.0, 3.0]))
        y.append(rng.choice([-2.0, 0.0, 1.0, 3.0]))
        told = monitor.update({"x": x[-1], "y": y[-1]})["r"]
        # The formula is monotone in every sample, so the extreme continuations are two constant ones.
        extremes = [
            evaluate(bundle, {"x": x + [a] * (LONGEST - n), "y": y + [c] * (LONGEST - n)})["r"].robustness
            for a, c in ((-2.0, 3.0), (3.0, -2.0))
        ]
        assert [told.low, told.high] == extremes, (b.nodes, x, y)


def check_formulas(formulas, seed):
    """Check `formulas` formulas, and as many hulls; return the number of ends that the traces had."""
    rng = random.Random(seed)
    ends = 0
    for i in range(formulas):
        ends += check_continuations(rng, nested_formula if i % 2 else random_formula)
        check_hull(rng)
    return ends


def main(arguments=None):
    """Stop at the first enclosure that is wrong."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--formulas", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    ends = check_formulas(options.formulas, options.seed)
    print(f"{options.formulas} formulas, {ends} ways to go on and end, {options.formulas} exact hulls: all hold")
    return 0


if __name__ == "__main__":
    sys.exit(main())
