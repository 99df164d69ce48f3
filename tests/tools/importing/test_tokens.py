"""The tokens of foreign specs, their places, and what is said where one does not fit."""

import pytest

from stlspec.source import SourceText
from stlspec.tools.importing.tokens import Cursor, Unreadable, lex, number_of

WORD, SIGNS, COMMENT = r"[a-z_]+", (":=", "<=", "<", "(", ")"), r"#[^\n]*"


def cut(text):
    return lex(SourceText.of("f", text), WORD, SIGNS, COMMENT)


def test_tokens_have_kinds_and_places_and_know_which_begins_a_line():
    tokens, comments = cut("phi := (x <= 1.5e3)  # a comment\n# of its own\nmu <'q'")
    assert [(t.kind, t.text) for t in tokens] == [
        *(("word", "phi"), ("sign", ":="), ("sign", "("), ("word", "x"), ("sign", "<="), ("number", "1.5e3")),
        *(("sign", ")"), ("word", "mu"), ("sign", "<"), ("text", "'q'"), ("end", "")),
    ]
    assert [t.text for t in tokens if t.begins_line] == ["phi", "mu", ""]
    assert [(c.lines, c.trails) for c in comments] == [(("a comment",), True), (("of its own",), False)]


def test_what_no_language_has_is_a_sign_that_no_parser_takes():
    assert [t.text for t in cut("x § y")[0]] == ["x", "§", "y", ""]


@pytest.mark.parametrize(
    ("text", "value"), [("5", 5), ("1_000", 1000), ("0x10", 16), ("0b11", 3), (".5", 0.5), ("2.", 2)]
)
def test_numbers_are_read_as_the_tools_read_them(text, value):
    assert number_of(text) == value


def test_a_cursor_takes_what_fits_and_refuses_what_does_not_at_its_place():
    source = SourceText.of("f", "x <= 1")
    cursor = Cursor(source, cut("x <= 1")[0], "Tool")
    assert cursor.takes("y") is None and cursor.need_word().text == "x" and cursor.before.text == "x"
    with pytest.raises(Unreadable) as caught:
        cursor.need("(")
    problem = caught.value.problem
    assert (problem.code, source.slice(problem.span), problem.label) == ("S041", "<=", "expected `(`")
    assert "in a spec of Tool" in problem.message
    cursor.take(), cursor.take(), cursor.take(), cursor.take()
    assert cursor.at_end
