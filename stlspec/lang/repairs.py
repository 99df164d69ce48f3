"""Ways out of a broken statement that have been tried: each makes the statement parse.

In: a diagnostic on a statement, where it failed, and a function that tells whether other tokens parse. Out: the
diagnostic with the edits that help, and its help in their words. Where nothing that was tried helps, the
diagnostic stays as it is: a fix that fixes nothing is worse than none.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from lark import Token

from stlspec.errors import Diagnostic, Edit, Fix
from stlspec.lang.automaton import automaton
from stlspec.lang.expected import quoted
from stlspec.lang.failure import Failure
from stlspec.lang.statements import is_word, lexed
from stlspec.lang.tree import span_of
from stlspec.source import Span

Tokens = Sequence[Token]
Parses = Callable[[Tokens], bool]

_LONGEST = 400
"""Tokens of a statement; a longer one is not tried again and again."""
_TRIES = 24
_CLOSING = {"LPAR": (")", "RPAR"), "LSQB": ("]", "RSQB"), "LBRACE": ("}", "RBRACE")}
_COMPARISONS = frozenset({"LT", "LE", "GT", "GE", "EQ", "NE", "ASSIGN"})
_LOGIC = frozenset(
    {"AND", "AMPERSAND", "AMPERSANDS", "OR", "BAR", "BARS", "XOR", "IMPLIES", "ARROW", "FAT_ARROW", "IFF"}
)
_MUST_STAND = {"COLON": ":", "ASSIGN": "=", "ON": "on", "COMMA": ",", "UNIT_WORD": "unit", "IN": "in", "GE": ">="}
"""Terminals with one spelling that a statement cannot do without, in the order in which they are tried."""
_OPERANDS = frozenset({"NAME", "NUMBER", "STRING", "TRUE", "FALSE", "INF"})


def repaired(found: Diagnostic, failure: Failure, parses: Parses) -> Diagnostic:
    """Add to a diagnostic a way out that works.

    Not in the paper: the language.

    Args:    found: what `hints.describe` says of the failure. parses: tells whether tokens are a whole statement.
    Returns: the diagnostic, perhaps at a better place, with a fix if one was found.
    """
    if found.code == "S001" and found.fixes:
        return found if _clears(found.fixes[0], failure, parses) else replace(found, fixes=())
    if len(failure.tokens) > _LONGEST or found.fixes or (found.code == "S001" and found.help):
        return found
    match found.code:
        case "S001":
            return _with_sign(found, failure, parses) or _without(found, failure, parses)
        case "S002" if failure.token is None:
            return _shortened(found, failure, parses)
        case "S002":
            return _line_shortened(found, failure, parses)
        case "S004":
            return _closed(found, failure, parses)
        case "S006" | "S019" | "S021":
            return _direct(found, failure, parses)
    return found


def _clears(fix: Fix, failure: Failure, parses: Parses) -> bool:
    """Tell whether a statement parses when its text is edited."""
    if len(failure.tokens) > _LONGEST:
        return False
    start = span_of(failure.tokens[0]).start
    moved = [Edit(Span(edit.span.start - start, edit.span.end - start), edit.text) for edit in fix.edits]
    text = Fix(fix.title, tuple(moved)).applied(failure.text(failure.tokens))
    return parses(lexed(text, automaton().lark)[0])


def _token(kind: str, text: str, behind: Token) -> Token:
    return Token.new_borrow_pos(kind, text, behind)


def _fixed(found: Diagnostic, way: str, *edits: Edit) -> Diagnostic:
    return replace(found, help=way, fixes=(Fix(way, edits),))


def _removal(failure: Failure, start: int, end: int) -> Edit:
    """Return the edit that removes tokens, and the gap before them."""
    last = span_of(failure.tokens[end - 1]).end
    first = span_of(failure.tokens[start - 1]).end if start else span_of(failure.tokens[0]).start
    gap = failure.source.slice(Span(first, span_of(failure.tokens[start]).start))
    return Edit(Span(first if not gap.strip(" \t") else span_of(failure.tokens[start]).start, last), "")


def _with_sign(found: Diagnostic, failure: Failure, parses: Parses) -> Diagnostic | None:
    """Write a sign or a word that must stand here, in front of what stands here or in its place."""
    at, tokens = failure.at, failure.tokens
    missing = [(k, text) for k, text in _MUST_STAND.items() if k in failure.expected and not _compares(k, failure)]
    for kind, text in missing:
        if at and parses((*tokens[:at], _token(kind, text, tokens[at - 1]), *tokens[at:])):
            end = span_of(tokens[at - 1]).end
            edit = Edit(Span(end, end), text if text in ":," else f" {text}")
            before = quoted(str(tokens[at - 1]))
            return failure.error("S026", at=Span(end, end), edits=(edit,), missing=text, before=before)
    if "STRING" in failure.expected and is_word(tokens[at]):
        return _quoted(found, failure, parses)
    for kind, text in missing:
        if parses((*tokens[:at], _token(kind, text, tokens[at]), *tokens[at + 1 :])):
            way = f"write `{text}` in place of {quoted(str(tokens[at]))}"
            return _fixed(found, way, Edit(span_of(tokens[at]), text))
    return None


def _quoted(found: Diagnostic, failure: Failure, parses: Parses) -> Diagnostic | None:
    """Put quotes around a text that has none, up to the next blank: `unit m/s`."""
    at, tokens = failure.at, failure.tokens
    end = at + 1
    while end < len(tokens) and span_of(tokens[end]).start == span_of(tokens[end - 1]).end:
        end += 1
    span = span_of(tokens[at]).to(span_of(tokens[end - 1]))
    text = f'"{failure.source.slice(span)}"'
    if '"' in text[1:-1] or not parses((*tokens[:at], _token("STRING", text, tokens[at]), *tokens[end:])):
        return None
    return replace(_fixed(found, f"write `{text}`", Edit(span, text)), span=span)


def _compares(kind: str, failure: Failure) -> bool:
    """Tell whether a sign would compare two numbers here, not begin a value or bound a margin."""
    before = failure.tokens[: failure.at]
    if kind == "ASSIGN":
        return any(token.type in ("ASSIGN", "COLON") for token in before)
    return kind == "GE" and before[-1].type != "MARGIN"


def _without(found: Diagnostic, failure: Failure, parses: Parses) -> Diagnostic:
    """Leave out what does not fit, or an operator before it that has nothing on its right."""
    at, tokens = failure.at, failure.tokens
    token, before = tokens[at], tokens[at - 1] if at else None
    dangles = before is not None and before.type not in (*_OPERANDS, "RPAR", "RSQB", "COLON")
    if dangles and token.type in ("RPAR", "RSQB") and parses((*tokens[: at - 1], *tokens[at:])):
        way = f"remove {quoted(str(before))}, or write {found.label.removeprefix('expected ')} after it"
        return _fixed(found, way, _removal(failure, at - 1, at))
    if token.type not in _OPERANDS and parses((*tokens[:at], *tokens[at + 1 :])):
        return _fixed(found, f"remove {quoted(str(token))}", _removal(failure, at, at + 1))
    return found


def _shortened(found: Diagnostic, failure: Failure, parses: Parses) -> Diagnostic:
    """Leave out the end of a statement that is cut off, as little of it as makes the rest whole."""
    tokens = failure.tokens
    if failure.expected == {"UNIT"}:
        number = str(tokens[-1])
        end = span_of(tokens[-1]).end
        return _fixed(found, f"write a unit after {quoted(number)}, such as `{number} s`", Edit(Span(end, end), " s"))
    for start in range(len(tokens) - 1, max(1, len(tokens) - _TRIES), -1):
        if tokens[start].type in _COMPARISONS and tokens[0].type != "PARAM":
            break  # what remained would be a number, where a formula must stand
        if parses(tokens[:start]):
            text = failure.source.slice(Span(span_of(tokens[start]).start, span_of(tokens[-1]).end))
            way = f"complete the statement here, or remove {quoted(' '.join(text.split()))}"
            return _fixed(found, way, _removal(failure, start, len(tokens)))
    return replace(found, help="complete the statement here")


def _line_shortened(found: Diagnostic, failure: Failure, parses: Parses) -> Diagnostic:
    """Leave out the last token of a line, behind which something is missing."""
    at, tokens = failure.at, failure.tokens
    last = tokens[at - 1]
    if last.type in _COMPARISONS or not parses((*tokens[: at - 1], *tokens[at:])):
        return found
    way = f"remove {quoted(str(last))}, or write {found.label.removeprefix('expected ')} after it"
    return _fixed(found, way, _removal(failure, at - 1, at))


def _closed(found: Diagnostic, failure: Failure, parses: Parses) -> Diagnostic:
    """Close a bracket where the statement becomes whole."""
    tokens, opening = failure.tokens, failure.brackets[-1]
    sign, kind = _CLOSING[opening.type]
    if found.help.startswith(f"write `{sign}` in place"):
        token = tokens[failure.at]
        if parses((*tokens[: failure.at], _token(kind, sign, token), *tokens[failure.at + 1 :])):
            return _fixed(found, found.help, Edit(span_of(token), sign))
    for at in _places(found, failure, failure.place(opening)):
        if parses((*tokens[:at], _token(kind, sign, tokens[at - 1]), *tokens[at:])):
            return _inserted(found, failure, at, sign)
    all_open = [_CLOSING[bracket.type] for bracket in reversed(failure.brackets)]
    at = failure.at
    more = [_token(terminal, text, tokens[at - 1]) for text, terminal in all_open]
    if len(more) > 1 and parses((*tokens[:at], *more, *tokens[at:])):
        return _inserted(found, failure, at, "".join(text for text, _ in all_open))
    return found


def _inserted(found: Diagnostic, failure: Failure, at: int, signs: str) -> Diagnostic:
    end = span_of(failure.tokens[at - 1]).end
    way = f"write `{signs}` after {quoted(str(failure.tokens[at - 1]))}"
    fixed = _fixed(found, way, Edit(Span(end, end), signs))
    return replace(fixed, span=Span(end, end), label=f"write `{signs}` here")


def _places(found: Diagnostic, failure: Failure, opening: int) -> Iterator[int]:
    """Yield where the bracket may have stood, the likeliest first, as indices of the token behind it."""
    tokens = failure.tokens
    if tokens[opening].type == "LPAR":
        yield from _calls(failure)
        yield failure.at
        yield from range(failure.at - 1, max(opening + 1, failure.at - _TRIES), -1)
        return
    if found.span is not None:
        yield next((i for i, t in enumerate(tokens) if span_of(t).start >= found.span.start), len(tokens))
    comma = next((i for i in range(opening, len(tokens)) if tokens[i].type in ("COMMA", "COLON")), opening)
    yield from range(comma + 2, min(len(tokens), comma + 2 + _TRIES))


def _calls(failure: Failure) -> Iterator[int]:
    """Yield where the arguments of a function run into a comparison: it takes numbers, and gives one."""
    tokens = failure.tokens
    for i in range(1, len(tokens)):
        name = tokens[i - 1]
        if tokens[i].type != "LPAR" or name.type != "NAME" or str(name) in failure.names:
            continue
        depth = 0
        for k in range(i + 1, len(tokens)):
            depth += (tokens[k].type in _CLOSING) - (tokens[k].type in ("RPAR", "RSQB", "RBRACE"))
            if depth < 0:
                break
            if depth == 0 and (tokens[k].type in _COMPARISONS or tokens[k].type in _LOGIC):
                yield k
                break


def _direct(found: Diagnostic, failure: Failure, parses: Parses) -> Diagnostic:
    """Close a text at the end of its line, leave out a bracket, write a comma."""
    tokens, at = failure.tokens, failure.at
    token = failure.token
    assert token is not None
    span = span_of(token)
    if found.code == "S006" and parses((*tokens[:at], _token("STRING", f'{token}"', token), *tokens[at + 1 :])):
        return _fixed(found, found.help, Edit(Span(span.end, span.end), '"'))
    if found.code == "S019" and parses((*tokens[:at], *tokens[at + 1 :])):
        return _fixed(found, found.help, _removal(failure, at, at + 1))
    if found.code == "S021" and parses((*tokens[:at], _token("COMMA", ",", tokens[at - 1]), *tokens[at:])):
        end = span_of(tokens[at - 1]).end
        gap = "" if failure.source.text[end : end + 1].isspace() else " "
        if is_word(token) or str(token)[:1].isdigit():
            return _fixed(found, found.help, Edit(Span(end, end), f",{gap}"))
    return found
