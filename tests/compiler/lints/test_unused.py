"""Declarations that nothing uses are reported at their names."""

from stlspec.compiler.review import review_source
from stlspec.source import SourceText


def said(text):
    found = review_source(SourceText.of("s", text)).diagnostics
    return [(d.code, text[d.span.start : d.span.end]) for d in found if d.code in ("L615", "L616", "L617")]


def test_each_kind_has_its_code():
    text = "signal x\nsignal y\nparam T = 2\nlet near = x < 3\nhard a: always (x > 1)\n"
    assert said(text) == [("L615", "y"), ("L616", "T"), ("L617", "near")]


def test_ranges_intervals_and_templates_count_as_uses():
    text = (
        "param top = 5\nparam T = 2\nsignal x in [0, top]\nsignal y\nlet near(d) = d < 3\n"
        "let both = near(x) and near(y)\nhard a: always[0, T] both\n"
    )
    assert said(text) == []


def test_an_argument_hides_a_signal_of_its_name():
    assert said("signal x\nsignal d\nlet near(d) = d < 3\nhard a: always near(x)\n") == [("L615", "d")]


def test_a_file_for_others_to_use_is_left_alone():
    assert said("signal x\nparam T = 2\nlet near = x < 3\n") == []
