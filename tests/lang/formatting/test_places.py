"""Where tokens and comments stand."""

from stlspec.lang.formatting.places import Places
from stlspec.lang.parse import parse
from stlspec.source import SourceText, Span

TEXT = 'signal x  # one\n\n   // two\nhard a "d" depends on # three\n b: x > - 5 m/s\n'
SOURCE = SourceText.of("s", TEXT)
PLACES = Places.of(SOURCE, parse(SOURCE).comments)


def test_comments_know_their_line():
    shown = [(c.text, c.trailing, c.blank_above) for c in PLACES.comments]
    assert shown == [("# one", True, False), ("// two", False, True), ("# three", True, False)]


def test_the_word_before_a_place_is_found_over_comments():
    assert PLACES.before(TEXT.index(" b:") + 1, 2) == TEXT.index("depends")


def test_words_and_comments_of_a_span():
    minus = TEXT.index("- 5")
    assert PLACES.words(Span(minus, minus + 3)) == ["-", "5"]
    assert PLACES.has_comment(Span(0, 16))
    assert not PLACES.has_comment(Span(minus, len(TEXT)))
