"""Annotations of GitHub Actions: one line each, whatever a spec contains."""

from stlspec.errors import diagnostic
from stlspec.source import SourceText, Span
from stlspec.tools.annotations import annotation


def test_a_place_is_a_line_and_columns():
    source = SourceText.of("a.stl", "signal x\nhard a: y\n")
    found = diagnostic("L617", source=source, span=Span(17, 18), name="y")
    assert annotation(found) == (
        "::warning title=stlspec L617,file=a.stl,line=2,endLine=2,col=9,endColumn=10::"
        "`y` is used nowhere%0Ahelp: remove it, or use it"
    )


def test_what_users_write_ends_no_command():
    found = diagnostic("S092", file="a,b:c\n::error::x%.stl", verb="read", problem="50%\r\n::stop", help="")
    text = annotation(found)
    assert "\n" not in text and "\r" not in text
    assert "file=a%2Cb%3Ac%0A%3A%3Aerror%3A%3Ax%25.stl::cannot" in text and text.endswith("50%25%0D%0A::stop")
