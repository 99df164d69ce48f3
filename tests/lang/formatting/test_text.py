"""The promises: same meaning, same comments, same order, and formatting twice changes nothing more."""

import random

import pytest

from stlspec.errors import SpecError
from stlspec.lang.formatting import text as formatting
from stlspec.lang.formatting.text import format_text
from tests.lang.compose import fault, tree_fault


def test_random_specs_keep_meaning_and_comments_and_are_formatted_once():
    rng = random.Random(4)
    assert [found for _ in range(120) for found in (fault(rng), tree_fault(rng)) if found] == []


def test_blank_lines_and_comments_between_statements_stay():
    written = "# head\n\n\n\nsignal x # one\n  # two\n# three\n\n  # four\nhard a: x > 1\n   # five\n\n# six"
    assert format_text(written) == (
        "# head\n\nsignal x  # one\n    # two\n# three\n\n# four\nhard a:\n    x > 1\n    # five\n\n# six\n"
    )


@pytest.mark.parametrize("end", ["\r\n", "\n", "\r"])
def test_line_ends_stay_as_the_first_one_is(end):
    formatted = format_text(f"signal x # c{end}{end}signal y".replace("\n", "\n"))
    kept = "\r\n" if end == "\r\n" else "\n"
    assert formatted == f"signal x  # c{kept}{kept}signal y{kept}"


def test_errors_are_raised_and_nothing_is_formatted():
    with pytest.raises(SpecError) as raised:
        format_text("signal x\nhard a: x > \nhard b: (x > 1\n")
    assert [d.code for d in raised.value.diagnostics] == ["S002", "S004"]


def test_a_text_that_would_say_something_else_is_refused(monkeypatch):
    monkeypatch.setattr(formatting, "_formatted", lambda syntax: syntax.source.text.replace("> 1", "> 2"))
    with pytest.raises(SpecError) as raised:
        format_text("signal x\nhard a: x > 1\n")
    assert [d.code for d in raised.value.diagnostics] == ["X902"]


def test_a_text_that_would_lose_a_comment_is_refused(monkeypatch):
    monkeypatch.setattr(formatting, "_formatted", lambda syntax: "signal x\n")
    with pytest.raises(SpecError) as raised:
        format_text("signal x # c\n")
    assert [d.code for d in raised.value.diagnostics] == ["X902"]
