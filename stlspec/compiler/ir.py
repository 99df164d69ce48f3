"""The intermediate form: all formulas of a spec as one hash-consed DAG.

In: requests for nodes from `lower`. Out: a tuple of `Node`, children before parents, each distinct node once,
so that every later stage is a plain loop over the tuple and shares equal sub-formulas without looking.

There are few operators, since the derived ones are rewritten by `lower` after their definition:
p implies q = not p or q; p iff q = (p implies q) and (q implies p); p xor q = not (p iff q);
p release_I q = not (not p until_I not q); p unless[a,b] q = (p until[a,b] q) or always[0,b] p;
wnext p = not next not p; wprev p = not prev not p.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

COMPARISONS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}
FUTURE = frozenset({"always", "eventually", "until", "next"})
PAST = frozenset({"historically", "once", "since", "prev"})
BOUNDED = frozenset({"always", "eventually", "until", "historically", "once", "since"})
TEMPORAL = FUTURE | PAST
REAL = frozenset(("const signal now neg add sub mul div pow abs min max sqrt exp log sin cos hypot delta rate").split())
LOGIC = frozenset({"true", "false", "bool", "not", "and", "or"}) | COMPARISONS.keys() | TEMPORAL
OPERATORS = REAL | LOGIC

Interval = tuple[int, int | None]
"""A closed interval of ticks, (low, high); high None means without end."""


@dataclass(frozen=True, slots=True)
class Node:
    """One operator of the DAG.

    op: a member of `OPERATORS`. children: indices of the operands, smaller than the node's own; a comparison
    has (left, right), `until` and `since` (left, right), `and`, `or`, `add`, `mul`, `min`, `max` two or more.
    value: the number of a `const`, the name of a `signal` (real) or `bool` (Boolean signal).
    interval: for `BOUNDED` operators.
    """

    op: str
    children: tuple[int, ...] = ()
    value: float | str | None = None
    interval: Interval | None = None


class Builder:
    """Collects nodes, each distinct one once; `nodes` is the DAG so far."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._index: dict[Node | tuple[str, str], int] = {}

    def add(
        self,
        op: str,
        children: Sequence[int] = (),
        value: float | str | None = None,
        interval: Interval | None = None,
    ) -> int:
        """Return the index of the node with these parts, made if it is new."""
        node = Node(op, tuple(children), value, interval)
        # 0.0 == -0.0 in Python, but they are different constants (1 / 0.0): the sign is part of the key.
        key: Node | tuple[str, str] = (op, repr(value)) if op == "const" else node
        found = self._index.get(key)
        if found is None:
            found = self._index[key] = len(self.nodes)
            self.nodes.append(node)
        return found


def reachable(nodes: Sequence[Node], roots: Iterable[int]) -> tuple[tuple[Node, ...], dict[int, int]]:
    """Keep the nodes that `roots` need, in the order of a post-order walk from the first root to the last.

    Two DAGs with the same meaning thus get the same numbers, whatever text they came from.

    Returns: the nodes, renumbered; the new index of each kept old index.
    """
    order: dict[int, int] = {}
    kept: list[Node] = []
    for root in roots:
        stack = [(root, 0)]
        while stack:
            index, done = stack.pop()
            if index in order:
                continue
            children = nodes[index].children
            if done < len(children):
                stack.append((index, done + 1))
                stack.append((children[done], 0))
                continue
            order[index] = len(kept)
            node = nodes[index]
            kept.append(Node(node.op, tuple(order[c] for c in children), node.value, node.interval))
    return tuple(kept), order
