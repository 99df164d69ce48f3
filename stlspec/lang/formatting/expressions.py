"""Formulas and arithmetic as documents.

In: an expression and its source. Out: a `Doc` in canonical spelling. The brackets that the author wrote stay,
doubled ones become single, and brackets are added where other tools read an unbracketed mix in another way
(`G a & b`, `a & b -> c`), so that the canonical text means the same everywhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from stlspec.lang.formatting.layout import LINE, SOFT, Doc, Fold, Indent, Leaf
from stlspec.lang.formatting.places import Places
from stlspec.lang.nodes import (
    Call,
    Expression,
    Group,
    Index,
    Infinity,
    Infix,
    Interval,
    Name,
    Number,
    Operator,
    Prefix,
    Truth,
    bounds,
    children,
)
from stlspec.source import Span

SIGNS = {
    "lt": "<",
    "le": "<=",
    "gt": ">",
    "ge": ">=",
    "eq": "==",
    "ne": "!=",
    "assign": "=",
    "add": "+",
    "sub": "-",
    "mul": "*",
    "div": "/",
    "pow": "**",
    "neg": "-",
}
"""Operators that are signs; every other is spelled as its rule is named."""
LOGIC = frozenset({"and", "or", "xor", "implies", "iff", "until", "since", "unless", "release"})
COMPARISONS = frozenset({"lt", "le", "gt", "ge", "eq", "ne", "assign"})
NOW, HABIT = "now", "t"


def bare(node: Expression) -> Expression:
    """Return what stands inside the round brackets around `node`."""
    while isinstance(node, Group):
        node = node.inner
    return node


def reads_as_name(node: Index) -> bool:
    """Tell whether `node` is `x[t]`, and so reads as `x` where nothing declares `t`."""
    return isinstance(node.index, Name) and node.index.text == HABIT != node.name.text


def needs_brackets(parent: Expression, child: Expression, *, last: bool) -> bool:
    """Tell whether brackets are written around `child`, which has none, because tools disagree without them.

    last: nothing of `parent` follows the child.
    """
    if isinstance(parent, Prefix):
        word = parent.operator.word
        if word == "neg":
            return isinstance(child, Prefix) and child.operator.word == "neg"
        return isinstance(child, Infix) and child.operators[0].word in COMPARISONS
    if not isinstance(parent, Infix) or parent.operators[0].word not in LOGIC:
        return False
    if isinstance(child, Infix):
        return child.operators[0].word in LOGIC
    # The last operand swallows nothing, but stands bracketed beside others that are.
    return _reaches_on(child) and not (last and not any(_reaches_on(bare(x)) for x in parent.operands[:-1]))


def tools_disagree(parent: Expression, child: Expression, *, last: bool) -> bool:
    """Tell whether `child` of `parent`, written without brackets, is read in another way by other tools.

    Of what `needs_brackets` is true of, comparisons under an operator, `and` under `or`, and a temporal operator
    behind which nothing follows are read alike.
    """
    if not isinstance(parent, Infix) or not needs_brackets(parent, child, last=last):
        return False
    if not isinstance(child, Infix):
        return not last
    if not last and _ends_open(child):
        return True
    return not (child.operators[0].word == "and" and parent.operators[0].word == "or")


def _ends_open(node: Expression) -> bool:
    """Tell whether the last operand begins with a temporal operator: `p and always q`."""
    while isinstance(node, Infix):
        node = node.operands[-1]
    return _reaches_on(node)


def _reaches_on(node: Expression) -> bool:
    """Tell whether `node` begins with a temporal operator, which in other tools may cover what follows."""
    while isinstance(node, Prefix):
        if node.operator.word not in ("not", "neg"):
            return True
        node = node.operand
    return False


@dataclass(frozen=True, slots=True)
class Expressions:
    """Makes documents of the expressions of one text."""

    places: Places
    habit: bool
    """Whether `t` is declared nowhere, so that `x[t]` reads as `x`, and `t` as `now`."""

    def doc(self, root: Expression) -> Doc:
        """Return the document of an expression; deep trees need no deep stack."""
        order: list[Expression] = []
        pending = [root]
        while pending:
            node = pending.pop()
            order.append(node)
            pending += (*children(node), *bounds(node))
        docs: dict[int, Doc] = {}
        for node in reversed(order):
            docs[id(node)] = self._made(node, docs)
        return docs[id(root)]

    def _made(self, node: Expression, docs: dict[int, Doc]) -> Doc:
        match node:
            case Name(span, text):
                return Leaf(NOW if self.habit and text == HABIT else text, span.start)
            case Number():
                return self.number(node)
            case Truth(span, value):
                return Leaf("true" if value else "false", span.start)
            case Infinity(span):
                return Leaf("inf", span.start)
            case Group(span, inner):
                return self._bracketed(docs[id(bare(inner))], span)
            case Prefix(span, operator, operand):
                return self._prefix(operator, self._operand(node, operand, docs, last=True), docs)
            case Infix():
                return self._infix(node, docs)
            case Call(span, function, arguments):
                parts = [docs[id(argument)] for argument in arguments]
                name = Leaf(function.text, function.span.start)
                return Fold((name, listed("(", parts, Leaf(")", span.end - 1))), span.start, span.end)
            case Index(span, name, index):
                return self._index(node, docs[id(index)])
        raise AssertionError(node)

    def number(self, node: Number) -> Leaf:
        """Return a number as written, its unit behind one blank."""
        end = node.unit.span.start if node.unit else node.span.end
        digits = "".join(self.places.words(Span(node.span.start, end)))
        return Leaf(f"{digits} {node.unit.text}" if node.unit else digits, node.span.start)

    def interval(self, node: Interval, low: Doc, high: Doc) -> Doc:
        """Return an interval in square brackets."""
        inner = listed(Leaf("[", node.span.start), (low, high), Leaf("]", node.span.end - 1))
        return Fold(inner, node.span.start, node.span.end)

    def _operator(self, operator: Operator, docs: dict[int, Doc]) -> Doc:
        word = Leaf(SIGNS.get(operator.word, operator.word), operator.span.start)
        between = operator.interval
        if between is None:
            return word
        return (word, self.interval(between, docs[id(between.low)], docs[id(between.high)]))

    def _operand(self, parent: Expression, child: Expression, docs: dict[int, Doc], *, last: bool) -> Doc:
        doc = docs[id(child)]
        if not needs_brackets(parent, child, last=last):
            return doc
        inside: Doc = (Leaf("(", child.span.start), Indent((SOFT, doc)), SOFT, ")")
        return Fold(inside, child.span.start, child.span.end)

    def _bracketed(self, inner: Doc, span: Span) -> Doc:
        inside: Doc = (Leaf("(", span.start), Indent((SOFT, inner)), SOFT, Leaf(")", span.end - 1))
        return Fold(inside, span.start, span.end)

    def _prefix(self, operator: Operator, operand: Doc, docs: dict[int, Doc]) -> Doc:
        gap = "" if operator.word == "neg" else " "
        return (self._operator(operator, docs), gap, operand)

    def _infix(self, node: Infix, docs: dict[int, Doc]) -> Doc:
        logic = node.operators[0].word in LOGIC
        count = len(node.operands)
        operands = [self._operand(node, x, docs, last=i == count - 1) for i, x in enumerate(node.operands)]
        more: list[Doc] = []
        for operator, operand in zip(node.operators, operands[1:], strict=True):
            more += [LINE, self._operator(operator, docs), " ", operand]
        tail: Doc = tuple(more) if logic else Indent(tuple(more))
        return Fold((operands[0], tail), node.span.start, node.span.end)

    def _index(self, node: Index, index: Doc) -> Doc:
        name = Leaf(node.name.text, node.name.span.start)
        if not (self.habit and reads_as_name(node)):
            return (name, "[", index, Leaf("]", node.span.end - 1))
        if not self.places.has_comment(node.span):
            return name
        # A comment inside would lose its place.
        return (name, "[", Leaf(HABIT, node.index.span.start), Leaf("]", node.span.end - 1))


def listed(opening: Doc, parts: Sequence[Doc], closing: Doc) -> Doc:
    """Return parts in brackets, with commas; where it breaks, each begins a line."""
    inner: list[Doc] = [SOFT]
    for i, part in enumerate(parts):
        inner += [",", LINE] if i else []
        inner.append(part)
    return (opening, Indent(tuple(inner)), SOFT, closing)
