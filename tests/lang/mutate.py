"""Good specs with one or two statements broken, and what the checker says of them.

`python -m tests.lang.mutate --cases 3000 --seed 0`, from the root of the repository, prints the counts. A
statement counts as broken if it cannot be parsed alone; mutants that still parse are left out.
"""

import argparse
import random
import re
import sys
from dataclasses import dataclass, field

from stlspec.compiler.compiling import check_source
from stlspec.lang.parse import parse
from stlspec.source import SourceText

SPECS = [
    """spec grid_single_goal "Single-goal grid-world"
time step
signal d_obs  "Manhattan distance to the nearest obstacle"
signal d_goal "Manhattan distance to the goal"
param  T_goal = 8
let at_goal = d_goal < 1
hard avoid "Never touch an obstacle":
    always (d_obs >= 1)
soft reach "Get to the goal" depends on avoid:
    eventually at_goal
soft fast "Get there in time" depends on avoid, reach:
    eventually[0, T_goal] at_goal""",
    """spec car "Keep a safe distance"
time 100 ms
signal gap unit "m" in [0, 200] from "obs.gap[0]"
signal speed unit "m/s" in [0, 60]
signal brake: bool "pressed"
param reaction = 1.5 s "time to react"
param far = 120 m
let close = gap < 2 s * speed + 5 m
let calm = abs(rate(speed) * 1 ms) < 3 m/s
hard keep depends on stop: always (close implies eventually[0, reaction] not close)
hard stop scale 2 bound linear: always (gap < 10 m -> F[0, 2 s] speed == 0)
soft smooth "no jerks" depends on keep: G (calm or brake)
soft progress depends on keep, smooth:
    eventually[0, 1 min] (gap > far
        and speed > 3 m/s)""",
    """time s
signal x
signal y
let up = x > y until[0, 5 s] (x < 3 or y <= -2)
let seen = once[1 s, 2 s] (x ** 2 + y ** 2 > min(x, y, 4))
hard first: always[0 s, 10 s] (up implies next seen)
hard second depends on first: (not up) since[0, 3 s] seen
soft third "last" depends on first, second scale 0.5: historically (0 <= x <= 5)""",
    """spec alarm  # comments and aliases
signal pressure unit "bar"   # in the tank
signal valve: bool
let high = pressure > 8 bar
hard vent:
    # a comment within
    G[0, 100] (high => F[0, 3] valve)
hard never depends on vent: !(high && X high && X X high)
soft calm depends on vent, never: (valve R high) <-> (valve W high)""",
    """spec tested "A spec with templates and its own tests"
signal d_obs
signal d_goal unit "m"
param far = 3 m
let near(x, r) = x < r
let soon(p, k) = eventually[0, k] (p and not near(d_obs, 1))
hard avoid: always not near(d_obs, 1)
soft reach depends on avoid: soon(near(d_goal, far), 20)
expect avoid fails on {d_obs: [2, 0.5, 3], time: [0, 1, 2]} at 1 margin >= 0.5
expect reach holds on "demos/one.csv" episode 3
expect "demos/one.csv" episode "a detour" is incomplete
expect "demos/one.csv" outranks "demos/two.csv"  # at last""",
]
BEGINS = re.compile(r"(spec|time|signal|param|let|hard|soft|expect)\b")
TOKEN = re.compile(r'#[^\n]*|"[^"\n]*"|[A-Za-z_][A-Za-z_0-9]*|[0-9.]+|[<>=!*&|:-]+|\S')


def statements(spec):
    """Cut a good spec at lines that begin a statement at their first column."""
    found = []
    for line in spec.split("\n"):
        if BEGINS.match(line) or not found:
            found.append(line)
        else:
            found[-1] += "\n" + line
    return found


def mutate(rng, text):
    """Break a statement, or try to."""
    tokens = [t for t in TOKEN.finditer(text) if not t[0].startswith("#")]
    if not tokens:
        return text
    k = rng.randrange(len(tokens))
    token = tokens[k]
    kind = rng.choice(["delete", "double", "swap", "misspell", "cut", "unclosed", "stray"])
    if kind == "delete":
        return text[: token.start()] + text[token.end() :]
    if kind == "double":
        return text[: token.end()] + " " + token[0] + text[token.end() :]
    if kind == "swap" and k + 1 < len(tokens):
        after = tokens[k + 1]
        return f"{text[: token.start()]} {after[0]} {text[token.end() : after.start()]} {token[0]}{text[after.end() :]}"
    if kind == "misspell":
        words = [t for t in tokens if t[0].isalpha() and len(t[0]) > 3]
        if words:
            word = rng.choice(words)
            at = rng.randrange(word.start(), word.end() - 1)
            return text[:at] + text[at + 1] + text[at] + text[at + 2 :]
    if kind == "cut":
        return text[: token.start()].rstrip()
    if kind == "unclosed":
        closing = [i for i, c in enumerate(text) if c in '()[]"']
        if closing:
            at = rng.choice(closing)
            return text[:at] + text[at + 1 :]
    return text[: token.start()] + rng.choice(["§", "{", ";", ")", "]", ",", "and", "3"]) + " " + text[token.start() :]


@dataclass
class Counts:
    """What the checker said of all mutants."""

    broken: int = 0
    found: int = 0
    placed: int = 0
    diagnostics: int = 0
    good: int = 0
    blamed: int = 0
    examples: list[str] = field(default_factory=list)

    def report(self):
        return (
            f"{self.broken} broken statements: {self.found / self.broken:.2%} found, "
            f"{self.placed / self.broken:.2%} in the right lines, "
            f"{self.diagnostics / self.broken:.3f} diagnostics each; "
            f"{self.blamed / self.good:.2%} of {self.good} good statements blamed"
        )


def run(cases, seed):
    """Check `cases` mutants that do not parse."""
    rng, counts = random.Random(seed), Counts()
    pieces = [statements(spec) for spec in SPECS]
    while cases:
        parts = list(rng.choice(pieces))
        chosen = set(rng.sample(range(len(parts)), rng.choice([1, 1, 2])))
        for i in chosen:
            parts[i] = mutate(rng, parts[i])
        # A statement that was cut away whole is no longer there, and uses of its name are rightly reported.
        if all(parts[i].strip() and parse(SourceText.of("alone", parts[i])).diagnostics for i in chosen):
            _count(counts, parts, chosen)
            cases -= 1
    return counts


def _count(counts, parts, chosen):
    text = "\n".join(parts)
    errors = [d for d in check_source(SourceText.of("mutant.stl", text)).diagnostics if d.severity == "error"]
    lines = [d.source.position(d.span.start).line for d in errors]
    at = 1
    for i, part in enumerate(parts):
        inside = [n for n in lines if at <= n <= at + part.count("\n")]
        at += part.count("\n") + 1
        if i in chosen:
            counts.broken += 1
            counts.found += bool(inside) or len(errors) >= len(chosen)
            counts.placed += bool(inside)
        else:
            counts.good += 1
            counts.blamed += bool(inside)
            if inside:
                counts.examples.append(
                    "\n".join([text, *(f"{n}: {d.code} {d.message}" for n, d in zip(lines, errors, strict=True))])
                )
    counts.diagnostics += len(errors)
    if len(errors) != len(chosen):
        counts.examples.append(
            "\n".join(
                [
                    f"WANTED {len(chosen)}",
                    text,
                    *(f"{n}: {d.code} {d.message}" for n, d in zip(lines, errors, strict=True)),
                ]
            )
        )


def main(arguments=None):
    """Print the counts, and with -v what went wrong."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-v", action="store_true")
    options = parser.parse_args(arguments)
    counts = run(options.cases, options.seed)
    print("\n-----\n".join([*(counts.examples if options.v else []), counts.report()]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
