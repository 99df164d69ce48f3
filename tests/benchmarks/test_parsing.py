"""Both readers read the same text whole, and the verdict on the goal is told twice alike."""

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.source import SourceText
from tests.benchmarks import parsing
from tests.benchmarks.contest import OwnFailureError


def test_the_text_is_as_long_as_asked_and_is_a_spec():
    text = parsing.spec_of(22)
    assert text.count("\n") == 22
    assert compile_source(SourceText.of("made.stl", text)).requirements


def test_a_text_that_only_one_of_them_reads_is_refused():
    with pytest.raises(OwnFailureError, match="S011"):
        parsing.readers("signal x signal y\n")


def test_the_command_prints_medians_and_their_ratio(capsys):
    """How fast this machine is now is no matter for a test; that the exit code says what the text says, is."""
    code = parsing.main(["--lines", "330", "--rounds", "5"])
    printed = capsys.readouterr().out
    assert "goal: times a bare Lark parse <= 1.5:" in printed
    assert {0: "  met", 1: "  MISSED"}[code] in printed
