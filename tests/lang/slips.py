"""Specs with one slip of a hand, in many places: each gives one error, whose help, followed literally, clears the file.

`python -m tests.lang.slips --cases 3000 --seed 0`, from the root of the repository, tries them. Every diagnostic of
these kinds carries its help as edits; they are made as they stand, and the file is checked again.
"""

import argparse
import random
import sys

from stlspec.compiler.compiling import check_source
from stlspec.source import SourceText

HEADS = {
    "": 'signal gap unit "m"\nsignal speed\nsignal brake: bool\nparam far = 4\nlet close = gap < 3 m\n',
    " s": """time 1 s
signal gap unit "m" in [0, 90]
signal speed
signal brake: bool
param far = 4 s
let close = gap < 3 m
""",
    " ms": """time ms
signal gap
signal speed in [-5, 5]
signal brake: bool
param far = 4000 ms
let close = gap < 3
""",
}
PREFIXES = ["always", "eventually", "historically", "once", "G", "F"]
INFIXES = ["until", "since", "unless", "release"]
LOGIC = ["and", "or", "implies", "xor", "&&", "->"]
MISSPELT = {
    "always": ["alwyas", "alway", "allways"],
    "eventually": ["eventualy", "eventualli", "eventaully"],
    "historically": ["historicaly", "histrically"],
    "until": ["untill", "unitl"],
    "since": ["sinc", "sicne"],
    "implies": ["implys", "impleis"],
    "and": ["adn", "annd"],
    "not": ["nott"],
}
NAMES = {"gap": ["gapp", "gpa"], "speed": ["sped", "speeed"], "brake": ["brke", "barke"], "close": ["clsoe", "closee"]}


class Slip:
    """Makes one spec with one slip; `kind` names it."""

    def __init__(self, rng):
        self.rng = rng
        self.unit = rng.choice(list(HEADS))
        self.kind = ""

    def atom(self):
        """A formula that needs no brackets."""
        return self.rng.choice(["brake", "close", "(gap > 2)", "(speed + 1 < 3)", "(0 <= speed <= 5)", "not brake"])

    def bounds(self):
        """An interval."""
        return f"[{self.rng.choice(['0', '1' + self.unit])}, {self.rng.choice(['7' + self.unit, 'far', 'inf'])}]"

    def formula(self):
        """A formula without a slip."""
        rng = self.rng
        kind = rng.random()
        if kind < 0.3:
            return self.atom()
        if kind < 0.6:
            return f"{rng.choice(PREFIXES)}{self.bounds()} {self.atom()}"
        if kind < 0.8:
            return f"({self.atom()} {rng.choice(INFIXES)}{self.bounds()} {self.atom()})"
        return f"({self.atom()} {rng.choice(LOGIC)} {self.formula()})"

    def placed(self, formula, *, last=False):
        """A formula within another one, in a statement between others; `last`: nothing follows it there."""
        rng = self.rng
        if not last and rng.random() < 0.4:
            formula = rng.choice([f"({formula}) and {self.formula()}", f"{self.formula()} or ({formula})"])
        if rng.random() < 0.2:
            formula = f"{self.formula()} and\n    {formula}"
        head = rng.choice(["hard target: ", 'soft target "doc" scale 2:\n    ', "let target = "])
        before = [f"hard first: {self.formula()}\n", f"soft second depends on first: {self.formula()}\n"]
        after = [f"hard third: {self.formula()}  # a comment\n", f"let fourth = {self.formula()}\n"]
        tail = rng.choice(["\n", "  # the one with the slip\n", "\n\n"])
        return HEADS[self.unit] + "".join(before) + head + formula + tail + "".join(after)

    def text(self):
        """The spec with its slip."""
        kinds = [name for name in dir(self) if name.startswith("slip_")]
        self.kind = self.rng.choice(kinds)
        return getattr(self, self.kind)()

    def slip_square_bracket(self):
        word, bounds = self.rng.choice(PREFIXES), self.bounds()[:-1]
        infix = f"{self.atom()} {self.rng.choice(INFIXES)}{bounds} {self.atom()}"
        return self.placed(self.rng.choice([f"{word}{bounds} {self.atom()}", infix]))

    def slip_round_bracket(self):
        word = self.rng.choice(PREFIXES)
        inner = f"{self.atom()} {self.rng.choice(LOGIC)} {self.formula()}"
        return self.placed(
            self.rng.choice([f"{word} ({inner}", f"({inner}", f"{word} (speed + 1 > abs(speed)", "abs(gap > 2"]),
            last=True,
        )

    def slip_word(self):
        word = self.rng.choice(["always", "eventually", "historically"])
        wrong = self.rng.choice(MISSPELT[word])
        return self.placed(f"{wrong}{self.rng.choice([self.bounds(), ' ', ''])} ({self.formula()})")

    def slip_infix(self):
        word = self.rng.choice(["until", "since", "implies", "and"])
        return self.placed(f"{self.atom()} {self.rng.choice(MISSPELT[word])} {self.atom()}")

    def slip_name(self):
        name = self.rng.choice(list(NAMES))
        wrong = self.rng.choice(NAMES[name])
        if name in ("brake", "close"):
            return self.placed(f"{self.atom()} and {wrong}")
        return self.placed(f"always ({wrong} > 1 or {wrong} + 1 < 0)")

    def slip_dangling(self):
        word = self.rng.choice([*LOGIC, *INFIXES, "and not", "or always", "and eventually" + self.bounds()])
        if self.rng.random() < 0.3:
            return self.placed(f"always ({self.atom()} {self.rng.choice(LOGIC)})")
        return self.placed(f"{self.formula()} {word}", last=True)

    def slip_reversed(self):
        bounds = f"[5{self.unit}, {self.rng.choice(['2' + self.unit, '0'])}]"
        return self.placed(f"{self.rng.choice(PREFIXES)}{bounds} {self.atom()}")

    def slip_equals(self):
        return self.placed(
            f"{self.rng.choice(PREFIXES)} ({self.rng.choice(['speed = 1', '2 = speed + 1', 'abs(speed)=3'])})"
        )

    def slip_unit(self):
        self.unit = self.rng.choice([" s", " ms"])
        bounds = self.rng.choice(["[0, 5]", "[1, 5]", f"[1, 5{self.unit}]", f"[1{self.unit}, 5]", "[0, 2 + 3]"])
        infix = f"{self.atom()} {self.rng.choice(INFIXES)}{bounds} {self.atom()}"
        return self.placed(self.rng.choice([f"{self.rng.choice(PREFIXES)}{bounds} {self.atom()}", infix]))

    def slip_dependency(self):
        given = self.rng.choice(["nowhere", "first, nowhere", "nowhere, first", "frist", "first, secnod, second"])
        clauses = self.rng.choice(["{}", '"doc" {}', "{} scale 2", 'scale 2 {} bound linear "doc"'])
        header = clauses.format(f"depends on {given}")
        return self.placed("brake") + f"soft extra {header}:\n    {self.formula()}\n"


def errors(text):
    """The errors in a text."""
    return [d for d in check_source(SourceText.of("slip.stl", text)).diagnostics if d.severity == "error"]


def fault(rng):
    """Make a slip and follow the help; what is wrong, None if nothing is."""
    slip = Slip(rng)
    text = slip.text()
    found = errors(text)
    shown = "\n".join(f"{d.code} {d.message}; help: {d.help}" for d in found)
    if len(found) != 1:
        return f"{slip.kind}: {len(found)} errors\n{text}\n{shown}"
    if not found[0].fixes:
        return f"{slip.kind}: no fix\n{text}\n{shown}"
    after = found[0].fixes[0].applied(text)
    left = errors(after)
    if left:
        return f"{slip.kind}: not clean\n{text}\n{shown}\n{after}\n{left[0].code} {left[0].message}"
    return None


def main(arguments=None):
    """Make slips and follow the help; return 1 if a file is not clean then."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    rng = random.Random(options.seed)
    faults = [found for _ in range(options.cases) if (found := fault(rng)) is not None]
    print("\n=====\n".join([*faults[:5], f"{options.cases} slips, {len(faults)} not cleared by their help"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
