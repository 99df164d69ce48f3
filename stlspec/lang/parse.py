"""From the tokens of one statement to its node, or to exactly one diagnostic.

In: a source text. Out: `Syntax`, the statements that parse and a diagnostic for each that does not. Tokens are
fed to Lark's LALR automaton one by one, which lets three rules stay out of the grammar: a contextual word is a
name where the automaton does not take the word; an alias such as `G` is an operator only where one may stand
and an operand follows, and never if the text declares it; a word after a number on its line is a unit.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from lark import Token

from stlspec.errors import Diagnostic, diagnostic
from stlspec.lang.automaton import END, automaton
from stlspec.lang.depth import DEEPEST, too_deep
from stlspec.lang.failure import Failure
from stlspec.lang.hints import describe
from stlspec.lang.nodes import (
    Expression,
    RequirementStatement,
    SignalStatement,
    Statement,
    Text,
    UseStatement,
    VerdictExpectation,
)
from stlspec.lang.repairs import repaired
from stlspec.lang.statements import (
    NOTHING_LOST,
    STATEMENT_WORDS,
    Lost,
    begins_like_statement,
    cut,
    first_on_line,
    is_word,
    lost,
    merged,
    stands_before_statement,
)
from stlspec.lang.tree import span_of
from stlspec.lang.units import is_unit_word
from stlspec.source import SourceText, Span

_TALLEST_STACK = 5000
_OPERAND_STARTS = frozenset(
    (
        "NAME NUMBER LPAR TRUE FALSE INF MINUS NOT BANG LSQB ALWAYS EVENTUALLY HISTORICALLY ONCE NEXT PREV WNEXT WPREV"
    ).split()
)
_NEVER_UNITS = frozenset({"SPEC", "USE", "TIME", "DEPENDS", "SCALE", "BOUND"})
"""Words that after a number begin a statement or a clause, in the wrong place: never units."""
_OPENING = frozenset({"LPAR", "LSQB", "LBRACE"})
_CLOSING = frozenset({"RPAR", "RSQB", "RBRACE"})
_NOW = ("now", "t")
"""Names that nothing declares: `5 m/now` divides by the time."""
_GUESS = diagnostic("S001", found="", expected="")
MOST_REPAIRS = 200
"""How many broken statements of a text are given a way out that was tried; trying costs time."""


@dataclass(frozen=True, slots=True)
class Syntax:
    """What a text says: its good statements, and one diagnostic for each broken one.

    names: what the text declares. lost: what broken statements may have been meant to declare; uses of it are
    not reported a second time. uses: each `use` with its file, and used: these and the files that they use, each
    after its own; both empty unless `using.parse_with_uses` made this.
    """

    source: SourceText
    statements: tuple[Statement, ...]
    diagnostics: tuple[Diagnostic, ...]
    comments: tuple[Text, ...]
    names: frozenset[str]
    requirement_names: frozenset[str]
    lost: Lost = NOTHING_LOST
    uses: tuple[tuple[UseStatement, "Syntax"], ...] = ()
    used: tuple["Syntax", ...] = ()


@dataclass(frozen=True, slots=True)
class Piece:
    """What the tokens between two cuts of a text say: one statement, or more if it is broken."""

    statements: tuple[Statement, ...]
    problems: tuple[Diagnostic, ...]
    lost: Lost


def parse(source: SourceText, names: frozenset[str] = frozenset()) -> Syntax:
    """Parse every statement of `source`; a broken one costs its neighbours nothing.

    names: declared elsewhere, by the files that the text uses; what reads as a name in formulas depends on them.
    """
    found = cut(source, automaton().lark)
    names |= found.names
    pieces: list[Piece] = []
    repairs = MOST_REPAIRS
    for tokens in found.statements:
        pieces.append(parse_piece(source, tokens, names, repairs))
        repairs -= len(pieces[-1].problems)
    return assembled(source, pieces, found.comments, found.names, found.requirement_names)


def parse_piece(source: SourceText, tokens: Sequence[Token], names: frozenset[str], repairs: int) -> Piece:
    """Parse the tokens between two cuts.

    Not in the paper: the language.

    Args:    names: what reads as a name; only those among the tokens matter. repairs: for how many broken
             statements a way out is tried.
    """
    statements: list[Statement] = []
    problems: list[Diagnostic] = []
    broken: list[Sequence[Token]] = []
    while tokens:
        node, problem, used = _parsed(source, tokens, names, repair=len(problems) < repairs)
        if node is not None:
            statements.append(node)
        if problem is not None:
            problems.append(problem)
            broken.append(tokens[:used] if node is None else _from(tokens[:used], problem))
        tokens = tokens[used:]
    return Piece(tuple(statements), tuple(problems), lost(broken))


def assembled(
    source: SourceText,
    pieces: Sequence[Piece],
    comments: tuple[Text, ...],
    names: frozenset[str],
    requirement_names: frozenset[str],
) -> Syntax:
    """Put the pieces of a text together."""
    statements = tuple(statement for piece in pieces for statement in piece.statements)
    problems = [problem for piece in pieces for problem in piece.problems]
    if not pieces:
        problems.append(diagnostic("S016", source=source, span=Span(0, 0)))
    problems += [problem for statement in statements for problem in _repeated(source, statement)]
    all_lost = merged([piece.lost for piece in pieces if piece.problems])
    return Syntax(source, statements, tuple(problems), comments, names, requirement_names, all_lost)


def _parsed(
    source: SourceText, tokens: Sequence[Token], names: frozenset[str], *, repair: bool
) -> tuple[Any, Diagnostic | None, int]:
    """Parse the statement that `tokens` begin with; see `_Feed.run`.

    One that is broken ends at the latest where a line looks like a misspelt beginning of the next.
    """
    node, problem, used = _Feed(source, tokens, names, repair=repair).run("statement")
    if problem is None or problem.span is None or used < len(tokens):
        return node, problem, used
    for i in range(1, len(tokens)):
        behind = span_of(tokens[i]).start > problem.span.start
        if begins_like_statement(tokens, i, names) or (behind and stands_before_statement(tokens, i)):
            if node is not None and not behind:
                continue
            if node is not None:
                return node, problem, i
            return _Feed(source, tokens[:i], names, repair=repair).run("statement")
    return node, problem, used


def _from(tokens: Sequence[Token], problem: Diagnostic) -> Sequence[Token]:
    """Return the tokens from where a problem begins."""
    assert problem.span is not None
    start = problem.span.start
    return [token for token in tokens if span_of(token).start >= start] or tokens[-1:]


def tokens_of(source: SourceText) -> tuple[Token, ...]:
    """Return the tokens of a text, comments left out, as the lexer has them. Not in the paper: for the formatter."""
    return tuple(token for piece in cut(source, automaton().lark).statements for token in piece)


def parse_formula(
    source: SourceText, names: frozenset[str] = frozenset()
) -> tuple[Expression | None, tuple[Diagnostic, ...]]:
    """Parse a text that is one formula, such as the argument of `stlspec eval`."""
    tokens = tokens_of(source)
    if not tokens:
        return None, (diagnostic("S016", source=source, span=Span(0, 0)),)
    node, problem, _used = _Feed(source, tokens, names).run("expression")
    return node, (problem,) if problem else ()


def following(tokens: Sequence[Token], names: frozenset[str]) -> frozenset[str]:
    """Return the terminals that may follow the beginning of a statement; none if it is broken already.

    Not in the paper: for editors. An alias at the end counts as an operator: an operand may be about to come.
    """
    return _Feed(SourceText("", ""), tokens, names, trying=True).following()


def _repeated(source: SourceText, statement: Statement) -> list[Diagnostic]:
    if not isinstance(statement, SignalStatement | RequirementStatement | VerdictExpectation):
        return []
    return [diagnostic("S020", source=source, span=c.span, clause=c.text) for c in statement.repeated]


class _Feed:
    """One walk of the automaton over the tokens of one statement."""

    def __init__(
        self,
        source: SourceText,
        tokens: Sequence[Token],
        names: frozenset[str],
        *,
        trying: bool = False,
        repair: bool = True,
    ) -> None:
        """trying: the tokens are a guess, whose faults need no description. repair: ways out are tried."""
        self.automaton = automaton()
        self.source = source
        self.tokens = tokens
        arguments = self._arguments()
        self.names = names | arguments if arguments else names
        self.brackets: list[Token] = []
        self.trying, self.repair = trying, repair

    def _arguments(self) -> frozenset[str]:
        """Return the names between the brackets of a `let`: they are names in its body."""
        tokens = self.tokens
        if len(tokens) < 4 or tokens[0].type != "LET" or tokens[2].type != "LPAR":
            return frozenset()
        inside = []
        for token in tokens[3:]:
            if token.type == "RPAR":
                break
            inside.append(str(token))
        return frozenset(inside)

    def run(self, start: str) -> tuple[Any, Diagnostic | None, int]:
        """Feed the tokens. Returns: the node or None, the diagnostic or None, how many tokens were used."""
        self.start = start
        self.walk = walk = self.automaton.walk(start)
        self.fed: list[Token] = []
        tokens, fed = self.tokens, self.fed
        if start == "statement" and not walk.accepts(tokens[0].type):
            return None, self._problem(0, beginning=True), len(tokens)
        i = 0
        while i < len(tokens):
            token, width = self._read(i)
            if not walk.take(token):
                return self._stopped(i)
            fed.append(token)
            if self._nests_too_deep(token):
                problem = diagnostic("S007", source=self.source, span=span_of(token), deepest=DEEPEST)
                return None, problem, len(tokens)
            i += width
        if not walk.accepts(END):
            return None, self._problem(len(tokens)), len(tokens)
        node = walk.finish()
        return node, self._too_deep(node), len(tokens)

    def following(self) -> frozenset[str]:
        """Feed the tokens as the beginning of a statement, and return what fits behind them."""
        self.walk = self.automaton.walk("statement")
        end = len(self.tokens)
        self.tokens = [*self.tokens, *(Token.new_borrow_pos("NAME", "_", token) for token in self.tokens[-1:])]
        i = 0
        while i < end:
            token, width = self._read(i)
            if not self.walk.take(token):
                return frozenset()
            i += width
        return self.walk.expected()

    def _stopped(self, i: int) -> tuple[Any, Diagnostic | None, int]:
        """Tell what is wrong at token `i`, which does not fit.

        A statement that is whole ends before it if it begins a line. What follows is then a piece of its own:
        parsed if it begins with a statement's word, else one diagnostic.
        """
        new_line = i > 0 and self.start == "statement" and first_on_line(self.tokens, i)
        if self.trying and not new_line:
            return None, _GUESS, len(self.tokens)
        self.walk = self.automaton.walk(self.start)
        for token in self.fed:
            self.walk.take(token)
        if not new_line or not self.walk.accepts(END):
            return None, self._problem(i), len(self.tokens)
        node = self.walk.finish()
        problem = self._too_deep(node)
        if str(self.tokens[i]) in STATEMENT_WORDS:
            return node, problem, i
        return node, problem or self._problem(i, beginning=True), len(self.tokens)

    def _too_deep(self, node: Any) -> Diagnostic | None:
        """Each level takes a token, so that few statements need a look."""
        return too_deep(self.source, node) if len(self.fed) > DEEPEST else None

    def _nests_too_deep(self, token: Token) -> bool:
        """Note a bracket; tell whether too many are open, or too much waits for its end."""
        if token.type in _OPENING:
            self.brackets.append(token)
        elif token.type in _CLOSING and self.brackets:
            self.brackets.pop()
        return len(self.brackets) > DEEPEST or len(self.walk.states) > _TALLEST_STACK

    def _read(self, i: int) -> tuple[Token, int]:
        """Return token `i` as the automaton is to see it, and how many tokens it stands for."""
        token = self.tokens[i]
        if i and self.tokens[i - 1].type == "NUMBER" and "UNIT" in self.walk.row and self._is_unit(i):
            return self._unit(i)
        if token.type in self.automaton.contextual and not self._is_operator(token, i):
            return Token.new_borrow_pos("NAME", str(token), token), 1
        return token, 1

    def _is_operator(self, token: Token, i: int) -> bool:
        """Tell whether a contextual word stands for the word, not for a name.

        A look at the state's row is not enough: behind the `]` of a window it has the clauses of a signal, whose
        range ends in the same state.
        """
        if not self.walk.accepts(token.type):
            return False
        is_prefix = token.type in self.automaton.prefix_aliases
        if not is_prefix and token.type not in self.automaton.infix_aliases:
            return True
        if str(token) in self.names:
            return False
        return not is_prefix or self._operand_follows(i)

    def _operand_follows(self, i: int) -> bool:
        if i + 1 >= len(self.tokens):
            return False
        after = self.tokens[i + 1].type
        automaton = self.automaton
        return after in _OPERAND_STARTS or after in automaton.contextual

    def _is_unit(self, i: int) -> bool:
        token = self.tokens[i]
        if token.line != self.tokens[i - 1].line or not is_word(token) or token.type in _NEVER_UNITS:
            return False
        if token.type in self.automaton.infix_aliases and str(token) not in self.names:
            return not self._operand_follows(i)
        return token.type == "NAME" or token.type in self.automaton.contextual

    def _unit(self, i: int) -> tuple[Token, int]:
        """Merge `m`, `/`, `s`, `**`, `2` into one UNIT where they stand without blanks."""
        tokens, end = self.tokens, i + 1
        while end + 1 < len(tokens) and tokens[end].start_pos == tokens[end - 1].end_pos:
            sign, after = tokens[end], tokens[end + 1]
            glued = after.start_pos == sign.end_pos
            if not glued or not (
                (sign.type == "SLASH" and self._divides(end + 1)) or (sign.type == "POWER" and after.type == "NUMBER")
            ):
                break
            end += 2
        token = Token.new_borrow_pos("UNIT", "".join(tokens[i:end]), tokens[i])
        token.end_pos = tokens[end - 1].end_pos
        return token, end - i

    def _divides(self, i: int) -> bool:
        """Tell whether token `i`, glued behind `120 mg/`, is a part of the unit: no name, no call, and no word."""
        token = self.tokens[i]
        if is_unit_word(str(token)):
            return True
        called = i + 1 < len(self.tokens) and self.tokens[i + 1].type == "LPAR"
        return token.type == "NAME" and not called and str(token) not in self.names and str(token) not in _NOW

    def _problem(self, i: int, *, beginning: bool = False) -> Diagnostic:
        """Describe a failure at token `i`, with a way out that works if there is one."""
        if self.trying:
            return _GUESS
        failure = self._failure(i, beginning=beginning)
        found = describe(failure)
        return repaired(found, failure, self._parses) if self.repair else found

    def _parses(self, tokens: Sequence[Token]) -> bool:
        """Tell whether other tokens are one whole statement, or formula."""
        if not tokens:
            return False
        feed = _Feed(self.source, tokens, self.names, trying=True)
        _, problem, used = feed.run(self.start)
        return problem is None and used == len(tokens)

    def _failure(self, i: int, *, beginning: bool = False) -> Failure:
        expected = self.walk.expected()
        # After a number a unit always fits: it is named only where nothing else does.
        expected = expected - {"UNIT"} or expected
        return Failure(self.source, tuple(self.tokens), i, expected, tuple(self.brackets), beginning, self.names)
