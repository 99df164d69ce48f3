"""Offline = definition = online after finish(), at every sample, on random (formula, trace) pairs.

`python -m tests.semantics.online.pairs --pairs 100000 --seed 0`, from the root of the repository. All operators,
counted, periodic and uneven samples. `fuzz.py` compares what is said before the end.
"""

import argparse
import random
import sys
from collections import Counter

from stlspec.compiler.ir import FUTURE, PAST
from stlspec.semantics.evaluation import evaluate
from tests.oracle import Oracle
from tests.semantics.online.cases import nested_formula, random_case

OPERATORS = {*FUTURE, *PAST, "not", "and", "or", "lt", "le", "gt", "ge", "eq", "ne", "bool", "true", "false"}


def check_pair(case):
    """Robustness and verdict at every sample are the same in all engines, and at sample 0 in the reading `start`."""
    bundle = case.bundle()
    oracle = Oracle(case.nodes, case.signals, case.times, case.base.ticks_per_unit)
    expected = list(zip(oracle.rho(case.root), oracle.holds(case.root), strict=True))
    signals, time = case.prefix(case.n)
    offline = evaluate(bundle, signals, time)["r"]
    assert list(zip(offline.signal.tolist(), (offline.values > 0).tolist(), strict=True)) == expected
    start, every = case.monitor("start"), case.monitor("every")
    known = []
    for i in range(case.n):
        start.update(case.sample(i), case.stamp(i))
        known += every.update(case.sample(i), case.stamp(i))
    known += every.finish()
    assert [(k.robustness, k.verdict == "satisfied") for k in known] == expected
    final = start.finish()["r"]
    assert (final.robustness, final.verdict == "satisfied") == expected[0]


def check_pairs(pairs, seed, longest=10):
    """Return the pairs on which the engines disagree. Every operator and kind of time must have been among them."""
    rng = random.Random(seed)
    wrong, seen, kinds = [], Counter(), Counter()
    for i in range(pairs):
        case = random_case(rng, nested_formula if i % 4 == 3 else None, longest=longest)
        seen.update({node.op for node in case.nodes})
        kinds[case.base.kind, case.stamped] += 1
        try:
            check_pair(case)
        except AssertionError as error:
            wrong.append((case, error))
    assert set(seen) >= OPERATORS, OPERATORS - set(seen)
    assert len(kinds) == 4, kinds
    return wrong


def main(arguments=None):
    """Return 1 if anything disagrees."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--pairs", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    wrong = check_pairs(options.pairs, options.seed)
    for case, error in wrong[:3]:
        print(case, error)
    print(f"{options.pairs} pairs, {len(wrong)} disagreements")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
