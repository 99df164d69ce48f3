"""From the checked model to the bundle: formulas become nodes of the DAG, derived operators their definitions.

In: a `Model` without errors whose params are bound. Out: `BundleData`. Lets are lowered once each, in order,
and every expression bottom-up, so that neither a deep formula nor a chain of a thousand lets needs a deep stack.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import PurePath
from types import MappingProxyType

from stlspec.compiler.bundle import Bounding, BundleData, Requirement, Strength
from stlspec.compiler.constants import FOLDABLE, fold
from stlspec.compiler.dependencies import ancestors, dependency_weights, softmax
from stlspec.compiler.horizon import horizons
from stlspec.compiler.inference import NOW, SAME_UNIT
from stlspec.compiler.ir import Builder, Interval, Node, reachable
from stlspec.compiler.model import Instance, Model
from stlspec.compiler.quantities import SAME, conversion, scaled
from stlspec.lang.nodes import (
    Call,
    Expression,
    Group,
    Index,
    Infinity,
    Infix,
    Name,
    Number,
    Operator,
    Prefix,
    RequirementStatement,
    Truth,
    children,
    post_order,
)
from stlspec.lang.units import Dimension

_UNBOUNDED: Interval = (0, None)
_UNKNOWN: Interval = (1, None)
"""Stands for bounds that a param without a value leaves open, where only a text is judged: it may hold no sample."""
_COMPARISONS = frozenset({"lt", "le", "gt", "ge", "eq", "ne"})


def lower(model: Model) -> BundleData:
    """Make the bundle of a checked model."""
    lowering = _Lowering(model)
    for name in model.let_order:
        let = model.declared.lets[name]
        if not let.arguments:
            lowering.names[name] = lowering.expression(let.body)
    statements = list(model.declared.requirements.values())
    roots = [lowering.expression(statement.formula) for statement in statements]
    nodes, index = reachable(lowering.builder.nodes, roots)
    ahead = horizons(nodes, model.declared.time)
    requirements = tuple(
        _requirement(model, statement, index[root], ahead[index[root]])
        for statement, root in zip(statements, roots, strict=True)
    )
    edges = {r.name: r.depends_on for r in requirements}
    raw = dependency_weights(list(ancestors(edges).values()))
    return BundleData(
        name=model.declared.spec_name,
        title=model.declared.title,
        time=model.declared.time,
        signals=tuple(model.signals.values()),
        params=tuple(model.params.values()),
        requirements=requirements,
        nodes=nodes,
        names=MappingProxyType({name: index[root] for name, root in lowering.names.items() if root in index}),
        raw_weights=raw,
        weights=softmax(raw),
        sources=_sources(model),
    )


def _requirement(model: Model, statement: RequirementStatement, root: int, horizon: int | None) -> Requirement:
    strength: Strength = "hard" if statement.strength == "hard" else "soft"
    bounds: dict[str, Bounding] = {"linear": "linear", "none": "none"}
    return Requirement(
        name=statement.name.text,
        strength=strength,
        root=root,
        depends_on=tuple(dict.fromkeys(n.text for n in statement.depends_on)),
        scale=statement.scale.value if statement.scale else 1.0,
        bound=bounds.get(statement.bound.text, "tanh") if statement.bound else "tanh",
        horizon=horizon,
        doc=statement.doc.text if statement.doc else None,
        text=_one_line(model.source.slice(statement.formula.span)),
    )


def _sources(model: Model) -> tuple[tuple[str, str], ...]:
    """Return the texts of the spec, main file first, the others under their way from the folder of the main file."""
    folder = os.path.dirname(model.source.name) or "."  # noqa: PTH120 - `Path` cannot go up
    others = [(PurePath(os.path.relpath(s.name, folder)).as_posix(), s.text) for s in model.sources[1:]]
    return ((model.source.name, model.source.text), *others)


def _one_line(text: str) -> str:
    """Put a formula on one line, its comments left out."""
    lines = (line.split("#")[0].split("//")[0] for line in text.split("\n"))
    return " ".join(" ".join(lines).split())


@dataclass(frozen=True, slots=True, eq=False)
class Sketch:
    """The formulas of a model as nodes of one DAG, whether or not its params have values.

    An open param is a `signal` node: what holds for all its values holds for any. made: the node of each expression
    outside templates, by its `id`. roots: by requirement. open: the nodes in which an interval is left open by a
    param; undecided: those whose own interval is.
    """

    nodes: tuple[Node, ...]
    made: Mapping[int, int]
    roots: Mapping[str, int]
    open: frozenset[int]
    undecided: frozenset[int]


def sketch(model: Model) -> Sketch:
    """Lower a checked model for analysis. Not in the paper: lints look at formulas before params are bound."""
    lowering = _Lowering(model)
    for name in model.let_order:
        let = model.declared.lets[name]
        if not let.arguments:
            lowering.names[name] = lowering.expression(let.body)
    roots = {name: lowering.expression(r.formula) for name, r in model.declared.requirements.items()}
    nodes, undecided = tuple(lowering.builder.nodes), frozenset(lowering.undecided)
    reached = set(undecided)
    for index, node in enumerate(nodes):
        if not reached.isdisjoint(node.children):
            reached.add(index)
    return Sketch(nodes, lowering.made, roots, frozenset(reached), undecided)


class _Lowering:
    """Makes nodes of the DAG from expressions.

    made: the node of each expression at hand. names: of each let so far. at: where typings are found, the model or
    the instance of a template whose body is lowered; arguments: the nodes that its arguments are.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.builder = Builder()
        self.names: dict[str, int] = {}
        self.made: dict[int, int] = {}
        self.at: Model | Instance = model
        self.arguments: Mapping[str, int] = {}
        self.undecided: set[int] = set()
        """The nodes whose bounds have no value."""
        self._instances: dict[int, int] = {}

    def expression(self, root: Expression) -> int:
        """Lower `root`."""
        for node in post_order(root):
            self.made[id(node)] = self._node(node, [self.made[id(child)] for child in children(node)])
        return self.made[id(root)]

    def _node(self, node: Expression, below: list[int]) -> int:
        match node:
            case Number():
                return self._constant(node.value)
            case Infinity():
                return self._constant(float("inf"))
            case Truth():
                return self.builder.add("true" if node.value else "false")
            case Name():
                return self._name(node.text)
            case Index():
                return self._name(node.name.text)
            case Group():
                return below[0]
            case Call():
                return self._call(node, below)
            case Prefix():
                return self._prefix(node.operator, below[0])
            case Infix():
                return self._infix(node, below)

    def _constant(self, value: float) -> int:
        return self.builder.add("const", value=value)

    def _name(self, name: str) -> int:
        if name in self.arguments:
            return self.arguments[name]
        if name in self.model.params:
            return self._constant(self.model.params[name].value)
        if name in self.names:
            return self.names[name]
        signal = self.model.signals.get(name)
        if name in self.model.declared.params:
            return self.builder.add("signal", value=name)
        if signal is None:
            assert name in NOW
            return self.builder.add("now")
        return self.builder.add("bool" if signal.type == "bool" else "signal", value=name)

    def _real(self, op: str, operands: Sequence[int]) -> int:
        """Add a real operator, or the constant that it comes to."""
        values = [self.builder.nodes[i].value for i in operands if self.builder.nodes[i].op == "const"]
        if len(values) == len(operands) and op in FOLDABLE:
            return self._constant(fold(op, [float(v) for v in values if v is not None]))
        return self.builder.add(op, operands)

    def _converted(self, expressions: Sequence[Expression], made: Sequence[int]) -> list[int]:
        """Bring operands that are joined to the unit of the first one that has a unit."""
        units = [self.at.typing(e).unit for e in expressions]
        target: Dimension | None = next((u for u in units if u is not None), None)
        factors = [conversion(unit, target) or SAME for unit in units]
        return [self._scaled(i, factor) for i, factor in zip(made, factors, strict=True)]

    def _scaled(self, operand: int, factor: Fraction) -> int:
        """Multiply by a factor; by division where it is below 1, since 0.001 is no binary number."""
        node = self.builder.nodes[operand]
        if node.op == "const" and isinstance(node.value, float):
            return self._constant(scaled(node.value, factor))
        for op, by in (("mul", factor.numerator), ("div", factor.denominator)):
            if by > 1:
                operand = self._real(op, [operand, self._constant(float(by))])
        return operand

    def _call(self, node: Call, below: list[int]) -> int:
        name = node.function.text
        instance = self.at.calls.get(id(node))
        if instance is not None:
            return self._expanded(instance, below)
        if name in SAME_UNIT:
            below = self._converted(node.arguments, below)
        return self._real(name, below)

    def _expanded(self, instance: Instance, arguments: Sequence[int]) -> int:
        """Lower the body of a template, once for each distinct list of arguments."""
        if id(instance) not in self._instances:
            outer = (self.at, self.arguments, self.made)
            names = [argument.text for argument in instance.template.arguments]
            self.at, self.arguments, self.made = instance, dict(zip(names, arguments, strict=True)), {}
            self._instances[id(instance)] = self.expression(instance.template.body)
            self.at, self.arguments, self.made = outer
        return self._instances[id(instance)]

    def _interval(self, operator: Operator) -> Interval:
        if operator.interval is None:
            return _UNBOUNDED
        return self.at.intervals.get(id(operator.interval), _UNKNOWN)

    def _timed(self, word: str, operands: Sequence[int], interval: Interval) -> int:
        """Add an operator with an interval."""
        made = self.builder.add(word, operands, interval=interval)
        if interval is _UNKNOWN:
            self.undecided.add(made)
        return made

    def _not(self, operand: int) -> int:
        below = self.builder.nodes[operand]
        return below.children[0] if below.op == "not" else self.builder.add("not", [operand])

    def _prefix(self, operator: Operator, operand: int) -> int:
        match operator.word:
            case "neg":
                return self._real("neg", [operand])
            case "not":
                return self._not(operand)
            case "next" | "prev":
                return self.builder.add(operator.word, [operand])
            case "wnext" | "wprev":
                return self._not(self.builder.add(operator.word[1:], [self._not(operand)]))
        return self._timed(operator.word, [operand], self._interval(operator))

    def _infix(self, node: Infix, below: list[int]) -> int:
        word = node.operators[0].word
        if word in _COMPARISONS:
            return self._comparison(node, below)
        if word in ("and", "or"):
            return self.builder.add(word, below)
        if word in SAME_UNIT:
            below = self._converted(node.operands, below)
        result = below[0]
        for operator, right in zip(node.operators, below[1:], strict=True):
            result = self._joined(operator, result, right)
        return result

    def _comparison(self, node: Infix, below: list[int]) -> int:
        below = self._converted(node.operands, below)
        parts = [
            self.builder.add(operator.word, [left, right])
            for operator, left, right in zip(node.operators, below, below[1:], strict=False)
        ]
        return parts[0] if len(parts) == 1 else self.builder.add("and", parts)

    def _joined(self, operator: Operator, left: int, right: int) -> int:
        """Join two operands by one operator, derived ones after their definition (see `ir`)."""
        add, word = self.builder.add, operator.word
        match word:
            case "implies":
                return add("or", [self._not(left), right])
            case "iff" | "xor":
                same = add("and", [add("or", [self._not(left), right]), add("or", [self._not(right), left])])
                return same if word == "iff" else self._not(same)
            case "until" | "since":
                return self._timed(word, [left, right], self._interval(operator))
            case "release":
                interval = self._interval(operator)
                return self._not(self._timed("until", [self._not(left), self._not(right)], interval))
            case "unless":
                interval = self._interval(operator)
                until = self._timed("until", [left, right], interval)
                return add("or", [until, add("always", [left], interval=(0, interval[1]))])
        return self._real(word, [left, right])
