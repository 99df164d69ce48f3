"""Whatever a user names stays text: in children, in attributes, in any script."""

from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.markup.elements import Markup, element, join, number, short, text, trusted


class Seen(HTMLParser):
    """Records the elements and the text that a browser would see."""

    def __init__(self, source: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[tuple[str, dict]] = []
        self.data = ""
        self.feed(source)
        self.close()

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.data += data


@given(st.text(), st.text())
def test_no_text_becomes_markup_whatever_it_is(child: str, value: str) -> None:
    seen = Seen(element("p", child, title=value))
    assert [tag for tag, _ in seen.tags] == ["p"]
    assert set(seen.tags[0][1]) == {"title"}


def test_a_script_in_a_name_is_shown_not_run() -> None:
    seen = Seen(element("p", "<script>alert(1)</script>", title='"><img onerror=x>'))
    assert seen.data == "<script>alert(1)</script>"
    assert seen.tags == [("p", {"title": '"><img onerror=x>'})]


def test_markup_is_nested_and_none_left_out() -> None:
    inner = element("b", "x")
    assert element("p", inner, None, " & ", 3, class_="a", hidden=False, aria_label="b", open=True) == (
        '<p class="a" aria-label="b" open><b>x</b> &amp; 3</p>'
    )
    assert element("br") == "<br>"
    assert join([inner, "<"], "-") == "<b>x</b>-&lt;"
    assert isinstance(trusted("<i>"), Markup)
    assert text(trusted("<i>")) == "<i>"


def test_characters_that_no_page_can_hold_are_replaced() -> None:
    assert text("a\x00b\x1b\ud800\u202ec") == "a\ufffdb\ufffd\ufffd\ufffdc"


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (1.0, "1"),
        (14200.0, "14200"),
        (1.5e9, "1.5e+09"),
        (14200.5, "1.42e+04"),
        (-0.0, "0"),
        (0.123456, "0.1235"),
        (float("inf"), "∞"),
        (-float("inf"), "-∞"),
        (None, "–"),
    ],
)
def test_numbers_for_people(value: float | None, expected: str) -> None:
    assert number(value) == expected


def test_a_long_name_keeps_both_ends_and_one_line() -> None:
    assert short("a\nb  c") == "a b c"
    assert short("x" * 200 + "end", 20) == "x" * 10 + "…" + "x" * 6 + "end"
    assert len(short("y" * 500, 33)) == 33
