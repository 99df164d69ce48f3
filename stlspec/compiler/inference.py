"""Reals or formulas, in which unit, known or not: the typing of every expression.

In: expressions and the typings of the names in scope. Out: a `Typing` for each node, and one diagnostic for
each root cause: what is reported is "broken", and whatever holds it stays silent. Formulas and arithmetic share
one grammar, so this is where `always d` and `(d > 1) + 2` are told from `always (d > 1)` and `d + 2`.
"""

from collections.abc import Iterable, Sequence
from typing import Any

from stlspec.compiler.advice import FOR_FORMULAS, LONGEST_UNIT, first_of_unit, for_truth, for_unknown, short
from stlspec.compiler.constants import FOLDABLE, fold
from stlspec.compiler.intervals import swapped, ticks_of
from stlspec.compiler.model import BROKEN, FORMULA, Declared, Typing
from stlspec.compiler.quantities import Quantities, Unit
from stlspec.errors import Diagnostic, Edit, Label, diagnostic
from stlspec.lang.hints import PREFIX_WORDS
from stlspec.lang.measures import LEAVE_OUT
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
    operators,
    post_order,
)
from stlspec.lang.parse import Syntax
from stlspec.lang.spelling import closest
from stlspec.lang.units import NANOSECONDS, Dimension, dimension, is_unit_word
from stlspec.source import Span

COMPARISONS = frozenset({"lt", "le", "gt", "ge", "eq", "ne", "assign"})
ARITHMETIC = frozenset({"add", "sub", "mul", "div", "pow"})
FUNCTIONS = {
    "abs": (1, 1),
    "min": (2, None),
    "max": (2, None),
    "sqrt": (1, 1),
    "exp": (1, 1),
    "log": (1, 1),
    "sin": (1, 1),
    "cos": (1, 1),
    "hypot": (2, 2),
    "delta": (1, 1),
    "rate": (1, 1),
}
NOW = frozenset({"now", "t"})
MANY_PROBLEMS = 300
"""From here on names are not compared with each other for suggestions: that would cost the square of the text."""
_NEARLY = 0.8
"""How alike a word must be to an operator to be taken for a slip in it, not for a function of another language."""
SAME_UNIT = frozenset({"add", "sub", "min", "max", "hypot"})
"""Operators whose operands are brought to one unit."""


class Inference:
    """Types expressions one after the other; `typings`, `intervals` and `problems` grow as it goes."""

    def __init__(self, syntax: Syntax, declared: Declared, silent: frozenset[str], problems: list[Diagnostic]) -> None:
        self._seen_by: dict[int, frozenset[str]] = {}
        self.enter(syntax)
        self.declared = declared
        self.lost_units = frozenset[str]().union(*(file.lost.units for file in (syntax, *syntax.used)))
        self.silent = silent
        self.problems = problems
        self.scope: dict[str, Typing] = {}
        self.typings: dict[int, Typing] = {}
        self.intervals: dict[int, tuple[int, int | None]] = {}
        self.quantities = Quantities(self._report, lambda span: self.source.slice(span))
        self._said: dict[tuple[str, str], int] = {}
        self._in_constant = False

    def enter(self, file: Syntax) -> None:
        """Go on with expressions of another file: names are those that it sees, places are in its text."""
        self.source = file.source
        self.nameless = file.lost.nameless
        seen = self._seen_by.get(id(file))
        if seen is None:
            seen = self._seen_by[id(file)] = file.names.union(*(other.names for other in file.used))
        self._names_seen = seen

    def sees(self, name: str) -> bool:
        """Tell whether a name that is in scope is declared in this file or one that it uses."""
        return name in self.scope and (name in self._names_seen or name not in self.declared.files)

    def known(self) -> Iterable[str]:
        """Return the names that may have been meant by one that is not known."""
        return self.scope

    def _report(self, code: str, span: Span, labels: tuple[Label, ...] = (), **fields: Any) -> Typing:
        """Report a problem; one with a name only once in each statement."""
        about = (code, fields.get("name", ""))
        if code.startswith("N") and about in self._said:
            first = self._said[about]
            self.problems[first] = self.problems[first].also_at(span)
            return BROKEN
        self._said[about] = len(self.problems)
        self.problems.append(diagnostic(code, source=self.source, span=span, labels=labels, **fields))
        return BROKEN

    def infer(self, root: Expression) -> Typing:
        """Type an expression of a statement, and everything under it."""
        self._said.clear()
        return self._walk(root)

    def _walk(self, root: Expression) -> Typing:
        for node in post_order(root):
            self.typings[id(node)] = self._node(node)
        return self.typings[id(root)]

    def formula(self, root: Expression) -> Typing:
        """Type `root`, which must be a formula."""
        return self._need_formula(root) if self.infer(root).kind == "real" else self.typings[id(root)]

    def _node(self, node: Expression) -> Typing:
        below = [self.typings[id(child)] for child in children(node)]
        match node:
            case Number():
                return self._number(node)
            case Truth():
                return FORMULA
            case Infinity():
                return Typing("real", None, True, float("inf"))
            case Name():
                return self._name(node)
            case Group():
                return below[0]
            case Index():
                return self._index(node)
            case Call():
                return self._call(node, below)
            case Prefix():
                return self._prefix(node, below[0])
            case Infix():
                return self._infix(node, below)

    def _number(self, node: Number) -> Typing:
        if abs(node.value) == float("inf"):
            return self._report("S023", node.span)
        if node.unit is None:
            return Typing("real", None, True, node.value)
        found = dimension(node.unit.text)
        if found is None or not found.keys() <= self.quantities.known:
            close = self.quantities.meant(node.unit.text)
            way = f"did you mean `{close}`?" if close else "declare a signal with this unit, or remove it"
            edits = (Edit(node.unit.span, close),) if close else ()
            return self._report("U302", node.unit.span, edits=edits, unit=node.unit.text, help=way)
        return Typing("real", found, True, node.value)

    def _name(self, node: Name) -> Typing:
        name = node.text
        if self.sees(name):
            return self.scope[name]
        if name in self.declared.requirements and self.declared.files[name].source is self.source:
            return self._report("N105", node.span, (self.declared.place(name),), name=name)
        if name in self.declared.elsewhere:
            return self._report("N112", node.span, (self.declared.elsewhere[name],), name=name)
        if name in self.silent:
            return BROKEN
        if name in NOW:
            time = self.declared.time
            return (
                Typing("real", None if time.kind == "step" else {time.unit: 1}) if self.declared.time_known else BROKEN
            )
        if self.nameless:
            return BROKEN
        if name in self.scope:
            way = "declare it in this file or use the file that does; what the using file declares is not seen here"
            return self._report("N101", node.span, (self.declared.place(name),), name=name, help=way)
        few = len(self.problems) < MANY_PROBLEMS
        known = [*self.known(), "now", "true", "false", "inf"] if few else ()
        way, edits = for_unknown(name, node.span, known, constant=self._in_constant)
        if is_unit_word(name):
            first = first_of_unit(self.source.text[max(0, node.span.start - LONGEST_UNIT) : node.span.start])
            if first is not None and first not in self.scope and is_unit_word(first):
                return BROKEN  # the first word of this unit was told
            if first is not None:
                way, edits = f"if `{name}` is meant as a unit: {LEAVE_OUT}", ()
        return self._report("N101", node.span, edits=edits, name=name, help=way)

    def _index(self, node: Index) -> Typing:
        inner = self._name(node.name)
        if isinstance(node.index, Name) and node.index.text in NOW and not self.sees(node.index.text):
            return inner
        if inner == BROKEN:
            return BROKEN
        text = self.source.slice(node.index.span)
        way = f"write `{node.name.text}`; for other samples use `next`, `prev`, `delta` or a window"
        return self._report("S013", node.span, name=node.name.text, index=text, help=way)

    def _call(self, node: Call, below: list[Typing]) -> Typing:
        name = node.function.text
        if name not in FUNCTIONS:
            return self._unknown_function(node)
        least, most = FUNCTIONS[name]
        given = len(node.arguments)
        if given < least or (most is not None and given > most):
            wanted = f"{least} or more" if most is None else str(least)
            usage = f"`{name}({', '.join('xyz'[:least])})`"
            plural = "argument" if wanted == "1" else "arguments"
            return self._report("T203", node.span, name=name, wanted=f"{wanted} {plural}", given=given, usage=usage)
        if not self._all_real(node.arguments, f"{name}(...)"):
            return BROKEN
        if name == "rate" and not self.declared.time_known:
            return BROKEN
        time = self.declared.time
        unit = self.quantities.of_call(name, list(zip(node.arguments, below, strict=True)), time)
        return self._folded(name, below, unit, node.span) if unit is not BROKEN else BROKEN

    def _unknown_function(self, node: Call) -> Typing:
        name = node.function.text
        if self.sees(name):
            return self._report("N103", node.function.span, name=name, help=f"write `{name}` without arguments")
        if self._unit_behind(node):
            way = f"a unit stands behind each bound, inside the interval, as in `[0, 5 {name}]`"
            return self._report("N103", node.function.span, name=name, help=way)
        # `let nearx, r) = ...`, which has lost a bracket, may have been meant to declare `near`.
        if self.nameless or any(lost.startswith(name) for lost in self.silent):
            return BROKEN
        templates = [other for other, let in self.declared.lets.items() if let.arguments and self.sees(other)]
        # `alway(p)` reads as a call too; of the operators only those that stand before one formula can be meant.
        close = closest(name, [*templates, *FUNCTIONS]) or closest(name, PREFIX_WORDS, _NEARLY)
        way = f"did you mean `{close}`?" if close else f"the functions are {', '.join([*FUNCTIONS, *templates[:5]])}"
        edits = (Edit(node.function.span, close),) if close else ()
        return self._report("N103", node.function.span, edits=edits, name=name, help=way)

    def _prefix(self, node: Prefix, below: Typing) -> Typing:
        if node.operator.word == "neg":
            if not self._need_real(node.operand, "-"):
                return BROKEN
            return self._folded("neg", [below], below.unit, node.span)
        if not (isinstance(node.operand, Call) and self._unit_behind(node.operand)):
            self._window(node.operator)
        return self._need_formula(node.operand)

    def _unit_behind(self, node: Call) -> bool:
        """Tell whether `node` is `s (...)` behind an interval: a unit that belongs to its bounds, not a function."""
        return node.function.text in NANOSECONDS and self.source.text[: node.span.start].rstrip().endswith("]")

    def _infix(self, node: Infix, below: list[Typing]) -> Typing:
        word = node.operators[0].word
        if word in COMPARISONS:
            return self._comparison(node, below)
        if word in ARITHMETIC:
            return self._arithmetic(node, below)
        for operator in node.operators:
            self._window(operator)
        if len(node.operators) > 1 and word in ("until", "since", "unless", "release", "iff"):
            left = self.source.slice(node.operands[0].span.to(node.operands[1].span))
            operator = node.operators[1]
            return self._report("S009", operator.span, operator=operator.word, left=short(left))
        if self._means_at_least(node, below):
            return BROKEN
        kinds = [self._need_formula(operand).kind for operand in node.operands]
        return FORMULA if "broken" not in kinds else BROKEN

    def _means_at_least(self, node: Infix, below: list[Typing]) -> bool:
        """Report `x => 5`, an implication between numbers, as the comparison that was meant."""
        if any(typing.kind != "real" for typing in below) or self.source.slice(node.operators[0].span) != "=>":
            return False
        left, right = (short(self.source.slice(operand.span)) for operand in node.operands)
        way = f"`=>` means `implies`; to compare write `{left} >= {right}`"
        self._report("T201", node.span, help=way)
        return True

    def _comparison(self, node: Infix, below: list[Typing]) -> Typing:
        for operator in node.operators:
            if operator.word == "assign":
                sign = "iff" if FORMULA in below else "=="
                edits = tuple(Edit(o.span, sign) for o in node.operators if o.word == "assign")
                return self._report("S008", operator.span, edits=edits, sign=sign)
        words = {operator.word for operator in node.operators}
        if len(node.operators) > 1 and not (words <= {"lt", "le"} or words <= {"gt", "ge"}):
            return self._report("S022", node.operators[1].span)
        sign = self.source.slice(node.operators[0].span)
        truth = for_truth(node, below, self.source.slice)
        if truth is not None:
            formula = node.operands[below.index(FORMULA)]
            return self._report("T202", formula.span, help=truth[0], edits=truth[1])
        if not self._all_real(node.operands, sign):
            return BROKEN
        joined = self.quantities.joined(list(zip(node.operands, below, strict=True)), "compared")
        return BROKEN if joined is BROKEN else FORMULA

    def _arithmetic(self, node: Infix, below: list[Typing]) -> Typing:
        if not self._all_real(node.operands, "arithmetic"):
            return BROKEN
        words = [operator.word for operator in node.operators]
        unit = self.quantities.of_operators(words, list(zip(node.operands, below, strict=True)))
        if unit is BROKEN:
            return BROKEN
        typing = below[0]
        for word, right in zip(words, below[1:], strict=True):
            typing = self._folded(word, [typing, right], unit, node.span)
        return typing

    def _folded(self, op: str, operands: list[Typing], unit: Unit, span: Span) -> Typing:
        """Type the result of real operands: constant if they are, with its value if all values are known."""
        assert not isinstance(unit, Typing)
        if not all(t.constant for t in operands) or op not in FOLDABLE:
            return Typing("real", unit)
        same = op in SAME_UNIT
        values = [self.quantities.value_in(t, unit) if same else t.value for t in operands]
        if any(v is None for v in values):
            return Typing("real", unit, True)
        value = fold(op, [v for v in values if v is not None])
        if value != value:
            return self._report("T207", span, text=short(self.source.slice(span)))
        return Typing("real", unit, True, value)

    def _all_real(self, nodes: Sequence[Expression], what: str) -> bool:
        """Check the operands of one operator; the first wrong one is reported, since the cause is the operator."""
        if any(self.typings[id(node)].kind == "broken" for node in nodes):
            return False
        return all(self._need_real(node, what) for node in nodes)

    def _need_real(self, node: Expression, what: str) -> bool:
        kind = self.typings[id(node)].kind
        if kind == "formula":
            way = f"compare or add numbers only; `{what}` takes numbers"
            self._report("T202", node.span, help=FOR_FORMULAS.get(what, way))
            self.typings[id(node)] = BROKEN
        return kind == "real"

    def _need_formula(self, node: Expression) -> Typing:
        typing = self.typings[id(node)]
        if typing.kind != "real":
            return typing
        text = short(self.source.slice(node.span))
        self._report("T201", node.span, help=f"compare it with something, for instance `{text} > 0`")
        self.typings[id(node)] = BROKEN
        return BROKEN

    def _window(self, operator: Operator) -> None:
        """Work out the interval of a temporal operator in ticks, if it has one and its params are known."""
        if operator.interval is None:
            return
        interval = operator.interval
        low, high = (self.constant(bound, "a bound") for bound in (interval.low, interval.high))
        if "broken" in (low.kind, high.kind) or not self.declared.time_known:
            return
        ticks = ticks_of(interval, (low, high), self.declared.time, self.source, self.problems)
        if ticks is not None:
            self.intervals[id(interval)] = ticks

    def constant(self, node: Expression, what: str) -> Typing:
        """Type an expression that must be a real constant; `what` names its role in the message."""
        # A bound with a window of its own is refused unread, so that nesting needs no deep stack.
        windows = next((n for n in post_order(node) if operators(n) and bounds(n)), None)
        if windows is not None:
            self.typings[id(windows)] = FORMULA
            self._need_real(windows, what)
            return BROKEN
        self._in_constant = True  # a window inside was refused above, so this does not nest
        typing = self._walk(node)
        self._in_constant = False
        if not self._need_real(node, what):
            return BROKEN
        if typing.constant:
            return typing
        varying = [n for n in post_order(node) if not self.typings[id(n)].constant]
        return self._report("T204", node.span, what=what, name=self.source.slice(varying[0].span))

    def range_of(self, interval: Interval, unit: Dimension | None) -> tuple[float, float] | None:
        """Return the bounds of a signal's range in the signal's unit; None if reported or not known."""
        values = []
        self._said.clear()
        for bound in (interval.low, interval.high):
            typing = self.constant(bound, "a range")
            if self.quantities.joined([(bound, Typing("real", unit)), (bound, typing)], "compared") is BROKEN:
                return None
            value = self.quantities.value_in(typing, unit) if typing.kind == "real" else None
            if value is None:
                return None
            values.append(value)
        low, high = values
        if not low < high:
            self._report(
                "T206",
                interval.span,
                edits=swapped(self.source, interval) if low > high else (),
                what="the range ends before it begins" if low > high else "the range holds one value only",
                help=f"write [{high:g}, {low:g}]" if low > high else "a signal that never changes is a `param`",
            )
            return None
        return low, high
