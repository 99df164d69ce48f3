"""How far ahead the bounded operators of a formula look.

In: the DAG. Out: for every node a number of ticks. Unlike the horizon of a bundle this is always finite: an
operator without end counts with its lower bound, which is all that `--end strict` can ask of a finite trace.
"""

from collections.abc import Sequence

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.ir import Node


def bounded_reach(nodes: Sequence[Node], base: TimeBase) -> list[int]:
    """Return how many ticks after a sample each node looks, operators without end to their lower bound.

    Not in the paper: it evaluates complete episodes only.

    Args:    nodes: the DAG, children first. base: how the spec measures time; with time stamps a `next`
             counts as one tick, since where the next sample will be is unknown.
    Returns: ticks, one number for each node, never negative.
    """
    step = base.period or 1
    reach: list[int] = []
    for node in nodes:
        reach.append(_reach(node, [reach[c] for c in node.children], step, base.kind == "stamps"))
    return reach


def _reach(node: Node, operands: list[int], step: int, uneven: bool) -> int:
    farthest = max(operands, default=0)
    low, high = node.interval or (0, 0)
    if node.op in ("always", "eventually", "until"):
        return farthest + (low if high is None else high)
    if node.op == "next":
        return farthest + step
    if node.op == "prev":
        return farthest if uneven else max(0, farthest - step)
    if node.op in ("historically", "once"):
        return max(0, farthest - low)
    if node.op == "since":
        return max(0, operands[0], operands[1] - low)
    return farthest
