"""Parsing to the syntax tree beside a bare Lark parse of the same text.

    python -m tests.benchmarks.parsing [--lines 1000] [--rounds 15]

Bare Lark: the same grammar with `start: statement+` before it and comments ignored, `parser="lalr"`, `lexer="basic"`,
all else as Lark has it: its own lexer, its own loop, its own trees, which hold no places. Both read the whole text,
in turn, in one process, by CPU seconds; a figure is the median of the rounds. Lark cannot read words that are
names in one place and words of the language in another, nor units, so that the text has neither. The last row is what
an editor pays for an edit.
"""

import argparse
import sys
from itertools import cycle

from lark import Lark

from stlspec.lang.grammar import grammar_text
from stlspec.lang.incremental import Incremental
from stlspec.lang.parse import parse
from stlspec.source import SourceText
from tests.benchmarks.contest import Figure, OwnFailureError
from tests.benchmarks.peers.measuring import CoarseClockError, check_clock, seconds_a_call
from tests.benchmarks.table import Goal, Section, text_of

BLOCK = """\
signal d_{i} : real unit "m" in [0, 100] from "log.d{i}" "Distance to obstacle {i}"
signal v_{i} : real
param T_{i} = 8.5 "How long"
# What is near depends on how fast it comes.
let near_{i} = 2 * d_{i} < 1 and not (v_{i} ** 2 <= 0 or abs(d_{i} - 50) > 40)
let calm_{i} = 0 <= v_{i} < 3
hard apart_{i} "Never touch obstacle {i}": always (d_{i} >= 1)
soft meet_{i} "Meet it once" depends on apart_{i} scale 2: eventually[0, T_{i}] (near_{i} and calm_{i})
soft leave_{i} depends on apart_{i}, meet_{i}:
    always[0, 100] (near_{i} implies eventually[0, T_{i} + 2] not near_{i} until[0, 10] calm_{i})
"""


def spec_of(lines):
    """A spec of so many lines, comments and blank lines among them."""
    block = BLOCK.count("\n")
    text = "".join(BLOCK.replace("{i}", str(i)) for i in range(lines // block + 1))
    return "".join(text.splitlines(keepends=True)[:lines])


def bare_lark(**options):
    """Lark with the grammar of the language for a whole text, and nothing of stlspec."""
    whole = f"start: statement+\n%ignore COMMENT\n{grammar_text()}"
    return Lark(whole, parser="lalr", lexer="basic", start=["start", "lexicon"], **options)


def readers(text):
    """Functions that parse `text`, by label. Raises: OwnFailureError: they do not find the same statements."""
    source = SourceText.of("made.stl", text)
    bare = bare_lark()
    placed = bare_lark(keep_all_tokens=True, propagate_positions=True)
    syntax = parse(source)
    found = [len(lark.parse(text, start="start").children) for lark in (bare, placed)]
    if syntax.diagnostics or found != [len(syntax.statements)] * 2:
        raise OwnFailureError(f"{len(syntax.statements)} statements, {found} by Lark; {syntax.diagnostics[:1]}")
    return {
        "bare Lark": lambda: bare.parse(text, start="start"),
        "bare Lark that keeps tokens and places": lambda: placed.parse(text, start="start"),
        "stlspec.lang.parse": lambda: parse(source),
        "the same after an edit in the middle": edits(text),
    }


def edits(text):
    """A function that parses `text`, and in turn the same with a number written longer in its middle."""
    at = text.index("8.5", len(text) // 2)
    texts = cycle(SourceText.of("made.stl", text[:at] + number + text[at + 3 :]) for number in ("8.5", "12.75"))
    incremental = Incremental()
    return lambda: incremental.parse(next(texts))


def measured(lines, rounds):
    """Time all readers in turn and return the section with the goal."""
    calls = readers(spec_of(lines))
    seconds = {label: [] for label in calls}
    for turn in range(rounds + 1):
        for label, call in calls.items():
            taken = seconds_a_call(call, 0.0)
            if turn:  # the first one fills caches
                seconds[label].append(taken)
    figures = {label: Figure.of(values) for label, values in seconds.items()}
    section = Section(f"parsing {lines} lines")
    section.contest(figures, "ms")
    ratio = figures["stlspec.lang.parse"].median / figures["bare Lark"].median
    section.goals = [Goal("times a bare Lark parse", ratio, 1.5, at_least=False)]
    return section


def parsing(arena, data):
    """The part of `run.py`."""
    return measured(1000, 5 if arena.quick else 15)


def main(arguments=None):
    """Print medians and their ratio; return 1 if the goal is missed, 2 where nothing can be timed."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--lines", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args(arguments)
    try:
        check_clock()
    except CoarseClockError as error:
        print(f"refused: {error}", file=sys.stderr)
        return 2
    section = measured(options.lines, options.rounds)
    print(text_of(section))
    return 0 if section.goals[0].met else 1


if __name__ == "__main__":
    sys.exit(main())
