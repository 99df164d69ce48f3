"""How far ahead a formula looks.

In: the formula DAG and the time base. Out: for each node its horizon in ticks, None for no end. One loop over
the DAG, since children come first.
"""

from collections.abc import Sequence

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.ir import Node


def horizons(nodes: Sequence[Node], time: TimeBase) -> tuple[int | None, ...]:
    """Return the horizon of every node: the future bounds along its deepest path.

    `next` looks one sample ahead: one tick for `time step`, one period for a period; with uneven stamps its
    length is not known and counts 0. A past operator looks at samples that its operand needs anyway.
    Not in the paper: needed for --end strict and for monitors.
    """
    one = time.period or (1 if time.kind == "step" else 0)
    found: list[int | None] = []
    for node in nodes:
        below = [found[child] for child in node.children]
        ahead: int | None = None if None in below else max((h for h in below if h is not None), default=0)
        if node.op in ("always", "eventually", "until"):
            assert node.interval is not None
            high = node.interval[1]
            ahead = None if ahead is None or high is None else ahead + high
        elif node.op == "next" and ahead is not None:
            ahead += one
        found.append(ahead)
    return tuple(found)
