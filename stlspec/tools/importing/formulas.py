"""Foreign formulas as nodes of this language's syntax tree, their places those of the foreign text.

In: a cursor and the table of a dialect: its operators with the levels at which they bind. Out: expressions. One
climbing parser serves all dialects, since they differ in levels, spellings and extras, not in kind; brackets are
kept only until `bare`, since the writer puts them where this language needs them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from stlspec.lang.nodes import (
    Call,
    Expression,
    Group,
    Infinity,
    Infix,
    Interval,
    Name,
    Number,
    Operator,
    Prefix,
    Truth,
    post_order,
)
from stlspec.source import Span
from stlspec.tools.importing.tokens import Cursor, Token, number_of

DEEPEST = 100
COMPARISONS = frozenset({"lt", "le", "gt", "ge", "eq", "ne"})
_CHAINS = (frozenset({"and"}), frozenset({"or"}), frozenset({"add", "sub"}), frozenset({"mul", "div"}))
"""Operators of one level that may stand in one chain."""
ARITHMETIC = frozenset({"add", "sub", "mul", "div", "pow", "neg"})


@dataclass(frozen=True, slots=True)
class Binding:
    """An operator: its word in this language, the level at which it binds, that of its (right) operand."""

    word: str
    level: int
    operand: int


@dataclass(frozen=True)
class Dialect:
    """The operators of a tool by their spelling; the higher a level, the tighter.

    assigns: the sign between a name and its formula. intervals: the words that take one. functions: by spelling, the
    word here and the number of arguments.
    special: spellings that are no operator of this language; each takes the cursor and makes an expression.
    """

    tool: str
    assigns: str
    prefixes: Mapping[str, Binding]
    infixes: Mapping[str, Binding]
    functions: Mapping[str, tuple[str, int]]
    truths: Mapping[str, bool]
    intervals: frozenset[str]
    special: "Mapping[str, Callable[[Formulas, Token], Expression]]" = field(default_factory=dict)


class Formulas:
    """Reads formulas; `name` makes an expression of a name, `bound` of a bound of an interval."""

    def __init__(
        self,
        cursor: Cursor,
        dialect: Dialect,
        name: "Callable[[Formulas, Token], Expression]",
        bound: "Callable[[Formulas], Expression]",
    ) -> None:
        self.cursor = cursor
        self.dialect = dialect
        self._name = name
        self._bound = bound
        self._depth = 0

    def formula(self, level: int = 0) -> Expression:
        """Read an expression whose infix operators bind at least at `level`."""
        self._depth += 1
        if self._depth > DEEPEST:
            self.cursor.refuse("S007", self.cursor.token.span, deepest=DEEPEST)
        left, nested = self._primary(), 0
        while nested <= DEEPEST:
            token = self.cursor.token
            binding = self.dialect.infixes.get(token.text) if token.kind in ("word", "sign") else None
            if binding is None or binding.level < level:
                break
            self.cursor.take()
            operator = Operator(token.span, binding.word, self._interval(binding.word))
            right = self.formula(binding.operand)
            if isinstance(left, Infix) and self._goes_on(left, operator):
                left = Infix(left.span.to(right.span), (*left.operators, operator), (*left.operands, right))
            else:
                left, nested = Infix(left.span.to(right.span), (operator,), (left, right)), nested + 1
        if nested > DEEPEST:
            self.cursor.refuse("S007", self.cursor.token.span, deepest=DEEPEST)
        self._depth -= 1
        return left

    def _goes_on(self, left: Infix, operator: Operator) -> bool:
        """Tell whether an operator goes on with a flat chain, such as `a + b - c`, read from the left."""
        word = left.operators[0].word
        together = next((words for words in _CHAINS if word in words), frozenset())
        return operator.word in together and self._level(word) == self._level(operator.word)

    def _level(self, word: str) -> int | None:
        return next((b.level for b in self.dialect.infixes.values() if b.word == word), None)

    def _primary(self) -> Expression:
        cursor, dialect = self.cursor, self.dialect
        token = cursor.token
        if token.kind == "number":
            return Number(cursor.take().span, number_of(token.text), None)
        begins = token.begins_line and cursor.after.text == dialect.assigns
        if begins or token.kind in ("text", "end"):
            cursor.misfit("a formula")
        if token.text == "(":
            cursor.take()
            inner = self.formula()
            return Group(token.span.to(cursor.need(")").span), inner)
        if token.text in dialect.special:
            return dialect.special[cursor.take().text](self, token)
        if token.text in dialect.prefixes:
            return self._prefix(cursor.take())
        if token.text in dialect.truths:
            return Truth(cursor.take().span, dialect.truths[token.text])
        if token.text.lower() == "inf":
            return Infinity(cursor.take().span)
        if token.kind != "word":
            cursor.misfit("a formula")
        if cursor.after.text == "(":
            return self._call(cursor.take())
        return self._name(self, cursor.take())

    def _prefix(self, token: Token) -> Expression:
        binding = self.dialect.prefixes[token.text]
        operator = Operator(token.span, binding.word, self._interval(binding.word))
        operand = self.formula(binding.operand)
        if binding.word == "neg" and isinstance(operand, Number):
            return Number(token.span.to(operand.span), -operand.value, None)
        return Prefix(token.span.to(operand.span), operator, operand)

    def _call(self, token: Token) -> Expression:
        cursor = self.cursor
        found = self.dialect.functions.get(token.text)
        if found is None:
            way = "write what it computes into the data, as a signal of its own"
            cursor.cannot_carry(token.span, f"the function `{token.text}`", "this language does not have it", way)
        word, count = found
        arguments = self.arguments()
        if len(arguments) != count:
            cursor.misfit(f"{count} argument" + ("s" if count > 1 else ""))
        span = token.span.to(cursor.before.span)
        if word == "pow":
            return Infix(span, (Operator(token.span, "pow"),), (arguments[0], arguments[1]))
        return Call(span, Name(token.span, word), arguments)

    def arguments(self) -> tuple[Expression, ...]:
        """Read arguments in brackets."""
        self.cursor.need("(")
        found = [self.formula()]
        while self.cursor.takes(","):
            found.append(self.formula())
        self.cursor.need(")")
        return tuple(found)

    def _interval(self, word: str) -> Interval | None:
        """Read the interval of an operator, if it takes one and one stands there; a comma may be missing."""
        if word not in self.dialect.intervals or self.cursor.token.text != "[":
            return None
        opening = self.cursor.take()
        low = self._bound(self)
        self.cursor.takes(",", ":")
        high = self._bound(self)
        closing = self.cursor.need("]")
        return Interval(opening.span.to(closing.span), low, high)


def bare(node: Expression) -> Expression:
    """Return an expression without its brackets. Not in the paper: other tools' languages."""
    match node:
        case Group(_, inner):
            return bare(inner)
        case Prefix(span, operator, operand):
            return Prefix(span, _bare_interval(operator), bare(operand))
        case Infix(span, operators, operands):
            return Infix(span, tuple(map(_bare_interval, operators)), tuple(map(bare, operands)))
        case Call(span, function, arguments):
            return Call(span, function, tuple(map(bare, arguments)))
    return node


def _bare_interval(operator: Operator) -> Operator:
    interval = operator.interval
    if interval is None:
        return operator
    inside = Interval(interval.span, bare(interval.low), bare(interval.high))
    return Operator(operator.span, operator.word, inside)


def is_real(node: Expression, reals: frozenset[str]) -> bool:
    """Tell whether an expression is a number; reals: the names that are. Not in the paper: other tools' languages."""
    match node:
        case Number() | Infinity() | Call():
            return True
        case Name(_, text):
            return text in reals
        case Prefix(_, operator, _):
            return operator.word in ARITHMETIC
        case Infix(_, operators, _):
            return operators[0].word in ARITHMETIC
    return False


def positive(node: Expression) -> Expression:
    """Return a number as a formula whose robustness it is: x > 0. Not in the paper: other tools' languages."""
    end = Span(node.span.end, node.span.end)
    return Infix(node.span, (Operator(end, "gt"),), (node, Number(end, 0.0, None)))


def every_node(root: Expression) -> list[Expression]:
    """Return all nodes under an expression, those of bounds left out. Not in the paper: other tools' languages."""
    return list(post_order(root))
