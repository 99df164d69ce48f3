"""Random specs that compile, written badly: any alias, any order of clauses, odd gaps, comments everywhere.

`python -m tests.lang.compose --cases 10000 --seed 0`, from the root of the repository, formats them all and tells
whether the formatter keeps its promises: formatting twice changes nothing more, `meaning_sha256` is the same, and
so are the comments, in their order.
"""

import argparse
import random
import sys
from itertools import pairwise

from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.compiler.compiling import compile_source
from stlspec.errors import SpecError
from stlspec.lang.formatting.layout import WIDTH
from stlspec.lang.formatting.text import format_text
from stlspec.lang.parse import parse
from stlspec.source import SourceText
from tests.lang.generate import BOUNDED, SPELLED, case

REALS, BOOLS = ["x", "d_obs", "time_left", "G", "w"], ["p", "q", "on"]
WORDY = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789."


class Composer:
    """Makes one spec as statements, each a list of tokens that may be parted by anything."""

    def __init__(self, rng):
        self.rng = rng
        self.unit = rng.choice(["", "", "s", "ms"])
        self.lets = []
        self.notes = 0

    def spec(self):
        """All statements of a spec."""
        rng = self.rng
        found = [["spec", "made", *self.maybe('"a title"')]] if rng.random() < 0.4 else []
        if self.unit:
            found.append(["time", rng.choice([self.unit, f"100 {self.unit}"])])
        found += [self.signal(name, "real") for name in REALS] + [self.signal(name, "bool") for name in BOOLS]
        found.append(["param", "T", "=", rng.choice(["4", ".5", "1e1"]) + f" {self.unit} ", *self.maybe('"a bound"')])
        found.append(["param", "c", "=", "-", "2.50"])
        for i in range(rng.randint(0, 3)):
            found.append(["let", f"l{i}", "=", *self.formula(2)])
            self.lets.append(f"l{i}")
        if rng.random() < 0.5:
            found.append(["let", "near", "(", "a", ",", "r", ")", "=", "abs", "(", "a", "-", "r", ")", "<", "1"])
            self.lets.append("near(x, 2)")
        names = [f"r{i}" for i in range(rng.randint(1, 4))]
        for i, name in enumerate(names):
            found.append(self.requirement(name, names[:i]))
        for name in names[: rng.randint(0, 2)]:
            found.append(self.expect(name))
        return found

    def maybe(self, *tokens, chance=0.4):
        """The tokens, or none."""
        return list(tokens) if self.rng.random() < chance else []

    def signal(self, name, kind):
        """A signal with some clauses in any order."""
        clauses = [self.maybe('"what it is"'), self.maybe("from", f'"obs.{name}"')]
        clauses.append([":", kind] if kind == "bool" or self.rng.random() < 0.2 else [])
        if kind == "real":
            clauses.append(self.maybe("in", "[", "-", "9", self.rng.choice(",:"), "1e3", "]"))
        self.rng.shuffle(clauses)
        return ["signal", name, *(token for clause in clauses for token in clause)]

    def requirement(self, name, before):
        """A requirement; hard ones depend on nothing that is soft, since all are hard."""
        clauses = [self.maybe('"why it is so"'), self.maybe("scale", "2."), self.maybe("bound", "linear")]
        if before:
            chosen = self.rng.sample(before, self.rng.randint(1, len(before)))
            clauses.append(["depends", "on", *[t for n in chosen for t in (",", n)][1:]])
        self.rng.shuffle(clauses)
        return ["hard", name, *(token for clause in clauses for token in clause), ":", *self.formula(4)]

    def expect(self, name):
        """An expectation on data in the spec, or on a file."""
        kind = self.rng.random()
        if kind < 0.3:
            return ["expect", '"a.csv"', "episode", "2", "is", "good"]
        if kind < 0.5 or self.unit:
            return ["expect", '"a.csv"', "outranks", '"b.csv"']
        count = self.rng.randint(1, 40)
        columns = []
        for column in [*REALS, *BOOLS]:
            values = ["1", ".5", "inf"] if column in REALS else ["true", "false"]
            samples = [t for _ in range(count) for t in (",", self.rng.choice(values))][1:]
            columns += [",", column, ":", "[", *samples, "]"]
        clauses = [self.maybe("at", "0"), self.maybe("margin", ">=", "0")]
        self.rng.shuffle(clauses)
        columns = ["{", *columns[1:], "}"]
        return ["expect", name, "fails", "on", *columns, *(token for clause in clauses for token in clause)]

    def spelled(self, word):
        """The word or an alias that nothing declares."""
        return self.rng.choice([alias for alias in SPELLED[word] if alias not in REALS])

    def interval(self):
        """An interval that is neither empty nor reversed."""
        suffix = f" {self.unit} " if self.unit else ""
        high = self.rng.choice([f"7{suffix}", "inf", "T", f"2 * 3{suffix}" if self.unit else "2 * 3"])
        return ["[", "0", self.rng.choice(",:"), high, "]"] if self.rng.random() < 0.7 else []

    def formula(self, depth):
        """A formula, bracketed only where the precedence asks for it, and sometimes twice."""
        kind = self.rng.random() if depth > 0 else 0
        if kind < 0.25:
            return self.predicate()
        if kind < 0.5:
            word = self.rng.choice(["always", "eventually", "historically", "once", "next", "prev", "wnext", "not"])
            inner = self.formula(depth - 1)
            between = self.interval() if word in BOUNDED else []
            if self.rng.random() < 0.6 or self.looks_infix(inner):
                inner = ["(", *inner, ")"]
            return [self.spelled(word), *between, *inner]
        if kind < 0.62:
            word = self.rng.choice(["until", "since", "unless", "release"])
            left, right = (self.closed(self.formula(depth - 1)) for _ in "ab")
            return [*left, self.spelled(word), *self.interval(), *right]
        word = self.rng.choice(["and", "or", "xor", "implies", "iff", "and", "or", "implies"])
        parts = [self.formula(depth - 1) for _ in range(2 if word in ("implies", "iff") else self.rng.randint(2, 3))]
        if word == "iff" or self.rng.random() < 0.4:
            parts = [self.closed(part) for part in parts]
        tokens = [t for part in parts for t in (self.spelled(word), *part)][1:]
        return self.closed(tokens) if word == "iff" else tokens

    def looks_infix(self, tokens):
        """Whether a formula begins with no bracket and may hold an operator that an outer one would split."""
        return any(t in ("until", "since", "unless", "release") for t in tokens) and self.rng.random() < 0.5

    def closed(self, tokens):
        """The tokens in brackets, sometimes in two pairs."""
        return ["(", *self.closed(tokens), ")"] if self.rng.random() < 0.1 else ["(", *tokens, ")"]

    def predicate(self):
        """A comparison, a bool signal or a let."""
        kind = self.rng.random()
        if kind < 0.25:
            return [self.rng.choice(BOOLS)]
        if kind < 0.4 and self.lets:
            return [self.rng.choice(self.lets)]
        if kind < 0.5:
            return ["0", "<=", *self.real(1), "<=", "5"]
        return [*self.real(2), self.rng.choice(["<", "<=", ">", ">=", "==", "!="]), *self.real(1)]

    def real(self, depth):
        """An arithmetic expression."""
        kind = self.rng.random() if depth > 0 else 0
        if kind < 0.5:
            return [self.rng.choice([*REALS, "c", "3", "0.50", ".25", "x[t]", "G [ t ]"])]
        if kind < 0.6:
            return ["abs", "(", *self.real(depth - 1), ")"]
        if kind < 0.7:
            return ["-", *self.real(0)]
        if kind < 0.8:
            return ["(", *self.real(depth - 1), self.rng.choice("+-*"), *self.real(0), ")", "**", "2"]
        return [*self.real(depth - 1), self.rng.choice("+-*"), *self.real(0)]

    def gap(self, before, after):
        """What parts two tokens of one statement."""
        rng = self.rng
        wordy = before[-1:] in WORDY and after[:1] in WORDY
        signs = before[-1:] in "<>=!&|*/-" and after[:1] in "<>=&|*/-"
        if rng.random() < 0.2 and not wordy and not signs:
            return ""
        if rng.random() < 0.85:
            return rng.choice([" ", "  ", "\t"])
        return rng.choice(
            ["\n", "\n\n  ", self.comment() + "\n", f"\n   {self.comment()}\n", f"\n\n{self.comment()}\n "]
        )

    def comment(self):
        """A comment that there is only once."""
        self.notes += 1
        return self.rng.choice(["# ", "// ", "#", "//"]) + f'note {self.notes} [ ( " é' + self.rng.choice(["", "  "])

    def text(self):
        """The whole spec."""
        parts = [f"{self.comment()}\n" for _ in range(self.rng.randint(0, 2))]
        for statement in self.spec():
            parts += [self.rng.choice(["", "", "\n", "\n\n\n", " "])]
            parts += [f"{self.rng.choice(['', '  '])}{self.comment()}\n" for _ in range(self.rng.choice([0, 0, 1, 2]))]
            parts += [self.rng.choice(["", "  "]), statement[0]]
            for before, after in pairwise(statement):
                parts += [self.gap(before, after), after]
            parts += [f" {self.comment()}" if self.rng.random() < 0.3 else "", "\n"]
        text = "".join(parts) + (self.comment() if self.rng.random() < 0.3 else "")
        return text.replace("\n", "\r\n") if self.rng.random() < 0.2 else text


def said(text):
    """The comments of a text, and the hash of what it means."""
    source = SourceText.of("spec.stl", text)
    return [c.text.rstrip() for c in parse(source).comments], meaning_sha256(compile_source(source))


def fault(rng):
    """Format a random spec; what is wrong with the result, None if nothing is."""
    text = Composer(rng).text()
    try:
        before = said(text)
    except SpecError as error:
        return f"the generator is wrong: {error}\n{text}"
    try:
        once = format_text(text)
    except SpecError as error:
        return f"{error}\n{text}"
    if said(once) != before:
        return f"the meaning or the comments changed:\n{text}\n-----\n{once}"
    if format_text(once) != once:
        return f"not idempotent:\n{text}\n-----\n{once}\n-----\n{format_text(once)}"
    lines = [line for line in once.splitlines() if len(line.split("  #")[0].split("  //")[0]) > WIDTH]
    return f"a long line: {lines[0]}" if lines else None


def tree_fault(rng):
    """The same for a formula of any shape, which need not compile."""
    _, formula, _ = case(rng, rng.randint(1, 5))
    text = f"let p = {formula}"
    if parse(SourceText.of("p", text)).diagnostics:
        return None  # it was written for other declarations
    try:
        once = format_text(text)
    except SpecError as error:
        return f"{error}\n{text}"
    return None if format_text(once) == once else f"not idempotent:\n{text}\n-----\n{once}"


def main(arguments=None):
    """Format random specs; return 1 if one shows a fault."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    rng = random.Random(options.seed)
    faults = [found for _ in range(options.cases) for found in (fault(rng), tree_fault(rng)) if found is not None]
    print("\n=====\n".join([*faults[:5], f"{options.cases} specs and as many formulas, {len(faults)} faults"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
