"""Where a text is cut into statements, and what broken ones may have declared."""

import pytest

from stlspec.lang.grammar import build
from stlspec.lang.parse import parse
from stlspec.lang.statements import NOTHING_LOST, cut, is_word
from stlspec.source import SourceText

LARK = build()


def pieces(text):
    return [[str(token) for token in piece] for piece in cut(SourceText.of("s", text), LARK).statements]


@pytest.mark.parametrize(
    ("text", "firsts"),
    [
        ("signal x\nparam p\nlet q = x > (1\nhard a: q\nsoft b: [\nexpect a", "signal param let hard soft expect"),
        ("spec a\ntime s\nuse \"f\"\nsignal x", "spec time use signal"),
        ("let p = x and\n  time > 3\nlet q = p", "let let"),
        ("let p = x and\n  time 100 ms", "let time"),
        ("let p = x and\n  time step", "let time"),
        ("let p = x and\n  spec and p", "let"),
        ("let p = x and\n  spec q", "let spec"),
        ("let p = x and\n  use and p", "let"),
        ("signal x signal y", "signal"),
        ("  signal x\n\t hard a: x > 1", "signal hard"),
        ("/* no */ signal x", "/"),
    ],
)  # fmt: skip
def test_a_statement_begins_at_its_word_first_on_a_line(text, firsts):
    assert [piece[0] for piece in pieces(text)] == firsts.split()


def test_names_are_collected_from_broken_statements_too():
    found = cut(SourceText.of("s", "signal x (\nparam p = =\nlet q\nhard a\nsoft b depends"), LARK)
    assert found.names == {"x", "p", "q"}
    assert found.requirement_names == {"a", "b"}


def test_comments_are_taken_out_and_kept():
    found = cut(SourceText.of("s", "# one\nsignal x // two"), LARK)
    assert [c.text for c in found.comments] == ["# one", "// two"]
    assert pieces("# one\nsignal x // two") == [["signal", "x"]]


def test_every_keyword_is_spelled_like_a_word_and_signs_are_not():
    tokens = cut(SourceText.of("s", "signal x_1 : 5 ->"), LARK).statements[0]
    assert [is_word(token) for token in tokens] == [True, True, False, False, False]


@pytest.mark.parametrize(
    ("text", "names", "nameless", "time"),
    [
        ("signal x", set(), False, False),
        ("sginal x", {"sginal", "x"}, False, True),
        ("x : bool", {"x", "bool"}, False, True),
        ("signal : bool", {"signal", "bool"}, True, False),
        ('signal always unit "m"', {"signal", "unit"}, True, False),
        ("hard scale 2 bound tanh: x > 1", {"scale"}, True, False),
        ("let § p = x > 1", {"let", "p"}, False, False),
        ("hard : x > 1", {"hard"}, True, False),
        ("tiem s", {"tiem", "s"}, False, True),
        ("signal alarmbool :", {"alarmbool", "alarm"}, False, False),
        ("signal d, e, f", {"signal", "d", "e", "f"}, False, False),
        ("signal x hard a: x > 1", {"signal", "x", "hard", "a"}, False, False),
    ],
)
def test_what_a_broken_statement_may_have_declared_is_remembered(text, names, nameless, time):
    lost = parse(SourceText.of("s", text)).lost
    assert (lost.nameless, lost.time) == (nameless, time)
    assert lost.names >= names
    assert lost == NOTHING_LOST or names


@pytest.mark.parametrize("text", ['signal x unit "ppm" in [0', "signal x unit ppm in [0, 1]", 'sginal x unit "ppm"'])
def test_the_unit_of_a_broken_signal_is_remembered(text):
    assert "ppm" in parse(SourceText.of("s", text)).lost.units
