"""Between which values an expression or the robustness of a formula lies on every trace.

In: the checked model: declared ranges of signals, values of params. Out: (low, high), infinite where nothing is known.
The enclosure is sound, not tight: a signal that occurs twice counts as two. It serves what can be told of a spec
without any data.
"""

import math
from collections.abc import Mapping, Sequence

from stlspec.compiler.model import Instance, Model
from stlspec.compiler.quantities import SAME, conversion
from stlspec.lang.nodes import (
    Call,
    Expression,
    Group,
    Index,
    Infix,
    Name,
    Operator,
    Prefix,
    Truth,
    children,
    post_order,
)

Extent = tuple[float, float]
ANY: Extent = (-math.inf, math.inf)
_CHAINED = frozenset({"lt", "le", "gt", "ge", "eq", "ne"})


class Extents:
    """The extents of the expressions of one model; those of lets are worked out once, in their order."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._lets: dict[str, Extent] = {}
        self._instances: dict[tuple[int, tuple[Extent, ...]], Extent] = {}
        for name in model.let_order:
            let = model.declared.lets[name]
            if not let.arguments:
                self._lets[name] = self.of(let.body)

    def of(self, root: Expression, at: "Model | Instance | None" = None, given: Mapping[str, Extent] = {}) -> Extent:
        """Return the extent of an expression of the spec; `at` and `given` are for the bodies of templates."""
        found: dict[int, Extent] = {}
        for node in post_order(root):
            below = [found[id(child)] for child in children(node)]
            found[id(node)] = self._node(node, below, at or self._model, given)
        return found[id(root)]

    def _node(
        self, node: Expression, below: list[Extent], at: "Model | Instance", given: Mapping[str, Extent]
    ) -> Extent:
        typing = at.typings.get(id(node))
        if typing is None or typing.kind == "broken":
            return ANY
        if typing.kind == "real" and typing.value is not None:
            return (typing.value, typing.value)
        match node:
            case Truth(_, value):
                return (math.inf, math.inf) if value else (-math.inf, -math.inf)
            case Name(_, text):
                return self._name(text, given)
            case Index(_, name, _):
                return self._name(name.text, given)
            case Group():
                return below[0]
            case Call():
                return self._call(node, below, at)
            case Prefix(_, operator, _):
                return _prefix(operator, below[0], _may_be_empty(operator, at))
            case Infix():
                return self._infix(node, below, at)
        return ANY

    def _name(self, name: str, given: Mapping[str, Extent]) -> Extent:
        if name in given:
            return given[name]
        signal = self._model.signals.get(name)
        if signal is not None and signal.type == "real":
            low, high = signal.low, signal.high
            return (-math.inf if low is None else low, math.inf if high is None else high)
        return self._lets.get(name, ANY)

    def _call(self, node: Call, below: list[Extent], at: "Model | Instance") -> Extent:
        instance = at.calls.get(id(node))
        if instance is not None:
            key = (id(instance), tuple(below))
            if key not in self._instances:
                names = [argument.text for argument in instance.template.arguments]
                given = dict(zip(names, below, strict=True))
                self._instances[key] = self.of(instance.template.body, instance, given)
            return self._instances[key]
        if not _in_one_unit(node.arguments, at):
            return ANY
        match node.function.text:
            case "abs":
                return _absolute(below[0])
            case "min":
                return (min(low for low, _ in below), min(high for _, high in below))
            case "max":
                return (max(low for low, _ in below), max(high for _, high in below))
        return ANY

    def _infix(self, node: Infix, below: list[Extent], at: "Model | Instance") -> Extent:
        word = node.operators[0].word
        if word in _CHAINED or word in ("add", "sub"):
            if not _in_one_unit(node.operands, at):
                return ANY
            if word in _CHAINED:
                pairs = zip(node.operators, below, below[1:], strict=False)
                return _meet([_comparison(operator.word, left, right) for operator, left, right in pairs])
        if word in ("and", "or"):
            return _meet(below) if word == "and" else _join(below)
        result = below[0]
        for operator, right in zip(node.operators, below[1:], strict=True):
            result = _joined(operator, result, right, _may_be_empty(operator, at))
        return result


def _in_one_unit(nodes: Sequence[Expression], at: "Model | Instance") -> bool:
    """Tell whether operands are joined without a conversion."""
    units = [
        typing.unit for node in nodes if (typing := at.typings.get(id(node))) is not None and typing.unit is not None
    ]
    return all(conversion(unit, units[0]) == SAME for unit in units[1:])


def _may_be_empty(operator: Operator, at: "Model | Instance") -> bool:
    """Tell whether the window of an operator may hold no sample: one that begins at 0 holds the sample at hand."""
    if operator.word in ("next", "prev", "wnext", "wprev"):
        return True
    if operator.interval is None:
        return False
    ticks = at.intervals.get(id(operator.interval))
    return ticks is None or ticks[0] > 0


def _absolute(extent: Extent) -> Extent:
    low, high = extent
    return (0.0 if low <= 0 <= high else min(abs(low), abs(high)), max(abs(low), abs(high)))


def _meet(parts: Sequence[Extent]) -> Extent:
    return (min(low for low, _ in parts), min(high for _, high in parts))


def _join(parts: Sequence[Extent]) -> Extent:
    return (max(low for low, _ in parts), max(high for _, high in parts))


def _negated(extent: Extent) -> Extent:
    return (-extent[1], -extent[0])


def _sum(left: Extent, right: Extent) -> Extent:
    low, high = left[0] + right[0], left[1] + right[1]
    return (-math.inf if math.isnan(low) else low, math.inf if math.isnan(high) else high)


def _product(left: Extent, right: Extent) -> Extent:
    ends = [a * b for a in left for b in right]
    return ANY if any(math.isnan(end) for end in ends) else (min(ends), max(ends))


def _comparison(word: str, left: Extent, right: Extent) -> Extent:
    difference = _sum(left, _negated(right))
    if word in ("lt", "le"):
        return _negated(difference)
    if word in ("eq", "ne"):
        distance = _absolute(difference)
        return distance if word == "ne" else _negated(distance)
    return difference


def _prefix(operator: Operator, operand: Extent, may_be_empty: bool) -> Extent:
    low, high = operand
    match operator.word:
        case "neg" | "not":
            return _negated(operand)
        case "always" | "historically" | "wnext" | "wprev":
            return (low, math.inf if may_be_empty else high)
    return (-math.inf if may_be_empty else low, high)


def _joined(operator: Operator, left: Extent, right: Extent, may_be_empty: bool) -> Extent:
    match operator.word:
        case "add":
            return _sum(left, right)
        case "sub":
            return _sum(left, _negated(right))
        case "mul":
            return _product(left, right)
        case "div":
            low, high = right
            return ANY if low <= 0 <= high else _product(left, (1 / high, 1 / low))
        case "implies":
            return _join([_negated(left), right])
        case "until" | "since":
            # The window holds the sample at hand, where the right side alone decides; else it may be empty.
            return (-math.inf if may_be_empty else right[0], right[1])
    return ANY
