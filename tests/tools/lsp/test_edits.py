"""The edits offered make the text what the formatter and the fixes say, and touch nothing else."""

import random

import pytest

from stlspec.errors import Fix, SpecError
from stlspec.lang.formatting import text as text_module
from stlspec.lang.formatting.text import format_text
from stlspec.tools.lsp.edits import actions, formatting
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


def test_a_text_that_cannot_be_formatted_safely_is_said_to_be(monkeypatch):
    monkeypatch.setattr(text_module, "_said", lambda syntax: [object()])
    with pytest.raises(SpecError, match="X902"):
        formatting(reviewed(TEXT))


def test_random_specs_are_brought_into_canonical_form():
    rng = random.Random(3)
    for _ in range(20):
        text = Composer(rng).text()
        assert formatted(text) == format_text(text)


@pytest.mark.parametrize(
    ("text", "after"),
    [
        ("signal x\nhard a: always[5, 2] (x > 0)\n", "signal x\nhard a: always[2, 5] (x > 0)\n"),
        ("signal x\nhard a: always (x = 0)\n", "signal x\nhard a: always (x == 0)\n"),
        ("signal x\nhard a: always (x > 0\nhard b: x > 1\n", "signal x\nhard a: always (x > 0)\nhard b: x > 1\n"),
        ("signal goal\nhard a: always (gaol > 0)\n", "signal goal\nhard a: always (goal > 0)\n"),
    ],
)
def test_the_likeliest_way_out_mends_the_text(text, after):
    known = reviewed(text)
    found = next(action for action in actions(known, 0, len(text)) if action.likely)
    assert Fix("", found.edits).applied(text) == after
    assert found.title == found.found.help


def test_between_two_ways_out_an_editor_does_not_choose():
    text = "signal x\nhard a: x > 0\n"
    known = reviewed(text)
    found = [action for action in actions(known, 0, len(text)) if action.found.code == "L620"]
    assert [action.title for action in found[:2]] == ["write `always (...)`", "write `eventually (...)`"]
    assert not any(action.likely for action in found)


def test_only_what_is_reported_on_the_lines_asked_for_is_offered():
    text = "signal x\nsignal y\nhard a: always[5, 2] (x > 0)\n"
    assert actions(reviewed(text), 0, text.index("hard") - 1) == ()
    at = text.index("x > 0")
    assert [action.found.code for action in actions(reviewed(text), at, at)] == ["I401"]


@pytest.mark.parametrize(
    ("line", "after"),
    [
        ("signal y", "signal y  # stlspec: ignore L615"),
        ("signal y in [0, 1] \t", "signal y in [0, 1]  # stlspec: ignore L615 \t"),
        ("signal y  # stlspec: ignore l603", "signal y  # stlspec: ignore L615, l603"),
    ],
)
def test_a_warning_can_be_ignored_on_its_line(line, after):
    text = f"signal x\r\n{line}\r\nhard a: always (x > 0)\r\n"
    known = reviewed(text)
    found = next(a for a in actions(known, text.index(line), text.index(line)) if a.title.startswith("Ignore L615"))
    mended = Fix("", found.edits).applied(text)
    assert mended == text.replace(line, after)
    assert "L615" not in [d.code for d in reviewed(mended).diagnostics]


def test_a_line_with_a_remark_of_its_own_and_an_error_are_not_ignored():
    text = "signal x\nsignal y  # for later\nhard a: always (z > 0)\n"
    assert [a.title for a in actions(reviewed(text), 0, len(text)) if a.title.startswith("Ignore")] == []


def test_what_is_wrong_in_a_used_file_is_no_action_in_the_file_that_uses_it(tmp_path):
    (tmp_path / "lib.stl").write_text("signal x\nlet f = x = 1\n")
    space = Workspace()
    uri = (tmp_path / "a.stl").as_uri()
    space.open(uri, 1, 'use "lib.stl"\nhard a: always (x > 1)\n')
    known = space.reviewed(uri)
    assert "S008" in [found.code for found in known.diagnostics]
    assert [action.title for action in actions(known, 0, 99) if action.found.code == "S008"] == []
