"""Between which values an expression or the robustness of a formula lies on every trace.

In: the checked model: declared ranges of signals, values of params. Out: (low, high), infinite where nothing is known.
The enclosure is sound, not tight: a signal that occurs twice counts as two. It serves what can be told of a spec
without any data.
"""

from collections.abc import Mapping, Sequence

from stlspec.compiler.model import Instance, Model
from stlspec.compiler.quantities import SAME, conversion
from stlspec.compiler.ranges import INF, WHOLE, Range, image
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

_CHAINED = frozenset({"lt", "le", "gt", "ge", "eq", "ne"})


class Extents:
    """The extents of the expressions of one model; those of lets are worked out once, in their order."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._lets: dict[str, Range] = {}
        self._instances: dict[tuple[int, tuple[Range, ...]], Range] = {}
        for name in model.let_order:
            let = model.declared.lets[name]
            if not let.arguments:
                self._lets[name] = self.of(let.body)

    def of(self, root: Expression, at: "Model | Instance | None" = None, given: Mapping[str, Range] = {}) -> Range:
        """Return the extent of an expression of the spec; `at` and `given` are for the bodies of templates."""
        found: dict[int, Range] = {}
        for node in post_order(root):
            below = [found[id(child)] for child in children(node)]
            found[id(node)] = self._node(node, below, at or self._model, given)
        return found[id(root)]

    def _node(self, node: Expression, below: list[Range], at: "Model | Instance", given: Mapping[str, Range]) -> Range:
        typing = at.typings.get(id(node))
        if typing is None or typing.kind == "broken":
            return WHOLE
        if typing.kind == "real" and typing.value is not None:
            return (typing.value, typing.value)
        match node:
            case Truth(_, value):
                return (INF, INF) if value else (-INF, -INF)
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
        return WHOLE

    def _name(self, name: str, given: Mapping[str, Range]) -> Range:
        if name in given:
            return given[name]
        signal = self._model.signals.get(name)
        if signal is not None and signal.type == "real":
            low, high = signal.low, signal.high
            return (-INF if low is None else low, INF if high is None else high)
        return self._lets.get(name, WHOLE)

    def _call(self, node: Call, below: list[Range], at: "Model | Instance") -> Range:
        instance = at.calls.get(id(node))
        if instance is not None:
            key = (id(instance), tuple(below))
            if key not in self._instances:
                names = [argument.text for argument in instance.template.arguments]
                given = dict(zip(names, below, strict=True))
                self._instances[key] = self.of(instance.template.body, instance, given)
            return self._instances[key]
        if not _in_one_unit(node.arguments, at):
            return WHOLE
        return image(node.function.text, below)

    def _infix(self, node: Infix, below: list[Range], at: "Model | Instance") -> Range:
        word = node.operators[0].word
        if word in _CHAINED or word in ("add", "sub"):
            if not _in_one_unit(node.operands, at):
                return WHOLE
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


def _meet(parts: Sequence[Range]) -> Range:
    return image("min", parts)


def _join(parts: Sequence[Range]) -> Range:
    return image("max", parts)


def _negated(extent: Range) -> Range:
    return image("neg", [extent])


def _comparison(word: str, left: Range, right: Range) -> Range:
    difference = image("sub", [left, right])
    if word in ("lt", "le"):
        return _negated(difference)
    if word in ("eq", "ne"):
        distance = image("abs", [difference])
        return distance if word == "ne" else _negated(distance)
    return difference


def _prefix(operator: Operator, operand: Range, may_be_empty: bool) -> Range:
    low, high = operand
    match operator.word:
        case "neg" | "not":
            return _negated(operand)
        case "always" | "historically" | "wnext" | "wprev":
            return (low, INF if may_be_empty else high)
    return (-INF if may_be_empty else low, high)


def _joined(operator: Operator, left: Range, right: Range, may_be_empty: bool) -> Range:
    match operator.word:
        case "implies":
            return _join([_negated(left), right])
        case "until" | "since":
            # The window holds the sample at hand, where the right side alone decides; else it may be empty.
            return (-INF if may_be_empty else right[0], right[1])
    return image(operator.word, [left, right])
