"""After every edit the result is that of a fresh parse, and only what was touched is read again."""

import random

import pytest

from stlspec.lang.incremental import Incremental
from stlspec.lang.nodes import post_order
from stlspec.lang.parse import parse
from stlspec.source import SourceText
from tests.benchmarks.parsing import spec_of
from tests.lang.compose import Composer
from tests.lang.soup import TOKENS, soup

SCRAPS = [
    *("\n", "\r\n", "\r", "\n\n", " ", "\t", "\f", "#", "# é\n", "//", '"', '"doc"', "(", ")", "[", "]", "{", "}", ","),
    *(
        "é",
        "\u2028",
        "\ufeff",
        "§",
        "∧",
        "𝛼",
        "\nsignal G",
        "\nsignal U\n",
        "\nparam s = 1\n",
        "\ntime = 5\n",
        "\ntime",
    ),
    *(
        " s\n",
        "\n  spec",
        " x\n",
        "\nuse",
        ' "a.stl"\n',
        "\nhrad a: x > 1\n",
        "\nlet f(a, G) = a U G\n",
        "hard",
        "é signal",
    ),
]


def source(text):
    return SourceText.of("s.stl", text)


def edited(text, rng):
    """The text with one stretch of it replaced: by nothing, words, scraps, or a piece of itself."""
    start = rng.randint(0, len(text))
    end = min(len(text), start + rng.choice([0, 0, 0, 1, 1, 2, 5, 20, 100]))
    kind = rng.random()
    if kind < 0.3:
        new = rng.choice(SCRAPS)
    elif kind < 0.5:
        new = rng.choice(TOKENS)
    elif kind < 0.6:
        cut = rng.randint(0, len(text))
        new = text[cut : cut + 60]
    else:
        new = ""
    return text[:start] + new + text[end:]


def begun(rng):
    """A text to begin with: a good spec, one written badly, or soup."""
    badly = "\n".join(" ".join(map(str, statement)) for statement in Composer(rng).spec())
    return rng.choice([spec_of(30), badly, badly, soup(rng)])


@pytest.mark.parametrize("seed", range(12))
def test_random_edits_end_as_a_fresh_parse_after_each(seed):
    rng = random.Random(seed)
    text, incremental = begun(rng), Incremental()
    for _ in range(60):
        names = frozenset(rng.choice([[], [], ["G", "s", "x"], ["U", "T", "W"]]))
        assert incremental.parse(source(text), names) == parse(source(text), names), text
        text = edited(text, rng)


def test_undoing_and_typing_letter_by_letter_end_as_a_fresh_parse():
    before, typed, after = "signal x\nhard a: x > 1\n", 'soft b "U" depends on a: G x U\n (x S 2 s', "\nsignal G\n"
    incremental = Incremental()
    for end in [*range(len(typed)), *reversed(range(len(typed)))]:
        text = before + typed[:end] + after
        assert incremental.parse(source(text)) == parse(source(text))


def test_one_edit_in_a_thousand_lines_reads_one_statement():
    text, incremental = spec_of(1000), Incremental()
    first = incremental.parse(source(text))
    assert incremental.work.lexed == incremental.work.parsed == len(first.statements) == 800
    for old, new in [
        ("d_50 >= 1", "d_50 >= 11"),
        ("# What is near", "# What was near"),
        ("param T_7 = 8.5", "param T_7 = 8"),
    ]:
        text = text.replace(old, new, 1)
        assert incremental.parse(source(text)) == parse(source(text))
        assert (incremental.work.lexed, incremental.work.parsed) == (1, 1)
    incremental.parse(source(text))
    assert (incremental.work.lexed, incremental.work.parsed) == (0, 0)


def test_a_new_name_reads_again_only_statements_that_hold_it():
    text = "signal x\n" + "".join(f"hard r{i}: always (x > {i})\n" for i in range(200)) + "hard z: G x > 1\n"
    incremental = Incremental()
    incremental.parse(source(text))
    text = text.replace("signal x\n", "signal x\nsignal G\n")
    assert incremental.parse(source(text)) == parse(source(text))
    assert (incremental.work.lexed, incremental.work.parsed) == (1, 2)


def test_a_line_that_joins_or_leaves_a_statement_is_read_with_it():
    incremental = Incremental()
    for line in ["time > 3", "time 3", "time = 3", "use and p", 'use "f"', "spec q", "spec and q", "signal q"]:
        text = f"let p = x and\n  {line}\nsignal x\n"
        assert incremental.parse(source(text)) == parse(source(text))
        assert incremental.work.parsed <= 3


def test_statements_that_stay_in_place_stay_the_same_nodes_and_others_are_new():
    text = "signal x\nhard a: x > 1\nhard b: x > 2\nhard b: x > 2\n"
    incremental = Incremental()
    first = incremental.parse(source(text)).statements
    second = incremental.parse(source(text.replace("a: x > 1", "a: x > 10"))).statements
    assert [one is two for one, two in zip(first, second, strict=True)] == [True, False, False, False]
    nodes = [id(node) for statement in first[1:] for node in post_order(statement.formula)]
    assert len(set(nodes)) == len(nodes)


def test_ways_out_are_tried_for_as_many_broken_statements_as_in_a_fresh_parse():
    broken = ["hard a: (x > 1\n" for _ in range(230)]
    incremental = Incremental()
    incremental.parse(source("".join(broken)))
    for start, end in [(0, 0), (0, 100), (50, 60), (0, 1), (199, 230)]:
        text = "".join([*broken[:start], "signal x\n" * (end - start), *broken[end:]])
        assert incremental.parse(source(text)) == parse(source(text))


def test_deep_texts_are_moved_without_deep_stacks():
    incremental = Incremental()
    for text in ["hard a: " + "not " * 3000 + "p\n", "signal x\nhard a: " + "not " * 3000 + "p\n"]:
        assert incremental.parse(source(text)).diagnostics == parse(source(text)).diagnostics


def test_another_name_of_the_text_stands_in_its_diagnostics():
    incremental = Incremental()
    for name in ("one.stl", "two.stl"):
        other = SourceText.of(name, "hard a: x >\n")
        assert incremental.parse(other) == parse(other)
        assert incremental.parse(other).diagnostics[0].file == name


def test_what_is_no_longer_in_the_text_is_forgotten():
    incremental = Incremental()
    for i in range(50):
        incremental.parse(source(f"signal x{i}\nhard a: x > {i}\n"))
    incremental.parse(source("signal x0\n"))
    assert incremental.work.lexed == 1
