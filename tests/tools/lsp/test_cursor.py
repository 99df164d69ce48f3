"""The words around a place are found whatever stands elsewhere in the text."""

import pytest

from stlspec.source import SourceText
from stlspec.tools.lsp.cursor import before, statement_at, token_at

TEXT = """# first
signal time
hard a: always (
    time > 3   # not a statement
hard b: ]] "open
time 5 s
use "x.stl"
spec
"""


def at(mark, text=TEXT):
    return text.index(mark)


@pytest.mark.parametrize(
    ("mark", "statement"),
    [
        ("first", "# first\n"),
        ("> 3", "hard a: always (\n    time > 3   # not a statement\n"),
        ('"open', 'hard b: ]] "open\n'),
        ("5 s", "time 5 s\n"),
        ("x.stl", 'use "x.stl"\n'),
    ],
)
def test_a_statement_runs_from_its_line_to_the_next_ones(mark, statement):
    span = statement_at(TEXT, at(mark))
    assert TEXT[span.start : span.end] == statement


def test_the_token_at_a_place_has_its_place_in_the_whole_text():
    source = SourceText.of("a.stl", TEXT)
    token = token_at(source, at("always") + 2)
    assert (token.kind, token.text, source.slice(token.span)) == ("ALWAYS", "always", "always")
    assert token_at(source, at("not a")) is None


def test_what_is_typed_is_parted_from_what_stands_before_it():
    source = SourceText.of("a.stl", TEXT)
    word, tokens = before(source, at("always") + 3)
    assert word == "alw"
    assert [token.text for token in tokens] == ["hard", "a", ":"]
    word, tokens = before(source, at("always"))
    assert word == ""


def test_a_quoted_text_that_is_open_is_a_token():
    source = SourceText.of("a.stl", 'use "da')
    word, tokens = before(source, 7)
    assert word == "da"
    assert [token.kind for token in tokens] == ["USE", "BAD_STRING"]
