"""At most five things are named, in the words of the language; pieces of the text are short and printable."""

import pytest

from stlspec.lang.expected import expected, quoted


@pytest.mark.parametrize(
    ("terminals", "words"),
    [
        ("", "nothing more"),
        ("NAME", "a name"),
        ("RPAR AND OR", "`)` or an operator"),
        ("NAME NUMBER LPAR NOT", "a formula"),
        ("NAME NUMBER LPAR", "a number or a signal"),
        ("STRING DEPENDS SCALE BOUND COLON", "`:`, a quoted text, `depends on`, `scale` or `bound`"),
        ("COMMA COLON RSQB STRING DEPENDS SCALE BOUND", "`,`, `:`, `]`, a quoted text or `depends on`"),
    ],
)
def test_what_fits_is_named_in_words(terminals, words):
    assert expected(frozenset(terminals.split())) == words


def test_a_quoted_piece_is_short_and_printable():
    assert quoted("d\u200b") == "`d\\u200b`"
    assert quoted("x" * 40) == "`" + "x" * 29 + "…`"
