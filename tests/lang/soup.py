"""Texts without sense: token soup, random characters, random bytes read as Latin-1.

`python -m tests.lang.soup --cases 50000 --seed 0`, from the root of the repository, checks them all.
"""

import argparse
import random
import sys
import time

from stlspec.compiler.compiling import check_source
from stlspec.errors import render
from stlspec.source import SourceText

TOKENS = (
    "spec use time signal param let hard soft expect always eventually historically once until since unless release "
    "next prev wnext wprev not and or xor implies iff true false inf depends on scale bound unit in from G F H O X Y "
    'U S W R alw ev_ until_ ! & && | || -> => <-> <=> < <= > >= == != = + - * / ** ( ) [ ] { } , : := " "doc" # // '
    "x y p q d_obs abs min rate delta now t real bool tanh none 0 1 5 .5 1e400 12. s ms m/s step m "
    "ns min furlong § \\ ' ; ^ "
    "holds fails episode at margin is outranks "
    "hrad sginal alwys x[t] x[t+1] [0,5] [5,2] [0 5] (d>1)"
).split()
STARTS = ["signal x\n", "hard a: ", "soft b depends on a: ", "let p = ", "param T = ", "time ", "\n"]


def soup(rng):
    """A text of one of three kinds, at most about 400 characters."""
    kind = rng.random()
    if kind < 0.6:
        words = [rng.choice(TOKENS) if rng.random() < 0.85 else rng.choice(STARTS) for _ in range(rng.randint(0, 60))]
        return "".join(word + rng.choice([" ", " ", " ", "", "\n", "\r"]) for word in words)
    if kind < 0.8:
        return "".join(
            chr(rng.choice([rng.randint(32, 126), rng.randint(0, 0x2100), 10])) for _ in range(rng.randint(0, 200))
        )
    return rng.randbytes(rng.randint(0, 300)).decode("latin-1")


def fault(text):
    """What is wrong with the checker on `text`: a place outside it, a drawing that fails, nothing said; else None."""
    source = SourceText.of("soup.stl", text)
    result = check_source(source)
    for problem in result.diagnostics:
        spans = [problem.span, *(label.span for label in problem.labels)]
        if any(span is None or not 0 <= span.start <= span.end <= len(source.text) for span in spans):
            return f"{problem.code} is outside of the text"
        if "\n" in problem.message or not render(problem) or not problem.to_json():
            return f"{problem.code} cannot be shown"
    declared = result.model.declared
    stated = declared.signals or declared.params or declared.lets or declared.requirements or declared.spec_name
    if not result.diagnostics and not stated and "time" not in text:
        return "nothing is said of a text that says nothing"
    return None


def main(arguments=None):
    """Check random texts; return 1 if one shows a fault."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=50_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    rng = random.Random(options.seed)
    faults, slowest = [], 0.0
    for _ in range(options.cases):
        text = soup(rng)
        before = time.perf_counter()
        found = fault(text)
        slowest = max(slowest, time.perf_counter() - before)
        if found:
            faults.append(f"{found}: {text!r}")
    print("\n".join([*faults[:5], f"{options.cases} texts, {len(faults)} faults, slowest {slowest * 1000:.0f} ms"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
