"""Weights of the DAG: |Φ| - |ancestors|, then softmax; numbers by hand."""

import math
import random
import time
from itertools import pairwise

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.compiler.dependencies import ancestors, dependency_weights, find_cycle, softmax, transitive_reduction
from stlspec.source import SourceText


def weights(edges):
    """Compile requirements with these edges; return raw and softmax weights in the order of the text."""
    lines = [f"hard {name}{' depends on ' + ', '.join(on) if on else ''}: x > 1" for name, on in edges.items()]
    bundle = compile_source(SourceText.of("s", "signal x\n" + "\n".join(lines)))
    return list(bundle.raw_weights), list(bundle.weights)


@pytest.mark.parametrize(
    ("edges", "raw"),
    [
        ({"a": []}, [1]),
        ({"a": [], "b": []}, [2, 2]),
        ({"a": [], "b": ["a"], "c": ["b"]}, [3, 2, 1]),
        ({"c": ["b"], "b": ["a"], "a": []}, [1, 2, 3]),
        ({"a": [], "b": ["a"], "c": ["a", "b"]}, [3, 2, 1]),
        ({"a": [], "b": ["a"], "c": ["a"], "d": ["b", "c"]}, [4, 3, 3, 1]),
        ({"a": [], "b": ["a"], "c": [], "d": ["c"]}, [4, 3, 4, 3]),
        ({"a": [], "b": [], "c": ["a", "b"], "d": ["c"], "e": []}, [5, 5, 3, 2, 5]),
    ],
)
def test_a_weight_is_the_count_of_requirements_less_the_ancestors(edges, raw):
    found, shares = weights(edges)
    assert found == raw
    total = sum(math.exp(w) for w in raw)
    assert shares == pytest.approx([math.exp(w) / total for w in raw], abs=1e-12)


def test_a_chain_of_three_has_the_shares_of_the_paper():
    _, shares = weights({"a": [], "b": ["a"], "c": ["b"]})
    # e^3, e^2, e^1 over their sum: 1 / (1 + e^-1 + e^-2) = 0.66524...
    assert shares == pytest.approx([0.6652409557748219, 0.24472847105479767, 0.09003057317038046], abs=1e-12)


def test_a_prerequisite_outweighs_its_dependants():
    _, shares = weights({"a": ["b"], "b": ["c"], "c": []})
    assert shares[2] > shares[1] > shares[0]


def test_softmax_sums_to_one_without_overflow_and_is_the_same_bits_everywhere():
    shares = softmax([10_000, 9_999, 1])
    assert math.fsum(shares) == pytest.approx(1, abs=1e-15)
    assert shares[2] == 0
    assert softmax([]) == ()
    # The correctly rounded quotient of correctly rounded powers, whatever the C library.
    assert softmax([3, 2, 1])[0].hex() == (1.0 / math.fsum([1.0, 0.36787944117144233, 0.1353352832366127])).hex()


def naive_ancestors(edges, name):
    found = set()
    for on in edges[name]:
        found |= {on} | naive_ancestors(edges, on)
    return found


def random_dag(rng):
    names = [f"r{i}" for i in range(rng.randint(1, 9))]
    edges = {name: rng.sample(names[:i], rng.randint(0, i)) for i, name in enumerate(names)}
    order = rng.sample(names, len(names))
    return {name: edges[name] for name in order}


def test_ancestors_are_the_transitive_closure_on_random_graphs():
    rng = random.Random(0)
    for _ in range(200):
        edges = random_dag(rng)
        sets = {
            name: {other for i, other in enumerate(edges) if bits >> i & 1} for name, bits in ancestors(edges).items()
        }
        assert sets == {name: naive_ancestors(edges, name) for name in edges}
        assert dependency_weights(list(ancestors(edges).values())) == tuple(len(edges) - len(s) for s in sets.values())


def test_the_transitive_reduction_keeps_the_ancestors_and_no_edge_too_many():
    rng = random.Random(1)
    for _ in range(100):
        edges = random_dag(rng)
        reduced = transitive_reduction(edges)
        assert ancestors(reduced) == ancestors(edges)
        for name, on in reduced.items():
            for other in on:
                without = {**reduced, name: tuple(x for x in on if x != other)}
                assert ancestors(without) != ancestors(edges)


def test_a_circle_is_returned_in_the_order_of_its_edges():
    edges = {"a": ["b"], "b": ["c", "d"], "c": ["a"], "d": []}
    circle = find_cycle(edges)
    assert circle is not None and circle[0] == circle[-1] and set(circle) == {"a", "b", "c"}
    assert all(after in edges[before] for before, after in pairwise(circle))
    assert find_cycle({"a": ["b"], "b": []}) is None


def test_ten_thousand_requirements_in_a_chain_are_weighed_in_seconds():
    edges = {f"r{i}": [f"r{i - 1}"] if i else [] for i in range(10_000)}
    before = time.process_time()
    raw = dependency_weights(list(ancestors(edges).values()))
    assert (raw[0], raw[-1]) == (10_000, 1)
    assert softmax(raw)[0] == pytest.approx(1 - math.exp(-1), abs=1e-12)
    assert time.process_time() - before < 3
