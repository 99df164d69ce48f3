"""Formulas of the DAG as text in the language's own notation, for explanations.

In: the nodes, how the spec measures time, the names of its lets. Out: one line for each formula. The derived
operators, which `lower` rewrote by their definitions, are recognised again; a let inside a formula stands
under its name, so that the texts look like what the user wrote. Every text is cut at `printing.LONGEST`.
"""

from collections.abc import Mapping, Sequence

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.ir import COMPARISONS, REAL, Interval, Node
from stlspec.compiler.printing import LONGEST, expression_text, number_text
from stlspec.compiler.rates import Written, comparison_text
from stlspec.lang.units import NANOSECONDS

_LIKE = 0.01
_UNITS = {
    unit: (NANOSECONDS[unit], word)
    for unit, word in {
        "s": "seconds",
        "ms": "milliseconds",
        "us": "microseconds",
        "ns": "nanoseconds",
        "min": "minutes",
        "h": "hours",
    }.items()
}
_BINARY, _PREFIX, _COMPARISON, _NOT, _ATOM = range(5)
_UNBOUNDED: Interval = (0, None)
_Shape = tuple[str, tuple[int, ...], Interval | None]
"""An operator of the language, its operands, its interval."""


def off_period(time: TimeBase, spacing: float) -> str:
    """Return the way out of stamps that do not fit the period: the unit in which they would, if there is one.

    Not in the paper: data.

    Args:    time: with a period. spacing: the shortest time between two stamps, as they are written.
    """
    unit, period = time.unit, time.period or 1
    for other, (length, word) in _UNITS.items():
        if other != unit and abs(spacing * length - period) <= _LIKE * period:
            right = f"{number_text(period / length)} {other}"
            return f"the stamps, {number_text(spacing)} apart, look like {word}: write `time {right}`"
    return f"stamps are read in {unit}: give the period in the unit of the data; for uneven ones write `time {unit}`"


def formula_texts(
    nodes: Sequence[Node],
    root: int,
    time: TimeBase,
    names: Mapping[str, int] | None = None,
    units: Mapping[int, Written] | None = None,
) -> dict[int, str]:
    """Return the text of a formula and of all formulas below it.

    Not in the paper: it serves the explanations.

    Args:    nodes: the DAG, children first. root: a formula. time: in whose unit intervals are written.
             names: the root of each let; a let below a formula is written as its name. units: of comparisons whose
             constants are to be shown in the unit that was written.
    Returns: for each node index one line of at most `LONGEST` characters, cut off with "…".
    """
    named: dict[int, str] = {}
    for name, index in (names or {}).items():
        named.setdefault(index, name)
    texts: dict[int, str] = {}
    ranks: dict[int, int] = {}
    for index in _formulas(nodes, root):
        text, ranks[index] = _text(nodes, index, texts, ranks, named, time)
        if units and index in units:
            sides = [expression_text(nodes, child) for child in nodes[index].children]
            text = comparison_text(nodes[index], nodes, sides, units[index])
        texts[index] = text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"
    return texts


def _formulas(nodes: Sequence[Node], root: int) -> list[int]:
    wanted = {root}
    for index in range(root, -1, -1):
        if index in wanted:
            wanted.update(c for c in nodes[index].children if nodes[c].op not in REAL)
    return sorted(wanted)


def _text(
    nodes: Sequence[Node],
    index: int,
    texts: Mapping[int, str],
    ranks: Mapping[int, int],
    named: Mapping[int, str],
    time: TimeBase,
) -> tuple[str, int]:
    def operand(child: int, least: int) -> str:
        if child in named:
            return named[child]
        return texts[child] if ranks[child] >= least else f"({texts[child]})"

    node = nodes[index]
    if node.op in COMPARISONS:
        return expression_text(nodes, index), _COMPARISON
    if not node.children:
        return str(node.value) if node.op == "bool" else node.op, _ATOM
    word, children, interval = _shape(nodes, index)
    word += _interval_text(interval, time)
    if len(children) > 1:
        # Tools disagree on how tightly these bind, so a mix of them keeps its parentheses.
        least = _NOT if interval is not None else _COMPARISON
        return f" {word} ".join(operand(c, least) for c in children), _BINARY
    if word == "not":
        return f"not {operand(children[0], _NOT)}", _NOT
    child = children[0]
    # A comparison binds tighter than the operator before it, but few readers know.
    least = _ATOM if ranks[child] == _COMPARISON else _PREFIX
    return f"{word} {operand(child, least)}", _PREFIX


def _interval_text(interval: Interval | None, time: TimeBase) -> str:
    if interval is None or interval == _UNBOUNDED:
        return ""
    return f"[{', '.join(ticks_text(bound, time) for bound in interval)}]"


def ticks_text(ticks: int | None, time: TimeBase) -> str:
    """Return a time in ticks as a spec would say it. Not in the paper: for messages."""
    if ticks is None:
        return "inf"
    number = number_text(ticks / time.ticks_per_unit)
    return number if time.kind == "step" or ticks == 0 else f"{number} {time.unit}"


def _shape(nodes: Sequence[Node], index: int) -> _Shape:
    """Return the operator that the user most likely wrote: a derived one where its definition is found."""
    node = nodes[index]
    first = nodes[node.children[0]]
    if node.op == "not" and first.op == "next" and nodes[first.children[0]].op == "not":
        return "wnext", nodes[first.children[0]].children, None
    if node.op == "not" and first.op == "prev" and nodes[first.children[0]].op == "not":
        return "wprev", nodes[first.children[0]].children, None
    if node.op == "not" and first.op == "until" and all(nodes[c].op == "not" for c in first.children):
        left, right = (nodes[c].children[0] for c in first.children)
        return "release", (left, right), first.interval
    if len(node.children) != 2:
        return node.op, node.children, node.interval
    second = nodes[node.children[1]]
    if node.op == "or" and _is_unless(first, second):
        return "unless", first.children, first.interval
    if node.op == "or" and first.op == "not":
        return "implies", (first.children[0], node.children[1]), None
    if node.op == "and" and first.op == second.op == "or":
        sides = _sides(nodes, first), _sides(nodes, second)
        if sides[0] is not None and sides[1] is not None and sides[0] == sides[1][::-1]:
            return "iff", sides[0], None
    return node.op, node.children, node.interval


def _is_unless(first: Node, second: Node) -> bool:
    if first.op != "until" or second.op != "always" or first.children[0] != second.children[0]:
        return False
    return first.interval is not None and second.interval == (0, first.interval[1])


def _sides(nodes: Sequence[Node], node: Node) -> tuple[int, ...] | None:
    """Return the sides of an implication."""
    if len(node.children) != 2 or nodes[node.children[0]].op != "not":
        return None
    return nodes[node.children[0]].children[0], node.children[1]
