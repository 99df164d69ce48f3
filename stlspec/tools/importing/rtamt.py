"""Specs of RTAMT: the text that its Python classes are given.

In: declarations (`input float x`, `const float T = 5`) and assertions (`out = always[0:T](x >= 3)`). Out: a `Draft`.
The levels of its operators are those of its grammar, where `*` binds tighter than `/`, `+` tighter than `-`, all of
them to the left, `implies` too. A number stands for a formula there whose robustness it is: here it becomes x > 0.
"""

from collections.abc import Callable
from dataclasses import replace

from stlspec.lang.nodes import Expression, Infix, Name, Number, Operator, Prefix, Unit
from stlspec.source import SourceText, Span
from stlspec.tools.importing.formulas import COMPARISONS, Binding, Dialect, Formulas, bare, is_real, positive
from stlspec.tools.importing.model import UNITS, Draft, time_statement
from stlspec.tools.importing.python import Embedded, embedded, looks_like_program
from stlspec.tools.importing.tokens import Cursor, Token, lex, number_of, read_statements

TOOL = "RTAMT"
DEFAULT_TIME = "1 s"
"""Its default sampling period, with bounds in seconds."""
DEFAULT_UNIT = "s"
_WORD = r"[A-Za-z_$][A-Za-z_$0-9./]*"
_SIGNS = ("!==", "<->", "->", "==", ">=", "<=", *"-+*/(){}[];:,.@!|&><=")
_COMMENT = r"/\*.*?\*/|//[^\r\n]*"
_TYPES = frozenset({"float", "int", "long", "real", "bool", "complex"})
_DECLARING = frozenset({"input", "output", "internal", "const", "specification", "from", "@", *_TYPES})
_LEFT = (
    ("*", "mul", 26),
    ("/", "div", 25),
    ("+", "add", 24),
    ("-", "sub", 23),
    *((sign, word, 22) for sign, word in zip("< <= > >= == !==".split(), "lt le gt ge eq ne".split(), strict=True)),
    *(("until", "until", 12), ("U", "until", 12), ("unless", "unless", 11), ("W", "unless", 11)),
    *(("since", "since", 10), ("S", "since", 10), ("and", "and", 9), ("&", "and", 9), ("or", "or", 8), ("|", "or", 8)),
    *(("implies", "implies", 7), ("->", "implies", 7), ("iff", "iff", 6), ("<->", "iff", 6), ("xor", "xor", 5)),
)
_PREFIXES = (
    *(("not", "not", 21), ("!", "not", 21), ("always", "always", 20), ("G", "always", 20)),
    *(("eventually", "eventually", 19), ("F", "eventually", 19), ("historically", "historically", 18)),
    *(("H", "historically", 18), ("once", "once", 17), ("O", "once", 17), ("prev", "wprev", 16), ("Y", "wprev", 16)),
    *(("next", "wnext", 15), ("X", "wnext", 15), ("s_prev", "prev", 14), ("sY", "prev", 14)),
    *(("s_next", "next", 13), ("sX", "next", 13), ("-", "neg", 27)),
)
_FUNCTIONS = {
    **{name: (name, 1) for name in ("abs", "sqrt", "exp", "sin", "cos")},
    "ln": ("log", 1),
    "pow": ("pow", 2),
    "min": ("min", 2),
    "max": ("max", 2),
}
_INTERVALS = frozenset("always eventually historically once until unless since".split())


def _edge(falls: bool) -> Callable[[Formulas, Token], Expression]:
    """Make the reader of `rise(p)`, which is `p and wprev not p`, or of `fall(p)`."""

    def read(formulas: Formulas, token: Token) -> Expression:
        (inner,) = formulas.arguments()
        span = token.span.to(formulas.cursor.before.span)
        before, negated = Operator(span, "wprev"), Prefix(span, Operator(span, "not"), inner)
        now, then = (negated, inner) if falls else (inner, negated)
        return Infix(span, (Operator(span, "and"),), (now, Prefix(span, before, then)))

    return read


_DIALECT = Dialect(
    TOOL,
    "=",
    prefixes={sign: Binding(word, level, level) for sign, word, level in _PREFIXES},
    infixes={sign: Binding(word, level, level + 1) for sign, word, level in _LEFT},
    functions=_FUNCTIONS,
    truths={},
    intervals=_INTERVALS,
    special={"rise": _edge(False), "fall": _edge(True)},
)


def read(source: SourceText, time: str | None = None) -> Draft:
    """Read a spec of RTAMT, from a file of its own or inside a Python program.

    Not in the paper: other tools' languages.

    Args:    time: how time is measured, as after `time` in a spec; None: its default, a sample every second.
    Returns: what it says; `problems` holds what cannot be carried over.
    """
    if looks_like_program(source):
        program = embedded(source)
        draft = _read(program.source, time or program.period or DEFAULT_TIME, program)
        draft.source = source
        draft.problems = [replace(problem, source=source) for problem in draft.problems]
        return draft
    return _read(source, time or DEFAULT_TIME)


def _read(source: SourceText, time: str, program: Embedded | None = None) -> Draft:
    tokens, comments = lex(source, _WORD, _SIGNS, _COMMENT)
    draft = Draft(source, TOOL, time_statement(time), comments=comments)
    if program is not None:
        draft.bound_unit = program.unit or (DEFAULT_UNIT if program.period else None)
        for name, span, value in program.constants:
            draft.values[name] = (Name(span, name), Number(span, value, None))
    reader = _Reader(Cursor(source, tokens, TOOL), draft)
    read_statements(reader, draft.problems)
    reader.settle()
    return draft


class _Reader:
    """Reads statement by statement; one that is broken ends where the next begins."""

    def __init__(self, cursor: Cursor, draft: Draft) -> None:
        self.cursor = cursor
        self.draft = draft
        self._formulas = Formulas(cursor, _DIALECT, self._name, self._bound)
        self._met: dict[str, Span] = {}

    def statement(self) -> None:
        """Read one declaration or assertion."""
        cursor = self.cursor
        word = cursor.token.text
        if word == "specification":
            cursor.take()
            name = cursor.need_word()
            self.draft.title = Name(name.span, name.text)
        elif word in ("from", "@"):
            what = "a type of ROS messages" if word == "from" else "the topic of a ROS node"
            cursor.cannot_carry(cursor.token.span, what, "data comes from files here", "remove the line")
        elif word == "const":
            self._constant()
        elif word in ("input", "output", "internal") or word in _TYPES:
            self._variable()
        else:
            self._assertion()
        cursor.takes(";")

    def skip(self, first: Token) -> None:
        """Go on at the next statement: behind a semicolon, or on a line that begins like one."""
        cursor = self.cursor
        if cursor.token is first:
            cursor.take()
        while not cursor.at_end and not cursor.takes(";"):
            begins = cursor.token.text in _DECLARING or cursor.after.text == "="
            if cursor.token.begins_line and begins:
                return
            cursor.take()

    def settle(self) -> None:
        """Declare what is used and declared nowhere, as its `declare_var` does; leave out what is assigned."""
        for name, span in self._met.items():
            if not any(name in known for known in (self.draft.assigned, self.draft.values, self.draft.signals)):
                self.draft.signal(name, span)
                self.draft.implied.add(name)
        for name in self.draft.assigned:
            self.draft.signals.pop(name, None)

    def _type(self) -> Token:
        kind = self.cursor.need_word("a type, such as float")
        if kind.text in ("complex", "bool") or kind.text not in _TYPES:
            why = "signals are real numbers" if kind.text == "complex" else "its values are numbers there, not truth"
            if kind.text not in _TYPES:
                why = "it is no number"
            self.cursor.cannot_carry(kind.span, f"the type `{kind.text}`", why, "declare a float for what is compared")
        return kind

    def _variable(self) -> None:
        cursor = self.cursor
        cursor.takes("input", "output", "internal")
        self._type()
        name = cursor.need_word()
        if cursor.token.text == "=":
            way = "write `const` in front of it"
            cursor.cannot_carry(cursor.token.span, "a variable with a value", "signals come with the data", way)
        self.draft.signal(name.text, name.span)

    def _constant(self) -> None:
        cursor = self.cursor
        cursor.take()
        self._type()
        name = cursor.need_word()
        cursor.need("=")
        sign = cursor.takes("-")
        value = cursor.take() if cursor.token.kind == "number" else cursor.misfit("a number")
        number = Number(value.span, -number_of(value.text) if sign else number_of(value.text), None)
        self.draft.values[name.text] = (Name(name.span, name.text), number)

    def _assertion(self) -> None:
        cursor = self.cursor
        name = Name(cursor.token.span, "out" if "out" not in self.draft.assigned else f"out_{len(self.draft.assigned)}")
        if cursor.token.kind == "word" and cursor.after.text == "=":
            token = cursor.take()
            cursor.take()
            name = Name(token.span, token.text)
        if name.text in self.draft.assigned:
            way = "rename one of the two"
            cursor.cannot_carry(name.span, f"a second formula `{name.text}`", "a name stands for one thing", way)
        formula = self._formula(bare(self._formulas.formula()))
        following = cursor.token
        if not cursor.at_end and following.text != ";" and not following.begins_line:
            cursor.misfit("an operator or the end of the assertion")
        self.draft.assigned[name.text] = (name, formula)

    def _name(self, _: Formulas, token: Token) -> Expression:
        self._met.setdefault(token.text, token.span)
        return Name(token.span, token.text)

    def _bound(self, _: Formulas) -> Expression:
        """Read a number or a constant, with a unit or without."""
        cursor = self.cursor
        token = cursor.take() if cursor.token.kind in ("number", "word") else cursor.misfit("a number or a constant")
        unit = cursor.takes(*UNITS)
        if cursor.token.text == "ps":
            cursor.cannot_carry(cursor.token.span, "picoseconds", "time is kept in nanoseconds", "write them as ns")
        found = Unit(unit.span, unit.text) if unit else None
        if token.kind == "number":
            return Number(token.span, number_of(token.text), found)
        if token.text not in self.draft.values:
            way = f"declare it first: const float {token.text} = ..."
            cursor.cannot_carry(token.span, f"the bound `{token.text}`", "it has no value", way)
        name = Name(token.span, token.text)
        if found is None:
            return name
        return Infix(token.span, (Operator(token.span, "mul"),), (name, Number(found.span, 1.0, found)))

    def _formula(self, node: Expression) -> Expression:
        """Return an expression as a formula, and all its parts as what their operators take."""
        if self._is_real(node):
            self._real(node)
            return positive(node)
        match node:
            case Prefix(span, operator, operand):
                return Prefix(span, operator, self._formula(operand))
            case Infix(span, operators, operands):
                if operators[0].word in COMPARISONS:
                    for operand in operands:
                        self._real(operand)
                    return node
                self._warn_of_difference(operators[0])
                return Infix(span, operators, tuple(self._formula(operand) for operand in operands))
        return node

    def _real(self, node: Expression) -> None:
        """Refuse arithmetic on the robustness of formulas."""
        if not self._is_real(node):
            way = "write what is compared as a formula of its own"
            what = "arithmetic on the robustness of a formula"
            self.cursor.cannot_carry(node.span, what, "formulas are true or false here", way)
        parts: tuple[Expression, ...] = getattr(node, "operands", ()) or getattr(node, "arguments", ())
        for part in (*parts, *([node.operand] if isinstance(node, Prefix) else [])):
            self._real(part)

    def _is_real(self, node: Expression) -> bool:
        return is_real(node, frozenset(self._met) - self.draft.assigned.keys())

    def _warn_of_difference(self, operator: Operator) -> None:
        if operator.word in ("iff", "xor"):
            what = f"the robustness of `{operator.word}` is another here"
            why = "RTAMT takes the distance of the two values; the verdict is the same"
            self.draft.report("S042", operator.span, what=what, help=why)
