"""Why a requirement has its value, in one line.

In: the deciding predicate and its operands at the deciding sample. Out: "d_obs = 0, needs >= 1".
Numbers are cut to six digits unless that would hide which side of the bound the value is on.
"""

import operator
from collections.abc import Callable, Sequence

from stlspec.compiler.ir import COMPARISONS, Node
from stlspec.compiler.printing import expression_text, number_text, short_text
from stlspec.compiler.rates import Written
from stlspec.semantics.robustness import evaluate_nodes
from stlspec.traces import Trace

VACUOUS = "no sample in its window"
CONSTANT = "it is constant"

_COMPLEMENT = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
_MIRROR = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
_COMPARE: dict[str, Callable[[float, float], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def reason_text(
    nodes: Sequence[Node], predicate: int, negated: bool, trace: Trace, sample: int, written: Written | None = None
) -> str:
    """Say what a predicate's operands are at a sample, and what is needed of them.

    Not in the paper: it serves the reports.

    Args:    nodes: the DAG. predicate: a comparison or a Boolean signal. negated: it must be false for the
             requirement to hold. trace: one trace. sample: the deciding one. written: the unit in which values
             are shown; None = that of the engine, without a word.
    Returns: such as "d_obs = 0, needs >= 1", "x = 3, needs > y = 2", "in_a is false, needs true".
    """
    node = nodes[predicate]
    if node.op == "bool":
        return reason_of(nodes, predicate, negated, [float(trace.signals[str(node.value)][sample])])
    values = evaluate_nodes(nodes, node.children, trace)
    return reason_of(nodes, predicate, negated, [float(v[sample]) for v in values], written)


def reason_of(
    nodes: Sequence[Node], predicate: int, negated: bool, values: Sequence[float], written: Written | None = None
) -> str:
    """Say what `reason_text` says, from the values of a predicate's operands, or of a Boolean signal, at the sample.

    Not in the paper: it serves the reports.
    """
    node = nodes[predicate]
    if node.op == "bool":
        return f"{node.value} is {_truth(bool(values[0]))}, needs {_truth(not negated)}"
    left, right = values
    sign = COMPARISONS[node.op]
    if written is not None and _COMPARE[sign](*map(written.of, values)) != _COMPARE[sign](left, right):
        written = None  # rounding would change which side of the bound the value is on
    sides = (_Side(nodes, node.children[0], left, written), _Side(nodes, node.children[1], right, written))
    if sides[0].constant and not sides[1].constant:
        sides, sign = (sides[1], sides[0]), _MIRROR[sign]
    exact = not _same_side(sign, sides[0].value, sides[1].value)
    needed = _COMPLEMENT[sign] if negated else sign
    return f"{sides[0].text(exact)}, needs {needed} {sides[1].text(exact)}"


class _Side:
    """One side of a comparison: its text and its value at the sample."""

    def __init__(self, nodes: Sequence[Node], index: int, value: float, written: Written | None) -> None:
        self.constant = nodes[index].op == "const"
        self.value = value if written is None else written.of(value)
        self._written = written
        self._name = expression_text(nodes, index)

    def text(self, exact: bool) -> str:
        number = number_text(self.value) if exact else short_text(self.value)
        if self._written is not None:
            number = self._written.text(number)
        return number if self.constant else f"{self._name} = {number}"


def _same_side(sign: str, left: float, right: float) -> bool:
    """Say whether the shortened numbers still stand in the same relation."""
    shortened = _COMPARE[sign](float(short_text(left)), float(short_text(right)))
    return shortened == _COMPARE[sign](left, right)


def _truth(value: bool) -> str:
    return "true" if value else "false"
