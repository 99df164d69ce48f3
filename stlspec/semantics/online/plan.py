"""What a monitor knows before the first sample.

In: a compiled spec and what is promised of the end. Out: `Plan`, the DAG with what is to be known of each node.
A formula is settled if its value is known as soon as its sample is; all others look ahead. The tail of a
formula encloses its value at any sample that does not exist yet, given that it will: one constant, since
of samples to come nothing but their ranges is known. That keeps the work for a sample independent of windows.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from stlspec.compiler.bundle import BundleData, TimeBase
from stlspec.compiler.ir import COMPARISONS, FUTURE, REAL, Node
from stlspec.compiler.ranges import INF, WHOLE, Range, value_ranges

DEEPEST = 150
"""Deeper formulas are computed by loops only; each level takes some of the stack otherwise."""

Ends = Literal["any", "horizon"]


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """The DAG of a spec as monitors see it.

    nodes: windows begin and end on samples where these are periodic. stride: ticks from a sample to the next
    possible one. dense: no sample is left out. certain: possible samples are promised to come. settled: for
    each node. depths: how many operators that are not settled stand above each other, the node included. tails:
    for each formula (low, high).
    """

    nodes: tuple[Node, ...]
    base: TimeBase
    stride: int
    dense: bool
    certain: bool
    settled: tuple[bool, ...]
    depths: tuple[int, ...]
    tails: dict[int, Range]

    @property
    def counted(self) -> bool:
        """Whether time is the sample's index."""
        return self.base.kind == "step"


def make_plan(bundle: BundleData, ends: Ends = "any") -> Plan:
    """Prepare the DAG of a spec for monitoring.

    Not in the paper: it evaluates complete traces only.

    Args: ends: "any": the trace may end after any sample. "horizon": it reaches the horizon, without gaps;
        this means nothing where time stamps are uneven, since they do not say when samples come.
    """
    base = bundle.time
    even = base.kind != "stamps"
    certain = even and ends == "horizon"
    # Plain texts compare faster than the parser's tokens, which operators may be.
    plain = (replace(node, op=str(node.op)) for node in bundle.nodes)
    nodes = tuple(_on_samples(node, base.period) for node in plain)
    depths: list[int] = []
    for node in nodes:
        below = max((depths[c] for c in node.children), default=0)
        depths.append(below + 1 if below or node.op in FUTURE else 0)
    return Plan(
        nodes=nodes,
        base=base,
        stride=(base.period or 1) if even else 1,
        dense=base.kind == "step" or certain,
        certain=certain,
        settled=tuple(depth == 0 for depth in depths),
        depths=tuple(depths),
        tails=_tails(nodes, value_ranges(nodes, bundle.signals, base), certain),
    )


def _on_samples(node: Node, period: int | None) -> Node:
    """Let a window begin and end on multiples of the period; one that holds none is empty."""
    if period is None or node.interval is None:
        return node
    low, high = node.interval
    low, high = -(-low // period) * period, None if high is None else high // period * period
    if high is not None and high < low:
        return Node("true" if node.op in ("always", "historically") else "false")
    return replace(node, interval=(low, high))


def _tails(nodes: Sequence[Node], values: dict[int, Range], certain: bool) -> dict[int, Range]:
    """Return the tail of every formula.

    Beside it `ranges` holds what encloses a formula at every sample of every trace: the two differ for `prev`,
    which has a sample to look at wherever a sample is still to come.
    """
    tails: dict[int, Range] = {}
    ranges: dict[int, Range] = {}
    for index, node in enumerate(nodes):
        if node.op in REAL:
            continue
        if node.op in COMPARISONS:
            tails[index] = ranges[index] = values[index]
        elif node.op == "prev":
            tails[index] = ranges[node.children[0]]
            ranges[index] = (-INF, tails[index][1])
        else:
            of = ranges if node.op in ("historically", "once", "since") else tails
            tails[index] = _tail(node, [of[c] for c in node.children], certain)
            ranges[index] = _tail(node, [ranges[c] for c in node.children], certain)
    return tails


def _tail(node: Node, operands: Sequence[Range], certain: bool) -> Range:
    op = node.op
    if op == "bool":
        return WHOLE
    if op in ("true", "false"):
        return (INF, INF) if op == "true" else (-INF, -INF)
    if op == "not":
        return -operands[0][1], -operands[0][0]
    if op in ("and", "or"):
        pick = min if op == "and" else max
        return pick(x[0] for x in operands), pick(x[1] for x in operands)
    low, high = operands[-1]
    if op == "next":
        return (low if certain else -INF), high
    assert node.interval is not None
    # Its window holds the sample itself if it begins at 0; else it may be empty, unless promised otherwise.
    if node.interval[0] == 0:
        return low, high
    filled = certain and op in FUTURE
    if op in ("always", "historically"):
        return low, high if filled else INF
    if op in ("until", "since"):
        low, high = min(low, operands[0][0]), min(high, operands[0][1])
    return (low if filled else -INF), high
