"""Lines, columns and excerpts of a text, as the user wrote it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.source import Position, SourceText, Span

TEXTS = st.text(st.sampled_from("ab\n\r\t #\ufeffé€😀\u2028\0"), max_size=40)


@pytest.mark.parametrize(
    ("text", "offset", "line", "column"),
    [
        ("abc", 0, 1, 1),
        ("abc", 3, 1, 4),
        ("a\nb", 2, 2, 1),
        ("a\n", 2, 2, 1),
        ("a\r\nb", 3, 2, 1),
        ("a\rb", 2, 2, 1),
        ("\ufeffab", 1, 1, 2),
        ("é😀x", 2, 1, 3),
        ("a\u2028b", 2, 1, 3),
    ],
)
def test_positions_count_lines_at_lf_and_columns_in_code_points_from_one(text, offset, line, column):
    assert SourceText.of("s", text).position(offset) == Position(line, column)


@given(TEXTS)
def test_normalising_moves_no_offset_and_keeps_crlf(text):
    source = SourceText.of("s", text)
    assert len(source.text) == len(text.removeprefix("\ufeff"))
    assert source.text.count("\r\n") == text.count("\r\n")
    assert "\r" not in source.text.replace("\r\n", "")


@given(TEXTS, st.integers(0, 50), st.integers(0, 50))
def test_every_span_of_every_text_can_be_drawn(text, start, length):
    source = SourceText.of("s", text)
    start = min(start, len(source.text))
    excerpt, carets = source.excerpt(Span(start, min(start + length, len(source.text))), "note")
    assert "^" in carets and carets.endswith(" note")
    assert "\n" not in excerpt and excerpt.isprintable()


def test_carets_stand_under_the_span_after_tabs_too():
    lines = SourceText.of("s", "\tx\n  \tabc def").excerpt(Span(6, 9))
    assert lines == ["   2 |    abc def", "     |    ^^^"]


def test_a_span_over_several_lines_is_underlined_to_the_end_of_its_first():
    assert SourceText.of("s", "ab cd\nef").excerpt(Span(3, 8))[1].count("^") == 2


def test_a_long_line_is_cut_around_the_span():
    excerpt, carets = SourceText.of("s", "x" * 5000 + "here" + "y" * 5000).excerpt(Span(5000, 5004))
    assert len(excerpt) < 200
    assert excerpt[carets.index("^") : carets.index("^") + 4] == "here"


def test_half_surrogate_pairs_are_replaced_so_that_the_text_can_be_written():
    source = SourceText.of("a\udcff.stl", "x\ud800y")
    assert (source.name, source.text) == ("a\ufffd.stl", "x\ufffdy")


def test_a_span_that_holds_two():
    assert Span(5, 7).to(Span(1, 3)) == Span(1, 7)
    assert SourceText.of("s", "abcdef").slice(Span(1, 3)) == "bc"


def test_a_line_is_given_without_its_end():
    source = SourceText.of("s", "a\r\nb\n")
    assert [source.line(n) for n in (1, 2, 3)] == ["a", "b", ""]
