"""From a place where the parser cannot go on to the diagnostic that a person needs.

In: a `Failure`: the tokens, where it stopped, what the automaton would have taken, which brackets are open.
Out: one diagnostic. Each habit or slip that can be told from the tokens has a function of its own, and
`describe` asks them in a fixed order; the last one only names what was found and what was expected.
"""

from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches

from lark import Token

from stlspec.errors import Diagnostic, Label, diagnostic
from stlspec.lang.statements import STATEMENT_WORDS, is_word
from stlspec.lang.tree import span_of
from stlspec.source import SourceText, Span

OPERATOR_WORDS = (
    "always eventually historically once until since unless release next prev wnext wprev not "
    "and or xor implies iff globally finally"
).split()
_RESERVED = frozenset(
    (
        "signal param let hard soft expect always eventually historically once until since unless "
        "release next prev wnext wprev not and or xor implies iff true false inf"
    ).split()
)
_CLAUSES = frozenset({"DEPENDS", "SCALE", "BOUND", "STRING"})
_CLAUSE_WORDS = {"depends": "on", "scale": "NUMBER", "bound": "NAME"}
_SHOWN = {
    "NAME": "a name",
    "NUMBER": "a number",
    "STRING": "a quoted text",
    "$END": "the end of the statement",
}


@dataclass(frozen=True, slots=True)
class Failure:
    """A statement that cannot be parsed.

    at: index of the token that does not fit; len(tokens) if the statement ends too early. expected: terminals
    that fit there. brackets: the opening brackets still open. beginning: nothing before the token belongs to
    its statement.
    """

    source: SourceText
    tokens: tuple[Token, ...]
    at: int
    expected: frozenset[str]
    brackets: tuple[Token, ...]
    beginning: bool

    @property
    def token(self) -> Token | None:
        """The token that does not fit; None at the end."""
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    @property
    def span(self) -> Span:
        """Where to point: at the token, or just behind the last one."""
        if self.token is not None:
            return span_of(self.token)
        end = span_of(self.tokens[-1]).end
        return Span(end, end)

    def error(self, code: str, *, at: Span | None = None, labels: tuple[Label, ...] = (), **fields: str) -> Diagnostic:
        """Make the diagnostic `code` at `at`, or at the token that does not fit."""
        return diagnostic(code, source=self.source, span=at or self.span, labels=labels, **fields)


def describe(failure: Failure) -> Diagnostic:
    """Return the one diagnostic for a statement that cannot be parsed."""
    for recognise in _RECOGNISERS:
        found = recognise(failure)
        if found is not None:
            return found
    return _plain(failure)


def _unreadable(failure: Failure) -> Diagnostic | None:
    """A character or a text that the language does not have."""
    token = failure.token
    if token is None:
        return None
    if token.type == "BAD_STRING":
        return failure.error("S006")
    if token.type in ("BAD_CHARACTER", "LBRACE", "RBRACE"):
        return failure.error("S005", character=_quoted(str(token)))
    if token.type == "WALRUS":
        name = str(failure.tokens[failure.at - 1]) if failure.at else "p"
        return failure.error("S012", name=name)
    return None


def _no_statement(failure: Failure) -> Diagnostic | None:
    """A line that begins with no word of a statement."""
    if not failure.beginning or failure.token is None:
        return None
    word = str(failure.token)
    if failure.at + 1 < len(failure.tokens) and failure.tokens[failure.at + 1].type == "WALRUS":
        return failure.error("S012", at=span_of(failure.tokens[failure.at + 1]), name=word)
    close = get_close_matches(word, STATEMENT_WORDS, 1, 0.6) if is_word(failure.token) else []
    way = f"did you mean `{close[0]}`?" if close else f"begin with one of: {', '.join(STATEMENT_WORDS)}"
    return failure.error("S003", word=_quoted(word), help=way)


def _glued_statement(failure: Failure) -> Diagnostic | None:
    """A second statement on the same line."""
    token = failure.token
    if token is None or str(token) not in STATEMENT_WORDS or token.type == "NAME" or failure.brackets:
        return None
    if "$END" not in failure.expected:
        return None
    return failure.error("S011", word=str(token))


def _reserved_name(failure: Failure) -> Diagnostic | None:
    """A reserved word where a name is declared."""
    token = failure.token
    if token is None or str(token) not in _RESERVED or failure.expected != {"NAME"}:
        return None
    return failure.error("S017", word=str(token))


def _misspelt_operator(failure: Failure) -> Diagnostic | None:
    """A name right before the failure, or before the open `[`, that is nearly an operator."""
    candidates = []
    if failure.at and failure.tokens[failure.at - 1].type == "NAME":
        candidates.append(failure.at - 1)
    if failure.brackets and failure.brackets[-1].type == "LSQB":
        candidates.append(failure.tokens.index(failure.brackets[-1]) - 1)
    if failure.token is not None and is_word(failure.token):
        candidates.append(failure.at)
    for i in candidates:
        word = str(failure.tokens[i])
        close = get_close_matches(word, OPERATOR_WORDS, 1, 0.75)
        if i > 2 and close and close[0] != word and failure.tokens[i].type == "NAME":
            return failure.error("S018", at=span_of(failure.tokens[i]), word=word, meant=close[0])
    return None


def _misspelt_clause(failure: Failure) -> Diagnostic | None:
    """A word that is nearly one of the words that fit."""
    token = failure.token
    words = [t.lower().removesuffix("_word") for t in failure.expected if t.isalpha() or t == "UNIT_WORD"]
    words = [w for w in words if w not in ("name", "number", "string")]
    if token is None or not is_word(token):
        return None
    close = get_close_matches(str(token), words, 1, 0.7)
    return failure.error("S018", word=str(token), meant=close[0]) if close else None


def _late_clause(failure: Failure) -> Diagnostic | None:
    """A clause after the formula."""
    token, tokens = failure.token, failure.tokens
    if (
        token is None
        or tokens[0].type not in ("HARD", "SOFT")
        or not any(t.type == "COLON" for t in tokens[: failure.at])
    ):
        return None
    if token.type == "STRING":
        return failure.error("S010", clause="the quoted text")
    after = tokens[failure.at + 1] if failure.at + 1 < len(tokens) else None
    wanted = _CLAUSE_WORDS.get(str(token))
    if wanted is not None and after is not None and wanted in (str(after), after.type):
        return failure.error("S010", clause=f"`{token} {after}`")
    return None


def _open_bracket(failure: Failure) -> Diagnostic | None:
    """A bracket that is never closed, or closed by one of the other kind."""
    if not failure.brackets:
        return _stray_bracket(failure)
    opening = failure.brackets[-1]
    closing = ")" if opening.type == "LPAR" else "]"
    wanted = "RPAR" if opening.type == "LPAR" else "RSQB"
    if wanted not in failure.expected:
        return None
    before = failure.tokens[failure.at - 1]
    label = Label(span_of(opening), "opened here", failure.source)
    return failure.error("S004", labels=(label,), closing=closing, before=_quoted(str(before)))


def _stray_bracket(failure: Failure) -> Diagnostic | None:
    token = failure.token
    if token is None or token.type not in ("RPAR", "RSQB"):
        return None
    return failure.error("S019", bracket=str(token))


def _no_comma(failure: Failure) -> Diagnostic | None:
    """`[a b]`: bounds without a comma."""
    if "COMMA" not in failure.expected or "RSQB" in failure.expected or not failure.brackets:
        return None
    if failure.token is None or failure.token.type not in ("NUMBER", "NAME", "INF"):
        return None
    low = str(failure.tokens[failure.at - 1])
    return failure.error("S021", low=low, high=str(failure.token))


def _cut_off(failure: Failure) -> Diagnostic | None:
    """A statement that ends where something must follow."""
    if failure.token is not None:
        return None
    last = str(failure.tokens[-1])
    return failure.error("S002", last=_quoted(last), expected=_expected(failure.expected))


def _plain(failure: Failure) -> Diagnostic:
    return failure.error("S001", found=_quoted(str(failure.token)), expected=_expected(failure.expected))


_RECOGNISERS: tuple[Callable[[Failure], Diagnostic | None], ...] = (
    _unreadable,
    _no_statement,
    _glued_statement,
    _reserved_name,
    _misspelt_operator,
    _misspelt_clause,
    _late_clause,
    _no_comma,
    _open_bracket,
    _cut_off,
)


def _quoted(text: str) -> str:
    shown = "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)
    return f"`{shown if len(shown) <= 30 else shown[:29] + '…'}`"


def _expected(terminals: frozenset[str]) -> str:
    """Name at most five things that fit, in the words of the language."""
    named: list[str] = []
    if {"NAME", "NUMBER", "LPAR"} <= terminals:
        named.append("a formula" if "NOT" in terminals else "a number or a signal")
    else:
        if {"AND", "OR"} <= terminals:
            named.append("an operator")
        elif "PLUS" in terminals:
            named.append("an arithmetic operator")
        named += [text for terminal, text in _SHOWN.items() if terminal in terminals]
    signs = {"COMMA": ",", "COLON": ":", "RPAR": ")", "RSQB": "]", "ASSIGN": "=", "LSQB": "["}
    if "AND" not in terminals and "NOT" not in terminals:
        signs_shown = [f"`{sign}`" for terminal, sign in signs.items() if terminal in terminals]
    else:
        signs_shown = [f"`{s}`" for t, s in signs.items() if t in terminals and t in ("RPAR", "RSQB", "COMMA")]
    named = signs_shown + named
    words = ["depends on", "scale", "bound", "unit", "in", "from"]
    named += [f"`{w}`" for w in words if w.split()[0].upper().replace("UNIT", "UNIT_WORD") in terminals]
    shown = named[:5]
    if len(shown) < 2:
        return shown[0] if shown else "nothing more"
    return f"{', '.join(shown[:-1])} or {shown[-1]}"
