"""Units that are written in another way behind a number, and what is written here.

In: a `Failure`. Out: the one diagnostic with its edits, or None where it is no unit that stopped the parser.
"""

from collections.abc import Sequence

from lark import Token

from stlspec.errors import Diagnostic, Edit
from stlspec.lang.failure import Failure
from stlspec.lang.habits import habit
from stlspec.lang.statements import is_word
from stlspec.lang.tree import span_of
from stlspec.lang.units import dimension, is_unit_word, respelt
from stlspec.source import Span

LEAVE_OUT = "leave the unit out: a number takes that of the other side"


def unit_of_signal(failure: Failure) -> Diagnostic | None:
    """Describe `signal d [m/s]` and `signal d (m/s)`. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if tokens[0].type != "SIGNAL" or at < 2 or at + 2 >= len(tokens) or tokens[at].type not in ("LSQB", "LPAR"):
        return None
    ends = next((i for i in range(at + 2, len(tokens)) if tokens[i].type in ("RSQB", "RPAR")), None)
    unit = None if ends is None else respelt(failure.text(tokens[at + 1 : ends]))
    if ends is None or unit is None or not _is_unit(failure, unit) or "UNIT_WORD" not in failure.expected:
        return None
    whole = span_of(tokens[at]).to(span_of(tokens[ends]))
    return habit(failure, f'write `unit "{unit}"`', Edit(whole, f'unit "{unit}"'), at=whole)


def unit_of_number(failure: Failure) -> Diagnostic | None:
    """Describe `3 "m/s"`, `3 [m/s]`, `3 1/m` and `3 N m`. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if failure.token is None or at < 2 or tokens[0].type not in ("HARD", "SOFT", "LET"):
        return None
    number = at - 1 if tokens[at - 1].type == "NUMBER" else at - 2
    if tokens[number].type != "NUMBER" or tokens[number].line != failure.token.line:
        return None
    begin = number + 1
    end = _end(tokens, begin, at)
    if end is None:
        return None
    unit = failure.text(tokens[begin:end])
    if tokens[begin].type in ("STRING", "LSQB"):
        unit = unit[1:-1].strip()
    written = respelt(unit)
    whole = span_of(tokens[begin]).to(span_of(tokens[end - 1]))
    if written is None or not _is_unit(failure, written):
        return None
    if "*" in written.replace("**", "") or not written[:1].isalpha():
        gap = Span(span_of(tokens[number]).end, whole.end)
        return habit(failure, LEAVE_OUT, Edit(gap, ""), at=whole, wanted="a unit such as `m/s`")
    way = f"write `{tokens[number]} {written}`: behind a number a unit stands as it is"
    return habit(failure, way, Edit(whole, written), at=whole, wanted="a unit such as `m/s`")


def unit_of_param(failure: Failure) -> Diagnostic | None:
    """Describe `[0, T s]`, a unit behind a name. Not in the paper: the language."""
    at, tokens, token = failure.at, failure.tokens, failure.token
    if token is None or not failure.brackets or failure.brackets[-1].type != "LSQB" or at + 1 >= len(tokens):
        return None
    name = tokens[at - 1]
    ends = tokens[at + 1].type in ("COMMA", "COLON", "RSQB")
    if name.type != "NAME" or not ends or not is_word(token) or not is_unit_word(str(token)):
        return None
    gap = Span(span_of(name).end, span_of(token).end)
    way = f"write `{name}`: a param carries its own unit, as in `param {name} = 5 {token}`"
    return habit(failure, way, Edit(gap, ""), wanted="the end of the bound")


def _end(tokens: Sequence[Token], begin: int, at: int) -> int | None:
    """Return the index behind what may be a unit, which begins right behind a number and holds token `at`."""
    first = tokens[begin]
    if first.type == "STRING":
        return begin + 1 if at == begin else None
    if first.type == "LSQB":
        ends = next((i for i in range(begin, len(tokens)) if tokens[i].type == "RSQB"), None)
        return ends + 1 if ends is not None and at == begin else None
    if first.type == "NUMBER":
        over = [token.type for token in tokens[begin + 1 : begin + 2]] == ["SLASH"]
        return begin + 3 if str(first) == "1" and over and begin + 2 < len(tokens) else None
    return at + 1 if at == begin + 1 and is_word(first) and is_word(tokens[at]) else None


def _is_unit(failure: Failure, unit: str) -> bool:
    """Tell whether all words of a unit are units, or the text declares the whole for a signal."""
    words = dimension(unit)
    if not words or failure.names & words.keys():
        return False
    return all(map(is_unit_word, words)) or f'unit "{unit}"' in failure.source.text
