"""The words around a place are found whatever stands elsewhere in the text."""

import time

import pytest

from stlspec.source import SourceText
from stlspec.tools.lsp.cursor import statement_at, token_at, typed

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
    found = typed(source, at("always") + 3, frozenset())
    assert (found.word, source.slice(found.span)) == ("alw", "alw")
    assert [source.slice(token.span) for token in found.tokens] == ["hard", "a", ":"]
    assert {"NAME", "ALWAYS", "NOT"} <= found.fits
    assert typed(source, at("always"), frozenset()).word == ""


def test_a_quoted_text_that_is_open_is_a_token():
    found = typed(SourceText.of("a.stl", 'use "da'), 7, frozenset())
    assert found.word == "da"
    assert [token.kind for token in found.tokens] == ["USE", "BAD_STRING"]
    assert found.fits == frozenset()


@pytest.mark.parametrize(
    ("text", "word"), [("hard a: x > 5ms", "ms"), ("hard a: x > 5", ""), ("a_1", "a_1"), ("é_b", "_b"), ("", "")]
)
def test_a_word_is_made_of_letters_and_begins_with_none_of_the_digits(text, word):
    assert typed(SourceText.of("a.stl", text), len(text), frozenset()).word == word


def test_a_text_of_one_long_word_takes_no_time():
    text = "a" * 500_000 + " "
    began = time.process_time()
    assert typed(SourceText.of("a.stl", text), len(text), frozenset()).word == ""
    assert time.process_time() - began < 5
