"""Specs of Breach and STLRom: files of `signal`, `param` and `name := formula`.

In: such a file. Out: a `Draft`. Operators bind as in Breach, loosest first: `or`, `=>`, `and`, `until`; where STLRom,
whose grammar orders them otherwise, would read a formula differently, that is said. `x[t]` is the signal x; a name
without it is a param or another formula.
"""

from stlspec.compiler.advice import short
from stlspec.lang.nodes import Expression, Infix, Name, Number, Prefix
from stlspec.source import SourceText
from stlspec.tools.importing.formulas import Binding, Dialect, Formulas, bare, every_node
from stlspec.tools.importing.model import Draft, time_statement
from stlspec.tools.importing.tokens import Cursor, Token, lex, number_of, read_statements

TOOL = "Breach"
DEFAULT_TIME = "s"
_WORD = r"[A-Za-z_][A-Za-z_0-9]*"
_SIGNS = (
    *(":=", "[]_", "<>_", "<>", "=>", "->", "<=", ">=", "==", "~=", "!=", "&&", "||", ".*", "./", ".^"),
    *"-+*/^(){}[];:,.=!~|&><",
)
_COMMENT = r"[#%][^\r\n]*|//[^\r\n]*"
_OR, _IMPLIES, _AND, _UNTIL, _PREFIX, _COMPARE, _SUM, _PRODUCT, _NEGATION, _POWER = range(1, 11)
_RIGHT = {
    **dict.fromkeys(("=>", "->"), ("implies", _IMPLIES)),
    **dict.fromkeys(("until", "until_", "U", "U_"), ("until", _UNTIL)),
}
_LEFT = {
    **dict.fromkeys(("or", "|", "||"), ("or", _OR)),
    **dict.fromkeys(("and", "&", "&&"), ("and", _AND)),
    "<": ("lt", _COMPARE),
    "<=": ("le", _COMPARE),
    ">": ("gt", _COMPARE),
    ">=": ("ge", _COMPARE),
    **dict.fromkeys(("==", "="), ("eq", _COMPARE)),
    **dict.fromkeys(("~=", "!="), ("ne", _COMPARE)),
    "+": ("add", _SUM),
    "-": ("sub", _SUM),
    **dict.fromkeys(("*", ".*"), ("mul", _PRODUCT)),
    **dict.fromkeys(("/", "./"), ("div", _PRODUCT)),
    **dict.fromkeys(("^", ".^"), ("pow", _POWER)),
}
_PREFIXES = {
    **dict.fromkeys(("alw", "alw_", "always", "always_", "G", "G_", "[]_"), ("always", _PREFIX)),
    **dict.fromkeys(("ev", "ev_", "eventually", "eventually_", "F", "F_", "<>", "<>_"), ("eventually", _PREFIX)),
    **dict.fromkeys(("once", "once_"), ("once", _PREFIX)),
    **dict.fromkeys(("hist", "hist_"), ("historically", _PREFIX)),
    **dict.fromkeys(("not", "!", "~"), ("not", _PREFIX)),
    "-": ("neg", _NEGATION),
    "+": ("plus", _NEGATION),
}
_FUNCTIONS = {
    **{name: (name, 1) for name in ("abs", "sqrt", "exp", "log", "sin", "cos")},
    **{name: (name, 2) for name in ("min", "max", "hypot")},
    "power": ("pow", 2),
}
_AT_TIME = "write the change between samples with `delta(x)` or `rate(x)`, or look ahead with a window"


def _plus(formulas: Formulas, _: Token) -> Expression:
    return formulas.formula(_NEGATION)


def _average(formulas: Formulas, token: Token) -> Expression:
    formulas.cursor.cannot_carry(token.span, "`av_ev`", "a window has no average here", "record it as a signal")


_DIALECT = Dialect(
    TOOL,
    ":=",
    prefixes={sign: Binding(word, level, level) for sign, (word, level) in _PREFIXES.items() if word != "plus"},
    infixes={
        **{sign: Binding(word, level, level) for sign, (word, level) in _RIGHT.items()},
        **{sign: Binding(word, level, level + 1) for sign, (word, level) in _LEFT.items()},
    },
    functions=_FUNCTIONS,
    truths={"true": True, "false": False},
    intervals=frozenset({"always", "eventually", "until", "once", "historically"}),
    special={"+": _plus, "av_ev": _average, "av_ev_": _average},
)


def read(source: SourceText, time: str | None = None) -> Draft:
    """Read a spec of Breach.

    Not in the paper: other tools' languages.

    Args:    time: how time is measured, as after `time` in a spec; None: time stamps in seconds.
    Returns: what it says; `problems` holds what cannot be carried over.
    """
    tokens, comments = lex(source, _WORD, _SIGNS, _COMMENT)
    draft = Draft(source, TOOL, time_statement(time or DEFAULT_TIME), comments=comments)
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
        self._plain: dict[str, Name] = {}
        self._said = False

    def statement(self) -> None:
        """Read a declaration of signals or params, or a formula."""
        cursor = self.cursor
        if cursor.takes(";"):
            return
        if cursor.token.text in ("input", "output") and cursor.after.text == "signal":
            cursor.take()
        if cursor.token.text == "signal" and cursor.after.kind == "word":
            self._signals()
        elif cursor.token.text == "param" and cursor.after.kind == "word":
            self._params()
        elif cursor.token.text == "test" and cursor.after.text != ":=":
            why = "it names a simulation, which is no data"
            cursor.cannot_carry(cursor.token.span, "a `test`", why, "remove it; recorded data is tested with `expect`")
        else:
            self._formula()

    def skip(self, first: Token) -> None:
        """Go on at the next line that begins like a statement."""
        cursor = self.cursor
        if cursor.token is first:
            cursor.take()
        while not cursor.at_end:
            begins = cursor.token.text in ("signal", "param", "test", "input", "output") or cursor.after.text == ":="
            if cursor.token.begins_line and begins:
                return
            cursor.take()

    def settle(self) -> None:
        """Declare what has no value: Breach takes 0 and expects to be told; here a param waits for its value."""
        draft = self.draft
        for name, place in self._plain.items():
            if name in draft.values or name in draft.assigned:
                continue
            if name in draft.signals:
                way = f"write `{name}[t]`"
                draft.report("S040", place.span, what=f"`{name}` without `[t]`", why="it is a signal", help=way)
                continue
            draft.values[name] = (place, None)
            draft.implied.add(name)
            way = f"bind it with `-p {name}=VALUE`, or give it a value in the spec"
            draft.report("S042", place.span, what=f"`{name}` has no value; Breach would take 0", help=way)

    def _signals(self) -> None:
        cursor = self.cursor
        cursor.take()
        while True:
            name = cursor.need_word()
            self.draft.signal(name.text, name.span)
            if not cursor.takes(","):
                return

    def _params(self) -> None:
        cursor = self.cursor
        cursor.take()
        while True:
            name = cursor.need_word()
            cursor.need("=")
            sign = cursor.takes("-", "+")
            value = cursor.take() if cursor.token.kind == "number" else cursor.misfit("a number")
            number = number_of(value.text)
            number = -number if sign is not None and sign.text == "-" else number
            self._param(name, Number(value.span, number, None))
            if not cursor.takes(","):
                return

    def _param(self, name: Token, number: Number) -> None:
        before = self.draft.values.get(name.text)
        if before is None:
            self.draft.values[name.text] = (Name(name.span, name.text), number)
        elif before[1] is not None and before[1].value != number.value:
            what = f"a second value for `{name.text}`"
            self.cursor.cannot_carry(name.span, what, "a param has one value", "use two params")

    def _formula(self) -> None:
        cursor = self.cursor
        name = cursor.need_word("signal, param, or a name and `:=`")
        cursor.need(":=")
        formula = self._formulas.formula()
        following = cursor.token
        if not cursor.at_end and not following.begins_line and following.text != ";":
            cursor.misfit("an operator or the end of the formula")
        if cursor.after.text != ":=" and following.kind != "end" and following.text not in _BEGINNINGS:
            cursor.misfit("an operator, or `name :=`")
        if name.text in self.draft.assigned:
            what, way = f"a second formula `{name.text}`", "rename one of the two"
            cursor.cannot_carry(name.span, what, "a name stands for one thing", way)
        self._say_where_others_differ(formula)
        self._say_where_values_differ(formula)
        self.draft.assigned[name.text] = (Name(name.span, name.text), bare(formula))

    def _name(self, formulas: Formulas, token: Token) -> Expression:
        """Make `x[t]` a signal, and a plain name a param or a formula."""
        cursor = formulas.cursor
        if cursor.token.text != "[":
            name = Name(token.span, token.text)
            self._plain.setdefault(token.text, name)
            return name
        cursor.take()
        if cursor.token.text != "t" or cursor.after.text != "]":
            while not cursor.at_end and cursor.token.text != "]":
                cursor.take()
            span = token.span.to(cursor.token.span)
            written = self.draft.source.slice(span)
            cursor.cannot_carry(span, f"`{written}`", "a formula speaks of the sample at hand", _AT_TIME)
        cursor.take()
        cursor.take()
        if token.text not in self.draft.signals:
            self.draft.signal(token.text, token.span)
            self.draft.implied.add(token.text)
        return Name(token.span, token.text)

    def _bound(self, formulas: Formulas) -> Expression:
        return formulas.formula(_SUM)

    def _say_where_others_differ(self, root: Expression) -> None:
        """Warn where operators meet without brackets that STLRom, of the same author, reads in another order."""
        for node in every_node(root):
            if not isinstance(node, Infix) or node.operators[0].word not in _MIXED:
                continue
            word, left = node.operators[0].word, node.operands[0]
            others = {o.operators[0].word for o in node.operands if isinstance(o, Infix)} & _MIXED
            negated = word == "until" and isinstance(left, Prefix) and left.operator.word == "not"
            if (others - {word, "until"} and word != "until") or negated:
                what = f"`{short(self.draft.source.slice(node.span))}` is read as Breach reads it"
                way = "STLRom reads it in another order: put brackets in the file if that was meant"
                self.draft.report("S042", node.operators[0].span, what=what, help=way)
                break

    def _say_where_values_differ(self, root: Expression) -> None:
        """Warn of equality, to which Breach gives values of its own, once for a spec."""
        for node in every_node(root):
            equal = isinstance(node, Infix) and node.operators[0].word in ("eq", "ne")
            if isinstance(node, Infix) and equal and not self._said:
                self._said = True
                why = "Breach takes a constant where both sides are equal; the verdict is the same"
                self.draft.report(
                    "S042", node.operators[0].span, what="the robustness of `==` is another here", help=why
                )


_BEGINNINGS = ("signal", "param", "test", "input", "output", ";")
_MIXED = frozenset({"or", "implies", "and", "until"})
