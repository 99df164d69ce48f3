"""The edits offered make the text what the formatter and the fixes say, and touch nothing else."""

import random

import pytest

from stlspec.errors import Fix
from stlspec.lang.formatting.text import format_text
from stlspec.tools.lsp.edits import formatting
from stlspec.tools.lsp.workspace import Workspace
from tests.lang.compose import Composer

TEXT = "signal x\nsignal y  # kept\nhard a:  G (x>0)\nsoft b depends on a:\n    eventually (y > 0)\n"


def reviewed(text):
    space = Workspace()
    space.open("untitled:1", 1, text)
    return space.reviewed("untitled:1")


def formatted(text):
    known = reviewed(text)
    return Fix("", formatting(known)).applied(known.syntax.source.text)


def test_only_the_lines_that_change_are_replaced():
    (edit,) = formatting(reviewed(TEXT))
    assert TEXT[edit.span.start : edit.span.end] == "hard a:  G (x>0)\n"
    assert edit.text == "hard a:\n    always (x > 0)\n"
    assert formatted(TEXT) == format_text(TEXT)


@pytest.mark.parametrize("text", ["signal x", "signal x\n\n\n", "signal x\r\nsignal  y\r\n", "\n\nsignal x\n", "#\n"])
def test_ends_of_lines_and_of_the_text_are_those_of_the_formatter(text):
    try:
        expected = format_text(text)
    except Exception:
        expected = text
    assert formatted(text) == expected


def test_a_canonical_text_and_a_broken_one_stay():
    assert formatting(reviewed(format_text(TEXT))) == ()
    assert formatting(reviewed("signal x\nhard a: (\n")) == ()
    assert formatting(reviewed("signal x\0")) == ()


def test_random_specs_are_brought_into_canonical_form():
    rng = random.Random(3)
    for _ in range(20):
        text = Composer(rng).text()
        assert formatted(text) == format_text(text)
