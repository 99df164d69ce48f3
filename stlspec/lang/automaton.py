"""Lark's LALR automaton, walked token by token by a reader that may ask first whether a token fits.

In: a Lark instance made from `stl.lark`. Out: `Automaton`, its tables, and `Walk`, one run over them. The tables,
and the functions that build nodes, are Lark's; only the loop is not, for two reasons. Lark's raises where a token
does not fit, where this one says so. And an operand climbs a dozen rules that pass it on as it is, from `operand`
to `expression`: these cost a call each in Lark, and one look into the table here.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from lark import Lark, Token
from lark.parsers.lalr_analysis import Shift

from stlspec.lang import grammar
from stlspec.lang.tree import TreeBuilder

END = "$END"
_PREFIX_RULES = frozenset({"always", "eventually", "historically", "once", "next", "prev"})
_INFIX_RULES = frozenset({"until", "since", "unless", "release"})
_CLAUSES = ("SPEC USE TIME DEPENDS ON SCALE BOUND UNIT_WORD IN FROM HOLDS FAILS EPISODE AT MARGIN IS OUTRANKS").split()


class Reduction(NamedTuple):
    """What a rule does: `size` children become one `origin`, made by `build`; None: the one child is passed on."""

    size: int
    origin: str
    build: Callable[[list[Any]], Any] | None


Row = dict[str, Any]
"""For each symbol what a state does with it: the number of the next state, or a `Reduction` that comes first."""


class _Rows(dict[int, Row]):
    """The rows of Lark's table, each put into the form of `Row` when it is first needed."""

    def __init__(self, states: Any, callbacks: Any) -> None:
        super().__init__()
        self._states, self._callbacks = states, callbacks

    def __missing__(self, state: int) -> Row:
        row = {
            symbol: argument if action is Shift else self._reduction(argument)
            for symbol, (action, argument) in self._states[state].items()
        }
        self[state] = row
        return row

    def _reduction(self, rule: Any) -> Reduction:
        size = len(rule.expansion)
        passes = size == 1 and rule.options.expand1 and rule.alias is None
        return Reduction(size, rule.origin.name, None if passes else self._callbacks[rule])


class Automaton:
    """The tables of the grammar, and the alias words read off its rules; without state, so that threads share it."""

    def __init__(self, lark: Lark) -> None:
        self.lark = lark
        words = {t.name: str(t.pattern.value) for t in lark.terminals}
        self.prefix_aliases = _aliases(lark, words, _PREFIX_RULES)
        self.infix_aliases = _aliases(lark, words, _INFIX_RULES)
        self.contextual = frozenset(_CLAUSES) | self.prefix_aliases | self.infix_aliases
        conf = lark.parse_interactive("", start="statement").parser_state.parse_conf
        self._rows = _Rows(conf.states, conf.callbacks)
        self._table = conf.parse_table

    def walk(self, start: str) -> "Walk":
        """Begin at a start symbol: `statement` or `expression`."""
        return Walk(self._rows, self._table.start_states[start], self._table.end_states[start])


def _aliases(lark: Lark, words: dict[str, str], rules: frozenset[str]) -> frozenset[str]:
    terminals = {rule.expansion[0].name for rule in lark.rules if rule.origin.name in rules}
    return frozenset(name for name in terminals if words[name] not in rules)


@cache
def automaton() -> Automaton:
    """Return the automaton of the language, its rules building the nodes of the syntax tree."""
    return Automaton(grammar.parser(TreeBuilder()))


class Walk:
    """One run over the tables: the states on the way, and beside them what was read and built."""

    __slots__ = ("_end", "_rows", "_values", "states")

    def __init__(self, rows: _Rows, start: int, end: int) -> None:
        self._rows = rows
        self._end = end
        self._values: list[Any] = []
        self.states = [start]

    @property
    def row(self) -> Row:
        """What can be done in the present state; not all of it leads on, see `accepts`."""
        return self._rows[self.states[-1]]

    def take(self, token: Token) -> bool:
        """Read one token. Returns: False if it does not fit; then the walk is over, for it may be half done."""
        states = self.states
        action = self._reduced(token.type)
        if action is None:
            return False
        states.append(action)
        self._values.append(token)
        return True

    def finish(self) -> Any:
        """Return the node of all that was read, which `accepts(END)` has found to be whole."""
        self._reduced(END)
        return self._values[-1]

    def _reduced(self, terminal: str) -> int | None:
        """Make the reductions that come before a terminal. Returns: the state behind it; None: it does not fit."""
        rows, states, values = self._rows, self.states, self._values
        action = rows[states[-1]].get(terminal)
        while isinstance(action, Reduction):
            size, origin, build = action
            if build is None:
                states[-1] = rows[states[-2]][origin]
            else:
                if size:
                    children = values[-size:]
                    del values[-size:], states[-size:]
                else:
                    children = []
                values.append(build(children))
                states.append(rows[states[-1]][origin])
            action = rows[states[-1]].get(terminal)
        after: int | None = action
        return after

    def accepts(self, terminal: str) -> bool:
        """Tell whether `terminal` fits, by a walk over states only, which changes nothing."""
        rows, states = self._rows, self.states
        action = rows[states[-1]].get(terminal)
        if isinstance(action, Reduction):
            states = states[:]
        while isinstance(action, Reduction):
            size, origin, _ = action
            if size:
                del states[-size:]
            states.append(rows[states[-1]][origin])
            if terminal == END and states[-1] == self._end:
                return True
            action = rows[states[-1]].get(terminal)
        return action is not None

    def expected(self) -> frozenset[str]:
        """Return the terminals that fit."""
        return frozenset(symbol for symbol in self.row if symbol.isupper() and self.accepts(symbol))
