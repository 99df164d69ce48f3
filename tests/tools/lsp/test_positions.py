"""Columns are counted as the editor counts them, and no place leads outside the text."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.tools.lsp.positions import Lines, Place

ENCODINGS = ("utf-8", "utf-16", "utf-32")
ODD = st.text(st.sampled_from("ab\t é中😀\u2028\x0b\r\n"), max_size=30)


def reference(text, offset, encoding):
    """Count line ends before the offset, and encode what stands before it on its line."""
    ends = [m.end() for m in re.finditer(r"\r\n|\r|\n", text) if m.end() <= offset]
    before = text[ends[-1] if ends else 0 : offset]
    width = {"utf-8": 1, "utf-16": 2, "utf-32": 4}[encoding]
    return Place(len(ends), len(before.encode(f"{encoding}-le" if width > 1 else encoding)) // width)


@pytest.mark.parametrize(
    ("encoding", "column"),
    [("utf-8", 4 + 2 + 3 + 1 + 1), ("utf-16", 2 + 1 + 1 + 1 + 1), ("utf-32", 5)],
)
def test_astral_accented_and_tab_each_count_as_the_encoding_says(encoding, column):
    lines = Lines("first\r\n😀é中\tx = 1\r\n", encoding)
    assert lines.place(7 + 5) == Place(1, column)
    assert lines.offset(1, column) == 7 + 5


@pytest.mark.parametrize("encoding", ENCODINGS)
@given(ODD)
def test_every_offset_but_the_middle_of_a_line_end_goes_there_and_back(encoding, text):
    lines = Lines(text, encoding)
    for offset in range(len(text) + 1):
        if text[offset - 1 : offset + 1] == "\r\n" and offset:
            continue
        place = lines.place(offset)
        assert place == reference(text, offset, encoding)
        assert lines.offset(place.line, place.character) == offset


def test_the_middle_of_a_line_end_is_the_end_of_the_line():
    assert Lines("ab\r\nc").place(3) == Place(0, 2)


@pytest.mark.parametrize("encoding", ENCODINGS)
@given(ODD, st.integers(-3, 40), st.integers(-3, 60))
def test_no_place_leads_outside_its_line(encoding, text, line, character):
    lines = Lines(text, encoding)
    offset = lines.offset(line, character)
    assert 0 <= offset <= len(text)
    if 0 <= line < len(re.findall(r"\r\n|\r|\n", text)) + 1:
        assert lines.place(offset).line == line


def test_a_place_inside_a_character_is_its_beginning():
    assert Lines("a😀b").offset(0, 2) == 1
    assert Lines("a😀b", "utf-8").offset(0, 3) == 1


def test_a_line_ends_at_no_other_character():
    assert Lines("a\u2028b\x0bc\x85d").place(6) == Place(0, 6)
