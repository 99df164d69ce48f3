"""The tool is told by the text; what comes out is a spec without errors that means what went in."""

import random

import pytest

from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.compiler.compiling import check_source, compile_source, compile_syntax
from stlspec.errors import SpecError, StlspecError, UsageError
from stlspec.lang.formatting.text import format_text
from stlspec.source import SourceText
from stlspec.tools.importing.conversion import convert

RTAMT = "input float req\noutput float gnt\nconst float T = 5\nout = always((req>=3) implies (eventually[0:T](gnt>=3)))"
BREACH = "signal x, y\nparam p=3, tau = 2\nmu := x[t]>p\nphi := alw_[0, tau] (mu until_[0, 1] (y[t] < 2))"


@pytest.mark.parametrize(
    ("text", "tool"),
    [
        (RTAMT, "rtamt"),
        ("always[0:5](x > 3)", "rtamt"),
        ("out = G (x > 3)", "rtamt"),
        ("// phi := alw_[0, 1] (x[t] > 3)\nout = G (x > 3)", "rtamt"),
        (BREACH, "breach"),
        ("phi := ev (x[t] > 3)", "breach"),
    ],
)
def test_the_tool_is_told_by_the_text_and_the_meaning_is_kept(text, tool):
    found = convert(SourceText.of("f", text))
    assert found.tool == tool
    assert check_source(SourceText.of("out.stl", found.text)).errors == ()
    assert format_text(found.text) == found.text
    written = compile_source(SourceText.of("out.stl", found.text))
    assert meaning_sha256(written) == meaning_sha256(compile_syntax(found.syntax))


@pytest.mark.parametrize("text", ["", "# nothing", "signal x\nhard a: x > 1", "signal x, y", "float x"])
def test_where_there_is_nothing_to_translate_it_is_said(text):
    with pytest.raises(SpecError) as caught:
        convert(SourceText.of("f", text))
    assert [p.code for p in caught.value.diagnostics] == ["S043"]


def test_a_spec_of_neither_is_refused_with_places():
    with pytest.raises(SpecError) as caught:
        convert(SourceText.of("f", "{ ltl : <> p }"))
    assert caught.value.diagnostics[0].code == "S041"


def test_an_unknown_tool_is_refused():
    with pytest.raises(UsageError, match="rtamt, breach"):
        convert(SourceText.of("f", RTAMT), "matlab")


def test_random_tokens_give_text_or_diagnostics_and_nothing_else():
    rng = random.Random(4)
    words = (RTAMT + " " + BREACH).replace("(", " ( ").replace(")", " ) ").replace("[", " [ ").split()
    words += "; := = [ ] ( ) , : - test input signal x[t+1] 1e400 0x § ' \" /* # // rise always G U $ @ ~".split()
    for _ in range(1500):
        text = "".join(rng.choice(words) + rng.choice([" ", " ", "", "\n"]) for _ in range(rng.randint(0, 40)))
        try:
            found = convert(SourceText.of("f", text), rng.choice([None, "rtamt", "breach"]))
        except StlspecError as error:
            assert error.diagnostics and all(d.message for d in error.diagnostics)
        else:
            assert check_source(SourceText.of("out.stl", found.text)).errors == (), text
