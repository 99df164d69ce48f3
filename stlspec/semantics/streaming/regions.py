"""At which samples of a piece the values of a formula are exact, though the recording goes on before and after it.

In: the DAG and the times of a piece. Out: for each node the first such sample and the end of them, and the sample from
which a next piece must hold it. All are found on the times themselves, so that even and uneven samples are one case.
A piece that does not begin at the first sample of the recording begins one sample early, whose values nobody uses.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler.ir import Node

Ints = NDArray[np.int64]


def exact_from(nodes: Sequence[Node], needed: Iterable[int], times: Ints, held: Mapping[int, int]) -> dict[int, int]:
    """Return the first sample at which each node is exact, in a piece whose beginning is cut off.

    Not in the paper: scale.

    Args:    needed: nodes, children first. times: (n_samples,). held: for each `once` and `historically` without end
             the sample from which it looks at the piece; what came before is remembered.
    """
    found: dict[int, int] = {}
    for index in needed:
        node = nodes[index]
        begin = max((found[c] for c in node.children), default=1)
        if index in held:
            assert node.interval is not None
            begin = int(np.searchsorted(times, times[held[index]] + node.interval[0], "left"))
        elif node.op in ("historically", "once", "since") and begin < len(times):
            begin = _after(times, begin, node)
        elif node.op in ("prev", "delta", "rate"):
            begin += 1
        found[index] = begin
    return found


def _after(times: Ints, begin: int, node: Node) -> int:
    """Return the first sample whose window into the past leaves out all samples before `begin`."""
    assert node.interval is not None
    high = node.interval[1]
    if high is None:
        return len(times)
    return max(begin, int(np.searchsorted(times, times[begin - 1] + high, "right")))


def exact_to(nodes: Sequence[Node], needed: Iterable[int], times: Ints) -> dict[int, int]:
    """Return the end of the samples at which each node is exact, while samples still come.

    Not in the paper: scale. Arguments as for `exact_from`.
    """
    found: dict[int, int] = {}
    for index in needed:
        node = nodes[index]
        end = min((found[c] for c in node.children), default=len(times))
        if node.op == "next":
            end = max(0, end - 1)
        elif node.op in ("always", "eventually", "until") and end:
            assert node.interval is not None
            high = node.interval[1]
            end = 0 if high is None else int(np.searchsorted(times, times[end - 1] - high, "right"))
        found[index] = end
    return found


def wanted_from(nodes: Sequence[Node], wanted: Mapping[int, int], times: Ints) -> tuple[dict[int, int], dict[int, int]]:
    """Return the first sample that is still looked at, of each node and by each operator that remembers the past.

    Not in the paper: scale.

    Args:    wanted: for some nodes the sample from which they are wanted, the number of samples at most.
    Returns: two mappings; a sample before the first one is given as 0.
    """
    found = dict(wanted)
    remembering: dict[int, int] = {}
    for index in range(max(found, default=-1), -1, -1):
        if index not in found:
            continue
        node, sample = nodes[index], found[index]
        for child in node.children:
            from_child = _looks_back(node, sample, times)
            if unending_past(node):
                remembering[index] = from_child
            found[child] = min(found.get(child, sample), from_child)
    return found, remembering


def unending_past(node: Node) -> bool:
    """Say whether an operator remembers the past by one value."""
    return node.op in ("historically", "once") and node.interval is not None and node.interval[1] is None


def _looks_back(node: Node, sample: int, times: Ints) -> int:
    if node.op in ("prev", "delta", "rate"):
        return max(0, sample - 1)
    if node.op not in ("historically", "once", "since"):
        return sample
    assert node.interval is not None
    low, high = node.interval
    # A sample that has not come yet comes at least a tick after the newest.
    now = int(times[sample]) if sample < len(times) else int(times[-1]) + 1
    if high is None:
        return max(0, int(np.searchsorted(times, now - low, "right")) - 1)
    return min(sample, int(np.searchsorted(times, now - high, "left")))
