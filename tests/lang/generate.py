"""Random trees, and the same trees as text: minimal brackets, any alias, comments and line breaks anywhere.

`python -m tests.lang.generate --cases 60000 --seed 0`, from the root of the repository, reads them back.
"""

import argparse
import random
import sys

from stlspec.lang.parse import parse_formula
from stlspec.source import SourceText
from tests.lang.sexpr import sexpr

IFF, IMPLIES, OR, XOR, AND, UNTIL, PREFIX, COMPARE, SUM, PRODUCT, NEG, POW, ATOM = range(13)
PLAIN = ["x", "y", "p", "q", "d_obs", "time", "scale", "unit", "on", "spec", "G_foo", "always_on"]
WORDS = "G F U W R S H O X Y ev alw hist finally globally until_ since_ ev_ s m t".split()
UNITS = ["s", "ms", "m", "m/s", "m/s**2", "m**2", "furlong", "min"]
SPELLED = {
    "always": ["always", "G", "globally", "alw", "alw_"],
    "eventually": ["eventually", "F", "finally", "ev", "ev_"],
    "historically": ["historically", "H", "hist", "hist_"],
    "once": ["once", "O", "once_"],
    "next": ["next", "X"],
    "prev": ["prev", "Y"],
    "wnext": ["wnext"],
    "wprev": ["wprev"],
    "until": ["until", "U", "until_"],
    "since": ["since", "S", "since_"],
    "unless": ["unless", "W"],
    "release": ["release", "R"],
    "not": ["not", "!"],
    "and": ["and", "&", "&&"],
    "or": ["or", "|", "||"],
    "xor": ["xor"],
    "implies": ["implies", "->", "=>"],
    "iff": ["iff", "<->", "<=>"],
}
BOUNDED = {"always", "eventually", "historically", "once", "until", "since", "unless", "release"}
LEVELS = {IFF: ["iff"], IMPLIES: ["implies"], OR: ["or"], XOR: ["xor"], AND: ["and"]}


class Writer:
    """Makes one tree: `tree` returns (level, S-expression, tokens)."""

    def __init__(self, rng):
        self.rng = rng
        self.declared = [w for w in WORDS if rng.random() < 0.3]

    def tree(self, depth, least=IFF):
        """A random tree that may stand where `least` is the loosest level allowed, bracketed if it is looser."""
        level = self.rng.choice(
            [IFF, IMPLIES, OR, XOR, AND, UNTIL, PREFIX, PREFIX, COMPARE, COMPARE, SUM, PRODUCT, NEG, POW]
        )
        if depth <= 0:
            level = ATOM
        text, tokens = self._made(level, depth - 1)
        if level < least or self.rng.random() < 0.05:
            tokens = ["(", *tokens, ")"]
        return text, tokens

    def _made(self, level, depth):
        if level == ATOM:
            return self._atom(depth)
        if level == UNTIL:
            return self._until(depth)
        if level == PREFIX:
            return self._prefix(depth)
        if level == COMPARE:
            return self._comparison(depth)
        if level in (SUM, PRODUCT):
            return self._folded(level, depth)
        if level == NEG:
            text, tokens = self.tree(depth, NEG)
            return f"(neg {text})", ["-", *tokens]
        if level == POW:
            (base, left), (exponent, right) = self.tree(depth, ATOM), self.tree(depth, NEG)
            return f"(** {base} {exponent})", [*left, "**", *right]
        return self._logic(level, depth)

    def _logic(self, level, depth):
        (word,) = LEVELS[level]
        if level == IMPLIES:
            parts = [self.tree(depth, OR), self.tree(depth, IMPLIES)]
        else:
            tighter = {IFF: IMPLIES, OR: XOR, XOR: AND, AND: UNTIL}[level]
            parts = [self.tree(depth, tighter) for _ in range(self.rng.randint(2, 3))]
        tokens = list(parts[0][1])
        for _, more in parts[1:]:
            tokens += [self._spelled(word), *more]
        return f"({word} {' '.join(text for text, _ in parts)})", tokens

    def _interval(self, word, depth):
        if word not in BOUNDED or self.rng.random() < 0.4:
            return "", []
        (low, left), (high, right) = (self.tree(min(depth, 1), SUM) for _ in "ab")
        return f"[{low} {high}]", ["[", *left, self.rng.choice(",:"), *right, "]"]

    def _prefix(self, depth):
        word = self.rng.choice(
            ["always", "eventually", "historically", "once", "next", "prev", "wnext", "wprev", "not"]
        )
        bounds, inside = self._interval(word, depth)
        text, tokens = self.tree(depth, PREFIX)
        return f"({word}{bounds} {text})", [self._spelled(word), *inside, *tokens]

    def _until(self, depth):
        word = self.rng.choice(["until", "since", "unless", "release"])
        bounds, inside = self._interval(word, depth)
        (left, before), (right, after) = self.tree(depth, PREFIX), self.tree(depth, PREFIX)
        return f"({word}{bounds} {left} {right})", [*before, self._spelled(word), *inside, *after]

    def _comparison(self, depth):
        signs = [self.rng.choice(["<", "<=", ">", ">=", "==", "!="]) for _ in range(self.rng.choice([1, 1, 1, 2, 3]))]
        parts = [self.tree(depth, SUM) for _ in range(len(signs) + 1)]
        tokens = list(parts[0][1])
        for sign, (_, more) in zip(signs, parts[1:], strict=True):
            tokens += [sign, *more]
        if len(set(signs)) == 1:
            return f"({signs[0]} {' '.join(text for text, _ in parts)})", tokens
        mixed = " ".join(f"{sign} {text}" for sign, (text, _) in zip(signs, parts[1:], strict=True))
        return f"(chain {parts[0][0]} {mixed})", tokens

    def _folded(self, level, depth):
        text, tokens = self.tree(depth, level + 1)
        for _ in range(self.rng.randint(1, 3)):
            sign = self.rng.choice("+-" if level == SUM else "*/")
            more, after = self.tree(depth, level + 1)
            text, tokens = f"({sign} {text} {more})", [*tokens, sign, *after]
        return text, tokens

    def _atom(self, depth):
        kind = self.rng.choice(["name"] * 5 + ["number"] * 3 + ["call", "index", "truth", "inf"])
        if kind == "name":
            name = self._name()
            return name, [name]
        if kind == "number":
            return self._number()
        if kind == "call":
            name = self.rng.choice(["abs", "min", "f"])
            parts = [self.tree(depth) for _ in range(self.rng.randint(1, 3))]
            tokens = [t for _, more in parts for t in [",", *more]][1:]
            return f"(call {name} {' '.join(text for text, _ in parts)})", [name, "(", *tokens, ")"]
        if kind == "index":
            name, (text, tokens) = self._name(), self.tree(depth)
            return f"(index {name} {text})", [name, "[", *tokens, "]"]
        word = self.rng.choice(["true", "false"]) if kind == "truth" else "inf"
        return word, [word]

    def _name(self):
        return self.rng.choice(PLAIN + self.declared * 2)

    def _number(self):
        value = self.rng.choice(["0", "1", "5", "0.5", ".5", "5.", "1e3", "2.5E-1"])
        text = f"{float(value):g}"
        if self.rng.random() < 0.3:
            unit = self.rng.choice(UNITS)
            return f"{text}_{unit}", [f"{value} {unit} "]
        return text, [value]

    def _spelled(self, word):
        return self.rng.choice([alias for alias in SPELLED[word] if alias not in self.declared])

    def text(self, tokens):
        """Put tokens together with blanks, line breaks and comments, or nothing where that is safe."""
        parts = []
        for before, after in zip(["", *tokens], [*tokens, ""], strict=True):
            wordy = _wordy(before[-1:]) and _wordy(after[:1])
            signs = before[-1:] in "<>=!&|*/-." and after[:1] in "<>=&|*/."
            draw = self.rng.random()
            if draw < 0.25 and not wordy and not signs and before[-1:] != " ":
                gap = ""
            elif draw < 0.9:
                gap = " "
            else:
                gap = self.rng.choice(["\n", "  \t", " # a comment\n", " // [another (\r\n", "\r", "\r\n\f "])
            parts += [gap, after]
        return "".join(parts)


def _wordy(character):
    return character.isalnum() or character in ("_", ".")


def case(rng, depth=4):
    """One random tree: its S-expression, its text, the words that are declared."""
    writer = Writer(rng)
    expected, tokens = writer.tree(depth)
    return expected, writer.text(tokens), frozenset(writer.declared)


def disagreement(rng):
    """Write a random tree and read it back; None if it comes back."""
    expected, text, declared = case(rng, rng.randint(0, 4))
    node, problems = parse_formula(SourceText.of("f", text), declared)
    found = problems[0].message if problems else sexpr(node)
    return None if found == expected else f"{text!r} with {sorted(declared)} is {expected}, read as {found}"


def main(arguments=None):
    """Read random trees back; return 1 if one is read differently."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=60_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    rng = random.Random(options.seed)
    wrong = [found for found in (disagreement(rng) for _ in range(options.cases)) if found is not None]
    print("\n".join([*wrong[:5], f"{options.cases} trees, {len(wrong)} read differently"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
