"""Tables name their rows and columns; a verdict is a sign and a word."""

from xml.etree import ElementTree

from stlspec.markup.elements import element
from stlspec.markup.tables import ScoreRow, cell, heading, score_table, table, verdict_text


def test_headings_are_scoped_and_there_is_a_caption() -> None:
    rows = [[element("th", "r", scope="row"), cell(3)]]
    root = ElementTree.fromstring(table("All <of> it", ["a", heading("n", "number")], rows))
    assert root.find("caption").text == "All <of> it"
    assert [(e.text, e.get("scope"), e.get("class")) for e in root.iter("th")] == [
        ("a", "col", None),
        ("n", "col", "stl-number"),
        ("r", "row", None),
    ]


def test_a_verdict_has_a_word_for_those_who_do_not_see_the_sign() -> None:
    root = ElementTree.fromstring(verdict_text("violated", "-1"))
    sign, word = root.findall("span")
    assert (sign.text, sign.get("aria-hidden"), word.text, word.tail) == ("✗", "true", "fails ", "-1")


def test_scores_link_to_what_explains_them() -> None:
    rows = [
        ScoreRow(2, "a<b", "good", 0.5, [("satisfied", "1")], "#d0"),
        ScoreRow(None, "open", None, None, [("undecided", "[0, 1]")]),
    ]
    markup = score_table("best first", [("reach", "soft", 0.25, 1)], rows).replace("<br>", "<br/>")
    first, second = ElementTree.fromstring(markup).find("tbody")
    assert (first[1][0].get("href"), first[1][0].text, first[0].text) == ("#d0", "a<b", "2")
    assert (second[0].text, second[2][0].text, second[3].text) == ("–", "undecided", "–")
