"""Makes the TextMate grammar, which colours specs in editors, from the Lark grammar.

In: grammars/stl.lark. Out: grammars/vscode/syntaxes/stlspec.tmLanguage.json. No word and no sign is listed here:
each is read off the rules that take it, so a word that is new in the language is coloured with the next run of
`python grammars/build_textmate.py`, and a test fails until then. Regular expressions cannot know what a text
declares: `G` is coloured as an operator wherever an operand follows, even if the spec has a signal G.
"""

import json
import re
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from lark import Lark
from lark.grammar import NonTerminal

from stlspec.lang import grammar
from stlspec.lang.statements import TIME_UNITS
from stlspec.lang.units import STEP

TARGET = Path(__file__).parent / "vscode" / "syntaxes" / "stlspec.tmLanguage.json"
_LOGICAL = ("not", "and", "or", "xor", "implies", "iff")
_CONTEXTUAL_STARTS = {
    "SPEC": r"\b(?=\s+[A-Za-z_])",
    "USE": r'\b(?=\s+")',
    "TIME": rf"\b(?=\s+(?:[0-9.]|(?:{'|'.join(TIME_UNITS)}|{STEP})\b))",
}
"""Words that begin a statement only with this behind them; the others are reserved."""
_NUMBER, _UNIT = "constant.numeric.stlspec", "constant.other.unit.stlspec"
_OPERAND = r"(?=\s*[A-Za-z_0-9.(\[!-])"


class Words:
    """The words and signs of the language, grouped by the rules of the grammar that take them."""

    def __init__(self, lark: Lark) -> None:
        self.text = {t.name: str(t.pattern.value) for t in lark.terminals}
        classes = {t.name for t in lark.terminals if t.pattern.type == "re"}
        self.patterns = {name: _uncaptured(self.text[name]) for name in classes}
        self.rules: dict[str, list[Any]] = defaultdict(list)
        for rule in lark.rules:
            self.rules[rule.origin.name].append(rule.expansion)
        operators = {name: self._only_terminals(name) for name in self.rules}
        self.operators = {name: terminals for name, terminals in operators.items() if terminals}
        self.starts = sorted(self._first("statement"))
        self.constants = [t for t in ("TRUE", "FALSE", "INF") if t in self.text]

    def _only_terminals(self, rule: str) -> list[str]:
        """Return the alternatives of a rule that is nothing but a choice of single terminals, such as `always`."""
        expansions = self.rules[rule]
        single = all(len(e) == 1 and e[0].is_term and e[0].name not in self.patterns for e in expansions)
        return [e[0].name for e in expansions] if single else []

    def _first(self, rule: str) -> set[str]:
        """Return the terminals with which a rule can begin."""
        found: set[str] = set()
        for expansion in self.rules[rule]:
            head = expansion[0]
            found |= self._first(head.name) if isinstance(head, NonTerminal) else {head.name}
        return found

    def _reachable(self, rule: str) -> set[str]:
        seen, todo, found = set(), [rule], set()
        while todo:
            name = todo.pop()
            if name in seen:
                continue
            seen.add(name)
            for symbol in (s for expansion in self.rules[name] for s in expansion):
                if isinstance(symbol, NonTerminal):
                    todo.append(symbol.name)
                else:
                    found.add(symbol.name)
        return found

    def is_word(self, terminal: str) -> bool:
        """Tell whether a terminal is one word, not a sign and not a class of words."""
        return terminal in self.text and terminal not in self.patterns and self.text[terminal][0].isalpha()

    def words(self, terminals: Iterable[str]) -> list[str]:
        """Return the words among terminals, in the order given."""
        return [self.text[t] for t in terminals if self.is_word(t)]

    def clauses(self, rule: str) -> list[str]:
        """Return the words of clauses that a rule leads to: all that are neither operators, constants nor starts."""
        operators = {t for terminals in self.operators.values() for t in terminals}
        return self.words(sorted(self._reachable(rule) - operators - set(self.constants) - set(self.starts)))

    def is_prefix(self, operator: str) -> bool:
        """Tell whether an operator stands in front of its operand."""
        return any(e[0].name == operator for e in self.rules["prefixed"] if isinstance(e[0], NonTerminal))

    def signs(self) -> list[str]:
        """Return the signs that are operators, longest first."""
        found = {self.text[t] for terminals in self.operators.values() for t in terminals if not self.is_word(t)}
        return sorted(found, key=lambda sign: (-len(sign), sign))


def _uncaptured(pattern: str) -> str:
    """Return a pattern of Lark for use inside others: without groups that count."""
    found = re.sub(r"(?<!\\)\((?!\?)", "(?:", pattern)
    assert re.compile(found).groups == 0
    return found


def _any(words: Iterable[str]) -> str:
    return "|".join(re.escape(word) for word in sorted(words, key=lambda word: (-len(word), word)))


def _word(words: Iterable[str]) -> str:
    return rf"\b(?:{_any(words)})\b"


def textmate() -> dict[str, Any]:
    """Return the TextMate grammar of the language. Not in the paper: it serves editors."""
    return _document(Words(grammar.build()))


def _document(words: Words) -> dict[str, Any]:
    return {
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "comment": "Made by grammars/build_textmate.py from grammars/stl.lark: change that, and run it again.",
        "name": "stlspec",
        "scopeName": "source.stlspec",
        "fileTypes": ["stl", "stlspec"],
        "patterns": [{"include": "#statements"}, {"include": "#formula"}],
        "repository": {**_statements(words), **_formula(words)},
    }


def _statements(words: Words) -> dict[str, Any]:
    starts = {t: words.text[t] for t in words.starts}
    reserved = [text for t, text in starts.items() if t not in _CONTEXTUAL_STARTS]
    beginnings = [rf"(?:{_any(reserved)})\b", *(starts[t] + behind for t, behind in _CONTEXTUAL_STARTS.items())]
    following = rf"(?=^\s*(?:{'|'.join(beginnings)}))"
    name, number = words.patterns["NAME"], words.patterns["NUMBER"]
    lead = {"1": {"name": "keyword.control.stlspec"}, "2": {"name": "entity.name.stlspec"}}

    def block(symbol: str, terminals: Iterable[str], end: str, *named: dict[str, str]) -> dict[str, Any]:
        clauses = {"match": _word(words.clauses(symbol)), "name": "keyword.other.clause.stlspec"}
        begin = rf"^\s*({_any(words.text[t] for t in terminals)})\b(?:\s+({name}))?"
        patterns = [*named, clauses, {"include": "#formula"}]
        return {"begin": begin, "beginCaptures": lead, "end": end, "patterns": patterns}

    kind = {"match": rf"(?<=:)\s*{name}", "name": "storage.type.stlspec"}
    return {
        "statements": {"patterns": [{"include": f"#{x}"} for x in ("requirement", "signal", "expect", "declaration")]},
        "requirement": block("requirement", ("HARD", "SOFT"), rf"(?=:)|{following}"),
        "signal": block("signal", ("SIGNAL",), following, kind),
        "expect": {
            **block("expect", ("EXPECT",), following),
            "begin": rf"^\s*({starts['EXPECT']})\b",
        },
        "declaration": {
            "patterns": [
                {"match": rf"^\s*({_any(starts[t] for t in ('PARAM', 'LET', 'SPEC'))})\s+({name})", "captures": lead},
                {"match": rf"^\s*({starts['USE']}){_CONTEXTUAL_STARTS['USE']}", "captures": lead},
                {
                    "match": rf"^\s*({starts['TIME']}){_CONTEXTUAL_STARTS['TIME']}\s+(?:({number})\s*)?({name})",
                    "captures": {"1": lead["1"], "2": {"name": _NUMBER}, "3": {"name": _UNIT}},
                },
            ]
        },
    }


def _formula(words: Words) -> dict[str, Any]:
    canonical = [terminals[0] for terminals in words.operators.values()]
    aliases = {t: rule for rule, terminals in words.operators.items() for t in terminals[1:]}
    logical = [t for rule in _LOGICAL for t in words.operators[rule]]
    prefix = [t for t, rule in aliases.items() if t not in logical and words.is_prefix(rule)]
    infix = [t for t, rule in aliases.items() if t not in logical and not words.is_prefix(rule)]
    between = words.words(t for r, ts in words.operators.items() if not words.is_prefix(r) for t in ts)
    operand = rf"{_OPERAND}(?!\s*{_word(between)})"
    everything = words.words(name for name in words.text if name not in words.patterns)
    word, number = words.patterns["NAME"], words.patterns["NUMBER"]
    unit = rf"[ \t]*((?!{_word(everything)}){word}(?:/{word}|\*\*[0-9]+)*)"
    unit_captures = {"1": {"name": _NUMBER}, "2": {"name": _UNIT}}
    temporal = [t for t in canonical if t not in logical]
    rows = [
        (r"(?:#|//)\s*(stlspec:\s*ignore\b[^\n]*)", "comment.line.directive.stlspec"),
        (words.patterns["COMMENT"], "comment.line.stlspec"),
        (words.patterns["STRING"], "string.quoted.double.stlspec"),
        (words.patterns["BAD_STRING"], "invalid.illegal.unclosed-text.stlspec"),
        (words.text["WALRUS"], "invalid.illegal.sign.stlspec"),
        (_word(words.words(logical)), "keyword.operator.logical.stlspec"),
        (_word(words.words(temporal)), "keyword.operator.temporal.stlspec"),
        (rf"{_word(words.words(prefix))}{operand}", "keyword.operator.temporal.alias.stlspec"),
        (rf"(?<=[A-Za-z_0-9)\]]\s){_word(words.words(infix))}{operand}", "keyword.operator.temporal.alias.stlspec"),
        (_word(words.words(words.constants)), "constant.language.stlspec"),
        (rf"{word}(?=\s*\()", "entity.name.function.stlspec"),
        (word, "variable.other.stlspec"),
    ]
    patterns: list[dict[str, Any]] = [{"match": match, "name": name} for match, name in rows]
    patterns.append({"match": rf"({number})(?:{unit})?", "captures": unit_captures})
    patterns.append({"match": _any(words.signs()), "name": "keyword.operator.stlspec"})
    return {"formula": {"patterns": patterns}}


def text() -> str:
    """Return the file as it is committed."""
    return json.dumps(textmate(), indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
