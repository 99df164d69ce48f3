"""A figure says what it shows, is the same text each time, and brings its style along where it must."""

from xml.etree import ElementTree

from stlspec.markup.elements import element
from stlspec.markup.figures import figure, label, notebook, standalone, style


def test_a_figure_is_named_and_described_for_a_screen_reader() -> None:
    svg = figure(10, 20, "A & B", "what is seen", label(1, 2, "<x>", "stl-small", "end"))
    root = ElementTree.fromstring(svg)
    assert root.get("role") == "img"
    assert root.get("viewBox") == "0 0 10 20"
    ids = root.get("aria-labelledby", "").split()
    assert [next(e for e in root if e.get("id") == i).text for i in ids] == ["A & B", "what is seen"]
    assert root.find("text").text == "<x>"
    assert svg == figure(10, 20, "A & B", "what is seen", label(1, 2, "<x>", "stl-small", "end"))
    assert figure(10, 20, "other", "what is seen") != svg


def test_a_standalone_figure_is_xml_with_its_style() -> None:
    root = ElementTree.fromstring(standalone(figure(1, 1, "t", "", element("path", d="M0 0"))))
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert "prefers-color-scheme: dark" in root.find("{http://www.w3.org/2000/svg}style").text


def test_a_notebook_gets_the_style_once() -> None:
    assert notebook(element("p", "a"), element("p", "b")).count(style()) == 1
