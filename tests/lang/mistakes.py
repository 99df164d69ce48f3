"""Broken specs of a second kind, judged by a second parser: is each mistake found, placed, and reported once?

    python -m tests.lang.mistakes --cases 2000 --seed 1

In: the specs of a dozen fields in `domains/`. Out: figures, and the cases that fall short. A case is one mistake in
one statement: a token deleted, doubled, swapped or misspelt; a line cut; a bracket or a quote lost; or a slip that
people make who come from Python, C, logic or another tool. Slips are wrong by construction. Whether a random change
is a mistake at all is decided without the parser under test: by Earley on the same grammar, with words reserved as
the reference says, and by the names that the spec declares.
"""

import argparse
import random
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from lark import Lark
from lark.exceptions import UnexpectedInput

from stlspec.compiler.review import review_source
from stlspec.errors import Diagnostic
from stlspec.lang.grammar import grammar_text
from stlspec.lang.statements import RESERVED
from stlspec.source import SourceText

DOMAINS = sorted((Path(__file__).parent / "domains").glob("*.stl"))
START = re.compile(r'^(?:(?:signal|param|let|hard|soft|expect)\b|spec [A-Za-z_]|use "|time (?:\d|[a-z]))', re.M)
TOKEN = re.compile(
    r'(?P<comment>(?:#|//)[^\n]*)|(?P<string>"[^"\n]*")|(?P<number>\d+(?:\.\d*)?(?:[eE][+-]?\d+)?)'
    r"|(?P<word>[A-Za-z_]\w*)|(?P<sign><->|<=>|->|=>|<=|>=|==|!=|&&|\|\||\*\*|[^\s\w])"
)
FUNCTIONS = frozenset("abs min max sqrt exp log sin cos hypot delta rate".split())
CLAUSES = frozenset("depends on scale bound unit in from holds fails episode at margin is outranks".split())


@dataclass(frozen=True)
class Token:
    """A piece of a statement, comments left out."""

    start: int
    end: int
    text: str
    kind: str


@dataclass(frozen=True)
class Case:
    """A spec with one mistake. lines: where a message may point; first and last: the lines of the statement."""

    kind: str
    text: str
    lines: frozenset[int]
    first: int
    last: int
    piece: str


def tokens_of(piece: str) -> list[Token]:
    found = [Token(m.start(), m.end(), m[0], m.lastgroup or "") for m in TOKEN.finditer(piece)]
    return [token for token in found if token.kind != "comment"]


def pieces_of(text: str) -> list[tuple[int, int]]:
    """Return where each statement begins and ends, comments and blank lines behind it left out."""
    starts = [m.start() for m in START.finditer(text)]
    found = []
    for start, end in zip(starts, [*starts[1:], len(text)], strict=True):
        found.append((start, start + tokens_of(text[start:end])[-1].end))
    return found


@cache
def referee() -> Lark:
    """Return an Earley parser of the same grammar in which reserved words are no names, and units are words."""
    text = grammar_text()
    lookahead = "|".join(sorted(RESERVED, key=len, reverse=True))
    text = text.replace("NAME: /[A-Za-z_]", rf"NAME: /(?!(?:{lookahead})(?![A-Za-z_0-9]))[A-Za-z_]")
    text = text.replace("%declare UNIT", r"UNIT: /[A-Za-z_][A-Za-z_0-9]*((\/[A-Za-z_]+)|(\*\*[0-9]+))*/")
    text = re.sub(r'^([A-Z_]+): "(\w+)"$', r"\1: /\2(?![A-Za-z_0-9])/", text, flags=re.M)
    text = text[: text.index("// Never parsed")] + "%ignore /[ \\t\\r\\n\\f]+/\n%ignore /(#|\\/\\/)[^\\n]*/\n"
    return Lark(text, parser="earley", lexer="dynamic", start="statement")


def is_broken(piece: str, names: frozenset[str]) -> bool:
    """Tell whether a statement is none by the grammar, or speaks of a name that nothing declares."""
    try:
        referee().parse(piece)
    except UnexpectedInput:
        return True
    return bool(_strangers(piece, names))


def _strangers(piece: str, names: frozenset[str]) -> set[str]:
    """Return the words of a formula that can only be names, and are none."""
    if not re.match(r"(?:hard|soft)\b", piece) or ":" not in piece:
        return set()
    # What stands behind a number may be its unit.
    formula = tokens_of(re.sub(r"(\d) *[A-Za-z]\w*(?:/[A-Za-z]+|\*\*\d+)*", r"\1", piece[piece.index(":") :]))
    found = set()
    for token in formula:
        word = token.kind == "word" and token.text not in RESERVED | FUNCTIONS | names
        aliases = token.text in ("G", "F", "H", "O", "U", "S", "W", "R", "X", "Y", "t", "now", "globally", "finally")
        if word and not aliases:
            found.add(token.text)
    return found


def declared(text: str) -> frozenset[str]:
    found = set(re.findall(r"^(?:signal|param|let) ([A-Za-z_]\w*)", text, re.M))
    for arguments in re.findall(r"^let \w+\(([^)]*)\)", text, re.M):
        found |= {argument.strip() for argument in arguments.split(",")}
    return frozenset(found)


# Random changes of tokens. Each gives the new statement and the offsets, in the old one, of what was changed.

Change = tuple[str, list[int]]


def delete_token(piece: str, rng: random.Random) -> Change:
    token = rng.choice(tokens_of(piece)[1:])
    return piece[: token.start] + piece[token.end :], [token.start, token.end]


def double_token(piece: str, rng: random.Random) -> Change:
    token = rng.choice(tokens_of(piece)[1:])
    return f"{piece[: token.end]} {token.text}{piece[token.end :]}", [token.start, token.end]


def swap_tokens(piece: str, rng: random.Random) -> Change:
    tokens = tokens_of(piece)[1:]
    i = rng.randrange(len(tokens) - 1)
    a, b = tokens[i], tokens[i + 1]
    changed = piece[: a.start] + b.text + " " + piece[a.end : b.start].strip(" ") + a.text + piece[b.end :]
    return changed, [a.start, b.end]


def misspell_word(piece: str, rng: random.Random) -> Change:
    words = [t for t in tokens_of(piece) if t.kind == "word" and len(t.text) > 3]
    token = rng.choice(words)
    letters = list(token.text)
    i = rng.randrange(1, len(letters) - 1)
    match rng.randrange(4):
        case 0:
            del letters[i]
        case 1:
            letters.insert(i, letters[i])
        case 2:
            letters[i], letters[i + 1] = letters[i + 1], letters[i]
        case _:
            letters[i] = rng.choice("aeiorstn")
    return piece[: token.start] + "".join(letters) + piece[token.end :], [token.start]


def cut_line(piece: str, rng: random.Random) -> Change:
    token = rng.choice(tokens_of(piece)[2:])
    end = piece.find("\n", token.start)
    return piece[: token.start].rstrip(" ") + (piece[end:] if end >= 0 else ""), [token.start, _before(piece, token)]


def cut_rest(piece: str, rng: random.Random) -> Change:
    token = rng.choice(tokens_of(piece)[2:])
    return piece[: token.start].rstrip(), [_before(piece, token)]


def lose_bracket(piece: str, rng: random.Random) -> Change | None:
    brackets = [t for t in tokens_of(piece) if t.text in "()[]{}"]
    if not brackets:
        return None
    token = rng.choice(brackets)
    # What it leaves open or closes too often shows anywhere from its partner to the end of the statement.
    span = [token.start, *(t.start for t in tokens_of(piece) if token.text in "([{" or t.start > token.start)]
    if token.text in ")]}":
        span += [t.start for t in tokens_of(piece)[-1:]]
    return piece[: token.start] + piece[token.end :], span


def exchange_bracket(piece: str, rng: random.Random) -> Change | None:
    brackets = [t for t in tokens_of(piece) if t.text in "()[]"]
    if not brackets:
        return None
    token = rng.choice(brackets)
    other = {"(": "[", "[": "(", ")": "]", "]": ")"}[token.text]
    later = [t.start for t in tokens_of(piece) if t.start >= token.start]
    return piece[: token.start] + other + piece[token.end :], later


def lose_quote(piece: str, rng: random.Random) -> Change | None:
    strings = [t for t in tokens_of(piece) if t.kind == "string"]
    if not strings:
        return None
    token = rng.choice(strings)
    if rng.random() < 0.5:
        return piece[: token.start] + piece[token.start + 1 :], [token.start]
    return piece[: token.end - 1] + piece[token.end :], [token.start]


def stray_sign(piece: str, rng: random.Random) -> Change:
    token = rng.choice(tokens_of(piece)[1:])
    sign = rng.choice(["$", ";", "@", "?", ")", "]", "}", ",", ".", "%", "\\", "==", ":"])
    return f"{piece[: token.start]}{sign} {piece[token.start :]}", [token.start]


def _before(piece: str, token: Token) -> int:
    return max((t.start for t in tokens_of(piece) if t.end <= token.start), default=0)


RANDOM: tuple[Callable[[str, random.Random], Change | None], ...] = (
    delete_token,
    double_token,
    swap_tokens,
    misspell_word,
    cut_line,
    cut_rest,
    lose_bracket,
    exchange_bracket,
    lose_quote,
    stray_sign,
)

# Slips that people make, as a pattern in a statement and what they write there; wrong wherever the pattern is found.

FORMULA = r"(?<=:)(?P<head>[\s\S]*?)"
SLIPS: dict[str, tuple[str, str]] = {
    "no colon": (r"^((?:hard|soft) [^:\"]*(?:\"[^\"]*\"[^:\"]*)?):", r"\1"),
    "equals sign for the colon": (r"^((?:hard|soft) [^:\"]*(?:\"[^\"]*\"[^:\"]*)?):", r"\1 ="),
    "walrus": (r"^((?:hard|soft) [^:\"]*(?:\"[^\"]*\"[^:\"]*)?):", r"\1 :="),
    "elementwise not": (r"\bnot\b", "~"),
    "word order of depends on": (r"\bdepends on\b", "on depends"),
    "depend on": (r"\bdepends on (\w+)", r"depend \1"),
    "depends without on": (r"\bdepends on\b", "depends"),
    "needs": (r"\bdepends on\b", "requires"),
    "and in a list": (r"(depends on \w+), (\w+)", r"\1 and \2"),
    "list without commas": (r"(depends on \w+), (\w+)", r"\1 \2"),
    "soft hard": (r"^soft\b", "soft hard"),
    "capital": (r"^(s|h)(oft|ard|ignal)\b", lambda m: m[1].upper() + m[2]),  # type: ignore[dict-item]
    "plural": (r"^(signal|param)\b", r"\1s"),
    "parameter": (r"^param\b", "parameter"),
    "def": (r"^let\b", "def"),
    "const": (r"^param\b", "const"),
    "var": (r"^signal\b", "var"),
    "requirement": (r"^(hard|soft)\b", "requirement"),
    "type first": (r"^signal (\w+): bool", r"signal bool \1"),
    "boolean": (r"^(signal \w+): bool", r"\1: boolean"),
    "type without colon": (r"^(signal \w+): bool", r"\1 bool"),
    "unit without word": (r"^(signal \w+) unit (\"[^\"]*\")( in| from| \")", r"\1 [\2]\3"),
    "unit without quotes": (r"unit \"([a-zA-Z]+)\"", r"unit \1"),
    "units": (r"\bunit (\"[^\"]*\")", r"units \1"),
    "range in round brackets": (r" in \[([^\]]*)\]", r" in (\1)"),
    "range by dots": (r" in \[([^,\]]*), ([^\]]*)\]", r" in \1..\2"),
    "range by to": (r" in \[([^,\]]*), ([^\]]*)\]", r" in [\1 to \2]"),
    "open interval": (r"\[(\d+), (\d+[^\],]*)\]", r"(\1, \2)"),
    "half-open interval": (r"\[(\d+), (\d+[^\],]*)\]", r"[\1, \2)"),
    "semicolon": (r"\[(\d+), ", r"[\1; "),
    "no comma": (r"\[(\d+), ", r"[\1 "),
    "dots": (r"\[(\d+), ", r"[\1.."),
    "reversed": (r"(?<=[a-z])\[0, (\d+[^\]]*)\]", r"[\1, 0]"),
    "negative": (r"(eventually|always|once)\[0, ", r"\1[-1, "),
    "subscript": (r"(eventually|always|once|historically)\[", r"\1_{["),
    "braces": (r"(eventually|always|once|historically)\[([^\]]*)\]", r"\1{\2}"),
    "angle": (r"(eventually|always|once|historically)\[([^\]]*)\]", r"\1<\2>"),
    "interval behind": (r"(eventually|always)(\[[^\]]*\]) (\w+)", r"\1 \3\2"),
    "comma in a number": (r"(\d)\.(\d)", r"\1,\2"),
    "unit glued with a dot": (r"(\d) (m|s|ms|percent)\b", r"\1.\2x"),
    "unit behind the interval": (r"\[(\d+), (\d+) (s|ms|min)\]", r"[\1, \2] \3"),
    "unit after a bracket": (r"(\w+) (>=|<=|<|>) (\d+) (m|percent|N|kW)\b", r"(\1 \2 \3) \4"),
    "unit typo": (r"(\[0, \d+) (s|ms|min)\]", r"\1 \2x]"),
    "long unit": (r"(\[0, \d+) (ms)\]", r"\1 millis]"),
    "unit of another quantity": (r"(\[0, \d+) (s|ms|min)\]", r"\1 kg]"),
    "assignment": (r" == (\d)", r" = \1"),
    "strict equality": (r" == (\d)", r" === \1"),
    "spaced sign": (r" (>|<)= (\d)", r" \1 = \2"),
    "turned sign": (r" >= (\w)", r" => = \1"),
    "turned at most": (r" <= (\d)", r" =< \1"),
    "not equal of SQL": (r" (?:==|<=|>=) (\d)", r" <> \1"),
    "mathematical sign": (r" >= (\w)", r" ≥≥ \1"),
    "is": (r" == (\d)", r" is \1"),
    "elementwise and": (r" and ", " ∧∧ "),
    "C comment": (r"(:)\s*\n", r"\1 /* note */\n"),
    "then": (r" implies ", " then "),
    "if": (r"(:\s+)always \(", r"\1always (if "),
    "long arrow": (r" implies ", " --> "),
    "curried arrow": (r" implies ", " |-> "),
    "backward arrow": (r" implies ", " <- "),
    "andalso": (r" and ", " and also "),
    "or else": (r" or ", " or else "),
    "unlesss": (r" unless ", " until not_yet "),
    "dangling and": (r"\)\Z", ") and"),
    "dangling implies": (r"(\w)\Z", r"\1 implies"),
    "leading and": (r"(:\s+)(always|eventually)", r"\1and \2"),
    "full stop": (r"(\w|\))\Z", r"\1."),
    "C semicolon": (r"(\w|\))\Z", r"\1;"),
    "comma at the end": (r"(\w|\))\Z", r"\1,"),
    "bracket at the end": (r"(\w|\))\Z", r"\1)"),
    "block": (r":\s+(always[\s\S]*)\Z", r" { \1 }"),
    "late scale": (r"^(hard|soft)( \w+.*) scale ([\d.]+)([^:]*):([\s\S]*)\Z", r"\1\2\4:\5 scale \3"),
    "late depends": (r"^(soft \w+[^:]*?) depends on (\w+):([\s\S]*)\Z", r"\1:\3 depends on \2"),
    "late title": (r"^(hard|soft) (\w+) (\"[^\"]*\")([^:]*):([\s\S]*)\Z", r"\1 \2\4:\5 \3"),
    "no name": (r"^(hard|soft|signal|param|let) \w+", r"\1"),
    "name with a blank": (r"^(soft|hard) (\w+)", r"\1 \2 more"),
    "name with a dash": (r"^(soft|hard) (\w+)", r"\1 \2-more"),
    "name with a digit": (r"^(soft|hard) (\w+)", r"\1 2\2"),
    "reserved name": (r"^(soft|hard|signal|let) \w+", r"\1 always"),
    "no parenthesis of a call": (r"\b(hypot|abs|max|delta)\(([^()]*)\)", r"\1 \2"),
    "percent sign": (r"(\d) percent", r"\1%"),
    "caret": (r"\*\*(\d)", r"^^\1"),
    "absolute value": (r"\babs\(([^()]*)\)", r"|\1|"),
    "prime": (r"delta\((\w+)\)", r"\1'"),
    "function of elsewhere": (r"\b(hypot|abs|delta)\(", r"norm("),
    "attribute": (r"(always|implies) \(?(\w+) ", r"\1 state.\2 "),
    "unknown signal": (r"\b(\w+) (>=|<=|<|>) (\d)", r"\1_zz \2 \3"),
    "unknown dependency": (r"depends on (\w+)", r"depends on \1_zz"),
    "expect without on": (r"(holds|fails) on", r"\1"),
    "expect passes": (r"(holds|fails) on", r"passes on"),
    "expect in": (r"(holds|fails) on", r"\1 in"),
    "expect holding": (r"(holds|fails) on", r"should \1 on"),
    "data in brackets": (r" on \{([^}]*)\}", r" on (\1)"),
    "data by equals": (r"\{(\w+): ", r"{\1 = "),
    "Python truth": (r"\b(true|false)\b(?=[,\]])", lambda m: m[1].title()),  # type: ignore[dict-item]
    "margin by equals": (r"margin >= ", "margin = "),
    "margin alone": (r"margin >= ", "margin "),
}
"""Each pattern is replaced once, at a random place where it fits; what is written there is never right."""


_PERHAPS = frozenset({"no name", "full stop", "comma in a number"})
"""Slips that may leave a statement of the language: `signal unit "m"` declares `unit`, `180.` is a number."""


def slip(piece: str, rng: random.Random) -> tuple[str, Change] | None:
    """Return a slip of a person in a statement: its kind, and the change; None if none fits."""
    kinds = list(SLIPS)
    rng.shuffle(kinds)
    for kind in kinds:
        pattern, written = SLIPS[kind]
        found = list(re.finditer(pattern, piece))
        quoted = [t for t in tokens_of(piece) if t.kind == "string"]
        found = [m for m in found if not any(t.start < m.start() < t.end for t in quoted)]
        if found:
            match = rng.choice(found)
            new = written(match) if callable(written) else match.expand(written)
            changed = piece[: match.start()] + new + piece[match.end() :]
            late = kind.startswith("late") or kind in ("no colon", "block", "subscript", "absolute value", "if")
            places = [match.start(), match.end()] if not late else [t.start for t in tokens_of(piece)]
            return kind, (changed, places)
    return None


def cases(n: int, seed: int) -> Iterator[Case]:
    """Yield `n` broken specs: half of them random changes that the referee calls broken, half slips."""
    rng = random.Random(seed)
    texts = [path.read_text(encoding="utf-8") for path in DOMAINS]
    made = 0
    while made < n:
        text = rng.choice(texts)
        start, end = rng.choice(pieces_of(text)[1:])
        piece = text[start:end]
        if len(tokens_of(piece)) < 4:
            continue
        if made % 2:
            found = slip(piece, rng)
            kind, change = found if found else ("", None)
        else:
            function = rng.choice(RANDOM)
            kind, change = function.__name__.replace("_", " "), function(piece, rng)
        if change is None or change[0] == piece or (not made % 2 and not is_broken(change[0], declared(text))):
            continue
        changed, places = change
        if kind in _PERHAPS and not is_broken(changed, declared(text)):
            continue
        made += 1
        line = text.count("\n", 0, start) + 1
        lines = frozenset(line + piece.count("\n", 0, place) for place in places)
        yield Case(kind, text[:start] + changed + text[end:], lines, line, line + changed.count("\n"), changed)


@dataclass
class Score:
    """What became of all cases; `short` keeps those that fall short, with the reason."""

    cases: int = 0
    found: int = 0
    placed: int = 0
    reported: int = 0
    elsewhere: int = 0
    good: int = 0
    short: list[tuple[str, Case, list[Diagnostic]]] = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        self.short = []

    def add(self, case: Case, diagnostics: list[Diagnostic]) -> None:
        places = [(d, d.source.position(d.span.start).line) for d in diagnostics if d.source and d.span]
        own = [(d, line) for d, line in places if case.first <= line <= case.last]
        self.cases += 1
        self.good += len(pieces_of(case.text)) - 1
        self.reported += len(own)
        self.elsewhere += len(places) - len(own)
        self.found += bool(own)
        self.placed += bool(own) and own[0][1] in case.lines
        reasons = [
            ("not found", not own),
            ("line", bool(own) and own[0][1] not in case.lines),
            ("more than one", len(own) > 1),
            ("elsewhere", len(places) > len(own)),
        ]
        self.short += [(reason, case, diagnostics) for reason, true in reasons if true]

    def __str__(self) -> str:
        return (
            f"{self.cases} broken statements: found {self.found / self.cases:.2%}, right line "
            f"{self.placed / max(self.found, 1):.2%}, {self.reported / max(self.found, 1):.3f} diagnostics each, "
            f"{self.elsewhere / self.good:.3%} of {self.good} good statements blamed"
        )


def measure(n: int, seed: int) -> Score:
    """Return how the checker fares on `n` broken specs."""
    score = Score()
    for case in cases(n, seed):
        score.add(
            case, [d for d in review_source(SourceText.of("a.stl", case.text)).diagnostics if d.severity == "error"]
        )
    return score


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--cases", type=int, default=600)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--show", type=int, default=20, help="how many cases that fall short are shown")
    chosen = options.parse_args()
    score = measure(chosen.cases, chosen.seed)
    for reason, case, diagnostics in score.short[: chosen.show]:
        print(f"-- {reason}: {case.kind} (line {min(case.lines)}, statement {case.first} to {case.last})\n{case.piece}")
        for d in diagnostics:
            at = d.source.position(d.span.start) if d.source and d.span else None
            print(f"   {d.code} {at and (at.line, at.column)} {d.message}; {d.help}")
    print(dict(Counter(f"{reason}: {case.kind}" for reason, case, _ in score.short).most_common()))
    print(score)


if __name__ == "__main__":
    main()
