"""Windows of time as people say them, and what is written here: `p within 5 s`, `p in [0, 10]`, `forall t in ...`.

In: a `Failure`. Out: the one diagnostic with its edits, or None where it is not such a phrase that stopped the parser.
"""

from collections.abc import Sequence

from lark import Token

from stlspec.errors import Diagnostic, Edit
from stlspec.lang.failure import TEMPORAL, Failure
from stlspec.lang.habits import habit, shortened
from stlspec.lang.statements import is_word
from stlspec.lang.tree import span_of
from stlspec.lang.units import is_unit_word
from stlspec.source import Span

_BETWEEN = frozenset({"to", "and", "till", "through", "thru", "upto"})
_QUANTIFIERS = {"forall": "always", "foreach": "always", "exists": "eventually", "exist": "eventually"}
_WITHIN = frozenset({"within", "during", "for"})
_LIMITS = frozenset({("at", "least"), ("at", "most"), ("the", "next")})
_LOGIC = frozenset("AND AMPERSAND AMPERSANDS OR BAR BARS XOR IFF UNTIL U SINCE S UNLESS W RELEASE R".split())
_BEGINNINGS = frozenset("COLON IMPLIES ARROW FAT_ARROW ASSIGN LPAR".split())
_COMPARISONS = frozenset({"LT", "LE", "GT", "GE", "EQ", "NE", "ASSIGN"})


def spoken_bounds(failure: Failure) -> Diagnostic | None:
    """Describe `[-10 to 80]`: a word between the bounds. Not in the paper: the language."""
    if not failure.brackets or failure.brackets[-1].type != "LSQB":
        return None
    opening, tokens = failure.place(failure.brackets[-1]), failure.tokens
    ends = next((i for i in range(opening, len(tokens)) if tokens[i].type == "RSQB"), None)
    if ends is None or any(t.type in ("COMMA", "COLON", "LSQB") for t in tokens[opening + 1 : ends]):
        return None
    words = [i for i in range(opening + 2, ends - 1) if str(tokens[i]) in _BETWEEN - failure.names]
    if len(words) != 1:
        return None
    (word,) = words
    low, high = failure.text(tokens[opening + 1 : word]), failure.text(tokens[word + 1 : ends])
    edit = Edit(Span(span_of(tokens[word - 1]).end, span_of(tokens[word]).end), ",")
    return habit(failure, f"write `[{low}, {high}]`", edit, at=span_of(tokens[word]), wanted="a comma")


def within(failure: Failure) -> Diagnostic | None:
    """Describe `p within 5 s`, `p for at least 5 s` and `eventually within 5 s p`. Not in the paper: the language."""
    opening = failure.place(failure.brackets[-1]) if failure.brackets else 0
    for at in (failure.at, failure.at - 1, opening - 1):
        if 0 < at < len(failure.tokens) - 1 and str(failure.tokens[at]) in _WITHIN - failure.names:
            break
    else:
        return None
    tokens, word = failure.tokens, str(failure.tokens[at])
    begin = at + 3 if tuple(map(str, tokens[at + 1 : at + 3])) in _LIMITS else at + 1
    end = _window_end(failure, begin) if begin < len(tokens) else None
    if end is None:
        return None
    text = failure.text(tokens[begin:end])
    window = text if text.startswith("[") else f"[0, {text}]"
    whole = span_of(tokens[at]).to(span_of(tokens[end - 1]))
    operator = "always" if word in ("during", "for") else "eventually"
    if tokens[at - 1].type in TEMPORAL:
        gap = Span(span_of(tokens[at - 1]).end, whole.end)
        way = f"write `{tokens[at - 1]}{window}`"
        return habit(failure, way, Edit(gap, window), at=whole, wanted="an interval or a formula")
    return _moved_window(failure, at, end, f"{operator}{window}")


def _moved_window(failure: Failure, at: int, end: int, operator: str) -> Diagnostic | None:
    """Put `operator` before the formula that ends before token `at`; tokens up to `end` were its window."""
    tokens = failure.tokens
    begin = _operand(tokens, at)
    if begin is None:
        return habit(failure, f"write `{operator}` before the formula", at=span_of(tokens[at]), wanted="an operator")
    operand = failure.text(tokens[begin:at])
    inner = operand if at - begin == 1 or (tokens[begin].type == "LPAR") else f"({operand})"
    whole = span_of(tokens[begin]).to(span_of(tokens[end - 1]))
    way = f"write `{operator} {shortened(inner)}`"
    edit = Edit(whole, f"{operator} {inner}")
    return habit(failure, way, edit, at=span_of(tokens[at]), wanted="an operator")


def _operand(tokens: Sequence[Token], at: int) -> int | None:
    """Return where the formula begins that ends before token `at`; None if that can be read in two ways."""
    depth = 0
    for i in range(at - 1, 0, -1):
        kind = tokens[i].type
        if kind in ("RPAR", "RSQB"):
            depth += 1
        elif depth and kind in ("LPAR", "LSQB"):
            depth -= 1
        elif not depth and (kind in _LOGIC or kind == "LSQB" or (kind in TEMPORAL and i < at - 1)):
            return None
        elif not depth and kind in _BEGINNINGS:
            return i + 1 if i + 1 < at else None
    return None


def _window_end(failure: Failure, at: int) -> int | None:
    """Return the index behind `[0, 5]`, `5` or `5 s` that begins with token `at`; None if there is none."""
    tokens = failure.tokens
    if tokens[at].type == "LSQB":
        return next((i + 1 for i in range(at, len(tokens)) if tokens[i].type == "RSQB"), None)
    if tokens[at].type != "NUMBER" and str(tokens[at]) not in failure.names:
        return None
    unit = at + 1 < len(tokens) and tokens[at].type == "NUMBER" and is_unit_word(str(tokens[at + 1]))
    return at + 2 if unit and str(tokens[at + 1]) not in failure.names else at + 1


def window_behind(failure: Failure) -> Diagnostic | None:
    """Describe `p in [0, 10]`, a window or a range behind a formula. Not in the paper: the language."""
    tokens, at = failure.tokens, failure.at
    at -= failure.token is not None and failure.token.type == "LSQB" and tokens[at - 1].type == "IN"
    if not 2 < at < len(tokens) - 1 or tokens[at].type != "IN" or tokens[at + 1].type != "LSQB":
        return None
    end = _window_end(failure, at + 1)
    colon = next((i for i, t in enumerate(tokens) if t.type in ("COLON", "ASSIGN")), at)
    if end is None or colon >= at or tokens[0].type not in ("HARD", "SOFT", "LET"):
        return None
    window = failure.text(tokens[at + 1 : end])
    begin = _operand(tokens, at)
    if begin is None:
        return _at_operator(failure, at, end, window)
    text = shortened(failure.text(tokens[begin:at]))
    if any(token.type in _COMPARISONS for token in tokens[begin:at]):
        way = f"write `always{window} ({text})`, or `eventually{window} ({text})`"
    else:
        low, _, high = window[1:-1].replace(":", ",").partition(",")
        values = f"{low.strip()} <= {text} and {text} <= {high.strip()}"
        way = f"for values write `{values}`; for times `always{window} {text}`"
    return habit(failure, way, at=span_of(tokens[at]), wanted="an operator")


def _at_operator(failure: Failure, at: int, end: int, window: str) -> Diagnostic:
    """`always (p) in [0, 10]`: the window stands right behind its operator."""
    tokens = failure.tokens
    way = f"a window stands behind its operator, as in `always{window} (...)`"
    before = [i for i in range(at) if tokens[i].type in TEMPORAL]
    if len(before) != 1 or tokens[before[0] + 1].type == "LSQB" or tokens[before[0] - 1].type != "COLON":
        return habit(failure, way, at=span_of(tokens[at]), wanted="an operator")
    behind = span_of(tokens[before[0]]).end
    removed = Span(span_of(tokens[at - 1]).end, span_of(tokens[end - 1]).end)
    way = f"write `{tokens[before[0]]}{window}`"
    edits = (Edit(Span(behind, behind), window), Edit(removed, ""))
    return habit(failure, way, *edits, at=span_of(tokens[at]), wanted="an operator")


def quantifier(failure: Failure) -> Diagnostic | None:
    """Describe `forall t in [0, 10]: p`. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if failure.token is None or at < 2 or str(tokens[at - 1]) not in _QUANTIFIERS or not is_word(tokens[at]):
        return None
    word, begin = _QUANTIFIERS[str(tokens[at - 1])], at - 1
    if str(tokens[begin]) in failure.names:
        return None
    end, window = at + 1, ""
    if [t.type for t in tokens[end : end + 2]] == ["IN", "LSQB"]:
        end = _window_end(failure, at + 2) or end
        window = failure.text(tokens[at + 2 : end]) if end > at + 1 else ""
    if begin == 1:
        way = f"write a name first, and the window at its operator, as in `{tokens[0]} goal: {word}{window} (...)`"
        return habit(failure, way, at=span_of(tokens[begin]), wanted="a name")
    way, span = f"write `{word}{window} (...)`", span_of(tokens[begin])
    body = end + (end < len(tokens) and tokens[end].type in ("COLON", "COMMA"))
    if failure.brackets or body >= len(tokens):
        return habit(failure, way, at=span, wanted="an operator of the language")
    head = span.to(Span(span_of(tokens[body]).start, span_of(tokens[body]).start))
    last = span_of(tokens[-1]).end
    edits = (Edit(head, f"{word}{window} ("), Edit(Span(last, last), ")"))
    return habit(failure, way, *edits, at=span, wanted="an operator of the language")


def for_all(failure: Failure) -> Diagnostic | None:
    """Describe `for all (p)`, which has no operator of time. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    if at < 2 or [str(t) for t in tokens[at - 1 : at + 1]] not in (["for", "all"], ["for", "each"], ["for", "every"]):
        return None
    if "for" in failure.names or tokens[0].type not in ("HARD", "SOFT", "LET"):
        return None
    whole = span_of(tokens[at - 1]).to(span_of(tokens[at]))
    way = "write `always` for: at all samples"
    return habit(failure, way, Edit(whole, "always"), at=whole, wanted="an operator of the language")


PHRASES = (spoken_bounds, window_behind, quantifier)
"""In the order in which they are asked."""
