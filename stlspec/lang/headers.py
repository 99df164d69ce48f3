"""Headers of requirements that are written in another way, and what is written here.

In: a `Failure`. Out: the one diagnostic with its edits, or None where the header is not what stopped the parser.
"""

import re

from stlspec.errors import Diagnostic, Edit
from stlspec.lang.expected import quoted
from stlspec.lang.failure import TEMPORAL, Failure
from stlspec.lang.habits import habit
from stlspec.lang.statements import RESERVED, STATEMENT_WORDS, is_word
from stlspec.lang.tree import span_of
from stlspec.source import Span

_CLAUSES = frozenset({"depends", "on", "scale", "bound", "tanh", "linear", "none", "unit", "in", "from"})
"""Words of clauses, which are no part of a name."""
_RANKS = frozenset("priority prio weight weighted importance rank level criticality severity".split())
_LONGEST_NAME = 30


def priority(failure: Failure) -> Diagnostic | None:
    """Describe `soft a priority 2`: a rank as a number. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    # `u > 1 weight 2` reads as 1 in a unit `weight`, and stops at the 2.
    rank = next((i for i in (at, at - 1) if 1 < i < len(tokens) and str(tokens[i]) in _RANKS), None)
    if rank is None or tokens[0].type not in ("HARD", "SOFT") or str(tokens[rank]) in failure.names:
        return None
    if rank + 1 < len(tokens) and tokens[rank + 1].type not in ("NUMBER", "NAME", "COLON", "ASSIGN"):
        return None
    name = str(tokens[1])
    way = f"ranks come from `depends on`: hard before soft, and `soft b depends on {name}` puts b behind {name}"
    return habit(failure, way, at=span_of(tokens[rank]))


def no_name(failure: Failure) -> Diagnostic | None:
    """Describe `hard "title": p` and `hard G p`, which have no name. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    word = str(tokens[0])
    if failure.beginning or tokens[0].type not in ("HARD", "SOFT") or not 1 <= at <= 2 or at >= len(tokens):
        return None
    first = tokens[1]
    if at == 1 and first.type == "STRING":
        return _untitled(failure)
    follows = tokens[2].type if len(tokens) > 2 else ""
    begins = first.type in TEMPORAL if at == 2 else str(first) in RESERVED
    if not begins or str(first) in STATEMENT_WORDS or follows in ("COLON", "STRING", "") or _CLAUSES & {str(tokens[2])}:
        return None
    if not any(token.type == "COLON" and i > at for i, token in enumerate(tokens)) or follows == "LSQB":
        way = f"write a name and `:` before {quoted(str(first))}, as in `{word} goal: {first} ...`"
        return habit(failure, way, at=span_of(first), wanted="a name and `:`")
    return None


def _untitled(failure: Failure) -> Diagnostic:
    word, title = failure.tokens[:2]
    words, name = re.findall(r"[a-z0-9]+", str(title).lower()), ""
    for part in words:
        if len(name) + len(part) < _LONGEST_NAME:
            name = f"{name}_{part}" if name else part
    free = re.match(r"[a-z]", name) and name not in RESERVED | _CLAUSES
    # A name that stands anywhere in the text may be taken.
    if not free or re.search(rf"\b{name}\b", failure.source.text.replace(str(title), "")):
        return habit(
            failure, f"write a name before the title, as in `{word} goal {quoted(str(title))[1:]}", wanted="a name"
        )
    start = span_of(title).start
    way = f"write a name before the title, as in `{word} {name} {quoted(str(title))[1:]}"
    return habit(failure, way, Edit(Span(start, start), f"{name} "), wanted="a name")


def blank_in_name(failure: Failure) -> Diagnostic | None:
    """Describe `hard no overshoot: p`: a name with a blank. Not in the paper: the language."""
    at, tokens = failure.at, failure.tokens
    kinds = ("HARD", "SOFT", "SIGNAL", "PARAM")
    if failure.token is None or at != 2 or tokens[0].type not in kinds or not is_word(tokens[2]):
        return None
    end = at
    while end < len(tokens) and tokens[end].line == tokens[1].line and is_word(tokens[end]):
        if str(tokens[end]) in _CLAUSES:
            break
        end += 1
    parts = [str(token) for token in tokens[1:end]]
    if end == at or RESERVED & set(parts) or any(part in ("bool", "real") for part in parts[1:]):
        return None
    requirement = tokens[0].type in ("HARD", "SOFT")
    if requirement and (end == len(tokens) or tokens[end].type not in ("COLON", "STRING", "DEPENDS", "SCALE", "BOUND")):
        return None
    if failure.names & set(parts[1:]) or _required(failure, parts[1:]):
        return None
    name, whole = "_".join(parts), span_of(tokens[1]).to(span_of(tokens[end - 1]))
    # Formulas that use a signal spell it with the blank too: another name here would not clear them.
    edits = (Edit(whole, name),) if requirement else ()
    return habit(failure, f"a name has no blanks: write `{name}`", *edits, at=whole, wanted="one word")


def glued_type(failure: Failure) -> Diagnostic | None:
    """Describe `signal alarmbool :`, a name and its type glued together. Not in the paper: the language."""
    if [token.type for token in failure.tokens] != ["SIGNAL", "NAME", "COLON"] or failure.token is not None:
        return None
    word, colon = failure.tokens[1:]
    for kind in ("bool", "real"):
        name = str(word).removesuffix(kind)
        # That the text has the shorter name too tells the slip from a name that ends like this.
        if name not in ("", str(word)) and re.search(rf"\b{name}\b", failure.source.text):
            whole = span_of(word).to(span_of(colon))
            edit = Edit(whole, f"{name} : {kind}")
            return habit(failure, f"write `{name} : {kind}`", edit, at=whole, wanted="a name, `:` and a type")
    return None


def _required(failure: Failure, names: list[str]) -> bool:
    """Tell whether one of `names` is a requirement: `depends on` was lost before it."""
    return any(re.search(rf"^\s*(hard|soft)\s+{name}\b", failure.source.text, re.MULTILINE) for name in names)
