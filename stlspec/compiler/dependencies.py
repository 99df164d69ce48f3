"""The DAG of requirements and its weights.

In: for each requirement the names it depends on. Out: ancestors, the paper's weights, their softmax, cycles.
Sets of requirements are the bits of an integer, so that ten thousand of them close transitively at once; the
standard library is enough, and `check` stays light.
"""

import math
from collections.abc import Mapping, Sequence
from decimal import Context, Decimal
from graphlib import CycleError, TopologicalSorter

_PRECISE = Context(prec=25)


def find_cycle(depends_on: Mapping[str, Sequence[str]]) -> list[str] | None:
    """Return one circle of names, the first repeated at the end, each depending on the next; None if acyclic."""
    try:
        TopologicalSorter(depends_on).prepare()
    except CycleError as error:
        circle: list[str] = error.args[1]
        return circle[::-1]
    return None


def ancestors(depends_on: Mapping[str, Sequence[str]]) -> dict[str, int]:
    """Return for each name all that it depends on, through others too, itself left out; acyclic input.

    Returns: a set for each name, as the bits of an integer: bit i is the i-th name of `depends_on`.
    """
    bit = {name: 1 << i for i, name in enumerate(depends_on)}
    above: dict[str, int] = {}
    for name in TopologicalSorter(depends_on).static_order():
        mask = 0
        for direct in depends_on[name]:
            mask |= above[direct] | bit[direct]
        above[name] = mask
    return {name: above[name] for name in depends_on}


def dependency_weights(above: Sequence[int]) -> tuple[int, ...]:
    """Weigh every requirement by how little it depends on: |Φ| - |ancestors|.

    Paper: equation (1), dag_weights.
    Args:    above: for each requirement the set of all it depends on, itself left out, as bits (`ancestors`).
    Returns: n_requirements whole numbers in [1, n_requirements], no unit.
    """
    return tuple(len(above) - mine.bit_count() for mine in above)


def softmax(weights: Sequence[float]) -> tuple[float, ...]:
    """Turn weights into positive shares that sum to 1, at temperature 1.

    Paper: Algorithm 1, line "perform softmax".
    Args:    weights: n numbers, no unit.
    Returns: n numbers in (0, 1]; the largest weight is subtracted first, so nothing overflows.
    """
    if not weights:
        return ()
    largest = max(weights)
    # Decimal rounds correctly everywhere; the last bit of math.exp depends on the C library, bundles must not.
    power = {w: float(Decimal(w - largest).exp(_PRECISE)) for w in set(weights)}
    powers = [power[w] for w in weights]
    total = math.fsum(powers)
    return tuple(p / total for p in powers)


def transitive_reduction(depends_on: Mapping[str, Sequence[str]]) -> dict[str, tuple[str, ...]]:
    """Leave out every edge that a longer path says already; acyclic input."""
    above = ancestors(depends_on)
    bit = {name: 1 << i for i, name in enumerate(depends_on)}
    reduced = {}
    for name, direct in depends_on.items():
        said = 0
        for other in direct:
            said |= above[other]
        reduced[name] = tuple(dict.fromkeys(d for d in direct if not said & bit[d]))
    return reduced
