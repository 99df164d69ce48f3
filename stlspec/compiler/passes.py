"""Optimiser passes: cheaper formulas with the same values, bit for bit.

In: the DAG, its roots, how the samples are spaced. Out: another DAG and its roots. The passes run when a
trace is evaluated, not when a spec is compiled, because window fusion depends on the spacing of the samples
and every pass on the laws of the algebra; the bundle and its hashes keep the formulas as they were written,
and so do witnesses and explanations.

There is no pass for flattening `and` and `or`: n operands take n - 1 minima either way. Sharing is no pass of
its own: each pass builds its nodes anew with `Builder`, which makes equal ones once.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from stlspec.compiler.ir import REAL, Builder, Interval, Node, reachable

Law = Literal["absorbing", "de_morgan", "distributive", "idempotent", "lattice", "monotone", "selective"]
"""What an algebra may declare of its ⊕ and ⊗, both of which are associative, with neutral ⊥ and ⊤.

absorbing: ⊤ ⊕ x = ⊤ and ⊥ ⊗ x = ⊥. de_morgan: negation swaps ⊕ and ⊗, ⊤ and ⊥, and a predicate with its
complement. distributive: ⊗ over ⊕. idempotent: x ⊕ x = x ⊗ x = x. monotone: greater operands never give a
lesser result. selective: a result is one of the operands. lattice: ⊕ is max, ⊗ is min.
"""
Formulas = tuple[tuple[Node, ...], tuple[int, ...]]
"""A DAG, children first, and the indices of its roots."""


@dataclass(frozen=True, slots=True)
class Pass:
    """One pass. laws: what the algebra must fulfil. run: takes nodes, roots and the spacing in ticks or None."""

    name: str
    laws: frozenset[Law]
    run: Callable[[Sequence[Node], Sequence[int], int | None], Formulas]


def optimised(nodes: Sequence[Node], roots: Sequence[int], laws: frozenset[Law], spacing: int | None) -> Formulas:
    """Run all passes whose laws hold.

    Not in the paper: it changes no value.

    Args:    nodes: the DAG. roots: of the wanted formulas. laws: that the algebra fulfils. spacing: ticks between
             samples if these are all the same, else None.
    Returns: nodes and roots with the same value at every sample, or the same diagnostic.
    """
    return _optimised(_Same(nodes), tuple(roots), laws, spacing)


class _Same:
    """Nodes as a key that is compared by identity: hashing a DAG takes longer than evaluating a short trace."""

    __slots__ = ("nodes",)

    def __init__(self, nodes: Sequence[Node]) -> None:
        self.nodes = nodes

    def __hash__(self) -> int:
        return id(self.nodes)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.nodes is other.nodes


@lru_cache(maxsize=64)
def _optimised(key: _Same, roots: tuple[int, ...], laws: frozenset[Law], spacing: int | None) -> Formulas:
    formulas = tuple(key.nodes), roots
    for one in PASSES:
        if one.laws <= laws:
            formulas = one.run(*formulas, spacing)
    return formulas


def fold_constants(nodes: Sequence[Node], roots: Sequence[int], spacing: int | None) -> Formulas:  # noqa: ARG001
    """Do away with `true` and `false` as operands; `true until q` becomes `eventually q`.

    A formula that may turn out to have no value at some sample (0 / 0) is never dropped, for that is reported.
    """
    builder, new, total = Builder(), list[int](), list[bool]()
    for node in nodes:
        children = [new[c] for c in node.children]
        total.append(node.op not in PARTIAL and all(total[c] for c in node.children))
        certain = {new[c] for c in node.children if total[c]}
        new.append(_folded(builder, node, children, certain))
    return _finished(builder, new, roots)


PARTIAL = frozenset("add sub mul div pow sqrt log sin cos delta rate".split())
"""Real operators that may have no value."""
_OPPOSITES = (
    *(("and", "or"), ("true", "false"), ("always", "eventually"), ("historically", "once")),
    *(("lt", "ge"), ("le", "gt"), ("eq", "ne")),
)
_DUAL = {a: b for one, other in _OPPOSITES for a, b in ((one, other), (other, one))}
_NEUTRAL = {
    op: ("true", "false") if op in ("and", "always", "historically") else ("false", "true")
    for op in ("and", "or", "always", "eventually", "historically", "once")
}
"""Of the operators that fold with ⊗ or ⊕: the neutral operand, and the one that decides."""
_WINDOWS = _NEUTRAL.keys() - {"and", "or"}
_REACHES = {"until": "eventually", "since": "once"}


def _folded(builder: Builder, node: Node, children: list[int], certain: set[int]) -> int:
    """Add a node whose operands may be constants. certain: the operands that always have a value."""
    ops = [builder.nodes[c].op for c in children]
    if node.op == "not" and ops[0] in ("true", "false"):
        return builder.add(_DUAL[ops[0]])
    if node.op in ("and", "or"):
        neutral, decisive = _NEUTRAL[node.op]
        if decisive in ops and certain.issuperset(children):
            return builder.add(decisive)
        children = [c for c, op in zip(children, ops, strict=True) if op != neutral]
        if len(children) < 2:
            return children[0] if children else builder.add(neutral)
    elif node.op in _WINDOWS and node.interval is not None:
        neutral, other = _NEUTRAL[node.op]
        # A window that begins at the sample itself is never empty.
        if ops[0] == neutral or (ops[0] == other and node.interval[0] == 0):
            return builder.add(ops[0])
    elif node.op in _REACHES and node.interval is not None:
        found = _folded_until(builder, node.op, node.interval, children, certain)
        if found is not None:
            return found
    elif node.op in ("next", "prev") and ops[0] == "false":
        return children[0]
    return builder.add(node.op, children, node.value, node.interval)


def _folded_until(
    builder: Builder, op: str, interval: Interval, children: Sequence[int], certain: set[int]
) -> int | None:
    left, right = children
    ops = (builder.nodes[left].op, builder.nodes[right].op)
    if ops[1] == "false" and left in certain:
        return right
    if interval[0] == 0 and (ops[0] == "false" or (ops[1] == "true" and left in certain)):
        return right
    if ops[0] == "true":
        return builder.add(_REACHES[op], [right], interval=interval)
    return None


def push_negations(nodes: Sequence[Node], roots: Sequence[int], spacing: int | None) -> Formulas:  # noqa: ARG001
    """Push `not` down to comparisons where it vanishes: not (x > 1) becomes x <= 1.

    The value stays the same to the bit, since rounding is symmetric, and so does the tie, since a comparison
    and its complement do not both hold on the bound. Formulas that are used twice are left alone: both signs
    would have to be computed.
    """
    uses = Counter(c for node in nodes for c in node.children)
    uses.update(roots)
    absorbs: list[bool] = []
    for index, node in enumerate(nodes):
        free = node.op == "not" or (
            node.op in _DUAL and all(absorbs[c] for c in node.children if _is_formula(nodes, c))
        )
        absorbs.append(free and uses[index] == 1)
    flipped, gone = set[int](), set[int]()
    for index in range(len(nodes) - 1, -1, -1):
        node = nodes[index]
        if index in flipped:
            if node.op != "not":
                flipped.update(c for c in node.children if _is_formula(nodes, c))
        elif node.op == "not" and absorbs[node.children[0]]:
            gone.add(index)
            flipped.add(node.children[0])
    builder, new = Builder(), list[int]()
    for index, node in enumerate(nodes):
        children = [new[c] for c in node.children]
        if index in gone or (index in flipped and node.op == "not"):
            new.append(children[0])
        else:
            op = _DUAL[node.op] if index in flipped else node.op
            new.append(builder.add(op, children, node.value, node.interval))
    return _finished(builder, new, roots)


def _is_formula(nodes: Sequence[Node], index: int) -> bool:
    return nodes[index].op not in REAL


def fuse_windows(nodes: Sequence[Node], roots: Sequence[int], spacing: int | None) -> Formulas:
    """Make one window of two: always[a,b] always[c,d] p becomes always[a+c, b+d] p.

    With even spacing, in whole samples: the windows of neighbours that the outer one holds overlap or touch
    (c <= d), so their union has no hole; where the end of the trace cuts off the outer window, the window of
    the last sample in it reaches that end, as the fused one does; and where the outer one is empty, so is the
    fused one. An interval that holds no whole number of samples (a > b) is left alone. With uneven spacing
    the union may have holes, and a far sample may have no sample between to reach it from, so two windows are
    fused only if one has no end and the other one begins at the sample itself.
    """
    builder, new = Builder(), list[int]()
    for node in nodes:
        children, interval = [new[c] for c in node.children], node.interval
        if node.op in _WINDOWS and interval is not None:
            below = builder.nodes[children[0]]
            if below.op == node.op and below.interval is not None:
                fused = _fused(interval, below.interval, spacing)
                children, interval = (list(below.children), fused) if fused else (children, interval)
        new.append(builder.add(node.op, children, node.value, interval))
    return _finished(builder, new, roots)


def _fused(outer: Interval, inner: Interval, spacing: int | None) -> Interval | None:
    """Return the interval of the fused window, None if there is none."""
    if spacing is None:
        if outer[1] is None and inner[0] == 0:
            return outer
        return inner if inner[1] is None and outer[0] == 0 else None
    (a, b), (c, d) = ((-(-low // spacing), None if high is None else high // spacing) for low, high in (outer, inner))
    if (b is not None and b < a) or (d is not None and d < c):
        return None
    return (a + c) * spacing, None if b is None or d is None else (b + d) * spacing


def _finished(builder: Builder, new: Sequence[int], roots: Sequence[int]) -> Formulas:
    nodes, order = reachable(builder.nodes, [new[r] for r in roots])
    return nodes, tuple(order[new[r]] for r in roots)


PASSES = (
    Pass("fold constants", frozenset({"absorbing"}), fold_constants),
    Pass("push negations", frozenset({"de_morgan"}), push_negations),
    Pass("fuse windows", frozenset({"idempotent"}), fuse_windows),
)
"""In the order in which they run: negations come first, for they hide windows from each other."""
