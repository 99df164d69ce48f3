"""Random recordings cut into pieces anywhere, and the comparison with the evaluation of the whole.

`python -m tests.semantics.streaming.cases --cases 20000 --seed 0`, from the root of the repository.
"""

import argparse
import random
import sys
from collections import Counter

from stlspec.compiler.bundle import Requirement
from stlspec.compiler.ir import reachable
from stlspec.errors import DataError
from stlspec.semantics.evaluation import evaluate
from stlspec.semantics.streaming import Stream, refusals
from tests.semantics.online.cases import bundle_of
from tests.strategies import DECLARED, SECONDS, STEP, Builder, random_formula, random_signals, random_times


def random_bundle(rng, depth=4):
    """One to three requirements over one DAG."""
    builder = Builder()
    roots = [random_formula(builder, rng, rng.randint(0, depth)) for _ in range(rng.randint(1, 3))]
    nodes, order = reachable(builder.nodes, roots)
    requirements = tuple(Requirement(f"r{i}", "hard", order[root], horizon=None) for i, root in enumerate(roots))
    return bundle_of(nodes, requirements, DECLARED, rng.choice([STEP, SECONDS]))


def random_recording(rng, base, longest=40):
    n = rng.randint(1, longest)
    times = random_times(rng, n, rng.random() < 0.5)
    return random_signals(rng, n), None if base is STEP else [t / base.ticks_per_unit for t in times]


def followed(bundle, signals, time, rng, block):
    """What a stream says of a recording that comes in random portions."""
    stream, begin = Stream(bundle, block=block), 0
    n = len(signals["x"])
    while begin < n:
        end = begin + rng.randint(1, 5)
        stream.take(
            {k: v[begin:end] for k, v in signals.items()},
            None if time is None else time[begin:end],
            min(end, n) - begin,
        )
        begin = end
    return {name: told(outcome) for name, outcome in stream.finish().items()}


def told(result):
    witness = result.witness
    parts = None if witness is None else (witness.sample, witness.time, witness.predicate, witness.reason)
    return result.robustness, result.verdict, result.vacuous, parts


def compare(rng):
    """Compare one random case; return what kind it was."""
    bundle = random_bundle(rng)
    signals, time = random_recording(rng, bundle.time)
    if refusals(bundle):
        return "refused"
    seed, block = rng.random(), rng.choice([1, 2, 4, 7])
    try:
        whole = {name: told(result) for name, result in evaluate(bundle, signals, time).items()}
    except DataError as error:
        try:
            followed(bundle, signals, time, random.Random(seed), block)
        except DataError as other:
            assert other.diagnostics[0].code == error.diagnostics[0].code
            return "no value"
        raise AssertionError("the whole is refused, the stream is not") from error
    found = followed(bundle, signals, time, random.Random(seed), block)
    assert found == whole, (bundle.nodes, bundle.requirements, signals, time, block, found, whole)
    return "vacuous" if any(w[2] for w in whole.values()) else "same"


def main(arguments=None):
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    rng = random.Random(options.seed)
    kinds = Counter(compare(rng) for _ in range(options.cases))
    print(dict(kinds))
    return 0


if __name__ == "__main__":
    sys.exit(main())
