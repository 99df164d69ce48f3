"""Compare imported specs of RTAMT with RTAMT itself, on random specs and traces.

    python tests/peers/imports.py --cases 500

Random trees are written with the fewest brackets that RTAMT's grammar needs, imported, and evaluated here; RTAMT
evaluates the same text in its own environment. Every sample must be the same, bit for bit; if not, it exits with 1.
"""

import argparse
import json
import random
import sys
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import stlspec
from stlspec.source import SourceText
from stlspec.tools.importing.conversion import convert
from tests.peers.compare import DRIVERS
from tests.peers.environments import NotInstalledError, default_work, environment

# Level of each operator, the tightest highest, as the grammar of RTAMT 0.4.10 orders its alternatives.
INFIX = {"*": 26, "/": 25, "+": 24, "-": 23, ">": 22, ">=": 22, "<": 22, "<=": 22, "until": 12, "since": 10}
INFIX |= {"and": 9, "or": 8, "implies": 7}
SPELLED = {"and": ["and", "&"], "or": ["or", "|"], "implies": ["implies", "->"], "until": ["until", "U"]}
SPELLED |= {"since": ["since", "S"], "always": ["always", "G"], "eventually": ["eventually", "F"]}
SPELLED |= {"historically": ["historically", "H"], "once": ["once", "O"], "not": ["not", "!"], "next": ["next", "X"]}
SPELLED |= {"prev": ["prev", "Y"], "s_next": ["s_next", "sX"], "s_prev": ["s_prev", "sY"]}
PREFIX = {"not": 21, "always": 20, "eventually": 19, "historically": 18, "once": 17}
PREFIX |= {"prev": 16, "next": 15, "s_prev": 14, "s_next": 13}
BOUNDED = {"always", "eventually", "historically", "once", "until", "since"}
ATOM = 100
SIGNALS = ("a", "b", "c")


class Writer:
    """Makes random trees as pairs of texts: with few brackets, and with all."""

    def __init__(self, rng):
        self.rng = rng

    def formula(self, depth):
        """Return (level, text with few brackets, text with all)."""
        rng = self.rng
        kind = rng.choice(["compare", "name", "infix", "infix", "prefix", "prefix", "edge"]) if depth else "compare"
        if kind == "name":
            return self._atom(rng.choice(SIGNALS))
        if kind == "compare":
            return self._infix(rng.choice([">", ">=", "<", "<="]), self.number(2), self.number(2))
        if kind == "infix":
            return self._infix(
                rng.choice(["and", "or", "implies", "until", "since"]), self.formula(depth - 1), self.formula(depth - 1)
            )
        if kind == "edge":
            _, few, full = self.formula(depth - 1)
            word = rng.choice(["rise", "fall"])
            return ATOM, f"{word}({few})", f"{word}({full})"
        return self._prefix(rng.choice(list(PREFIX)), self.formula(depth - 1))

    def number(self, depth):
        """Return an arithmetic expression in the same form."""
        rng = self.rng
        if not depth or rng.random() < 0.4:
            return self._atom(rng.choice([*SIGNALS, "1", "2", "-3", "4"]))
        return self._infix(rng.choice("+-*/" if depth > 1 else "+-*"), self.number(depth - 1), self.number(depth - 1))

    def _atom(self, text):
        return ATOM, text, text

    def _window(self, word):
        if word not in BOUNDED or self.rng.random() < 0.5:
            return ""
        low = self.rng.randint(0, 3)
        return f"[{low}{self.rng.choice(':,')}{low + self.rng.randint(0, 3)}]"

    def _spelled(self, word):
        return self.rng.choice(SPELLED.get(word, [word]))

    def _prefix(self, word, operand):
        level, few, full = operand
        head = self._spelled(word) + self._window(word)
        own = PREFIX[word]
        return own, f"{head} {few if level >= own else f'({few})'}", f"({head} ({full}))"

    def _infix(self, word, left, right):
        own = INFIX[word]
        head = self._spelled(word) + self._window(word)
        before = left[1] if left[0] >= own and not _open(left) else f"({left[1]})"
        after = right[1] if right[0] > own else f"({right[1]})"
        return own, f"{before} {head} {after}", f"(({left[2]}) {head} ({right[2]}))"


def _open(operand):
    """A prefix operator at the end of a left operand would take in what follows, if it binds looser."""
    return any(word in operand[1] for word in SPELLED) and operand[0] != ATOM and not operand[1].endswith(")")


def case(rng):
    """A random spec with few brackets, the same with all, and a trace."""
    _, few, full = Writer(rng).formula(rng.randint(1, 3))
    length = rng.randint(2, 9)
    signals = {name: [float(rng.choice([-2, -1, 1, 2, 3])) for _ in range(length)] for name in SIGNALS}
    return f"out = {few}", f"out = {full}", signals


def own_values(text, signals):
    """What the imported spec gives at every sample."""
    bundle = stlspec.compile(convert(SourceText.of("rtamt", text), "rtamt", "step").text)
    used = {signal.name: signals[signal.name] for signal in bundle.signals}
    return bundle.evaluate(used, range(len(signals["a"])))["out"].signal.tolist()


def main(arguments=None):
    """Compare with RTAMT; return 1 if a value differs."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--work", type=Path, default=default_work(), help="where environments are kept")
    options = parser.parse_args(arguments)
    rng = random.Random(options.seed)
    cases = [case(rng) for _ in range(options.cases)]
    lines = [
        json.dumps({"formula": few.removeprefix("out = "), "signals": signals, "times": list(range(len(signals["a"])))})
        for few, _, signals in cases
    ]
    try:
        env = environment("rtamt", options.work)
    except NotInstalledError as error:
        print(f"rtamt: SKIPPED, {error}")
        return 0
    done = env.run(DRIVERS / "run_rtamt.py", "\n".join(lines) + "\n", 60 + options.cases)
    head, *found = [json.loads(line) for line in done.stdout.splitlines()]
    wrong = samples = refused = 0
    for (few, _, signals), answer in zip(cases, found, strict=True):
        if "error" in answer:
            # A division by 0, or an ambiguity that its parser reports as an exception.
            refused += 1
            continue
        ours = own_values(few, signals)
        theirs = [value for _, value in answer.get("values", [])]
        samples += len(ours)
        if ours != theirs:
            wrong += 1
            print(f"  {few}\n    {signals}\n    RTAMT {answer}\n    here  {ours}")
    print(f"rtamt {head['version']}: {len(cases)} imported specs, {samples} samples, {wrong} specs differ")
    print(f"  {refused} that RTAMT refuses are left out")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
