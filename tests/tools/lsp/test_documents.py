"""A buffer is read as a file with the same characters would be, whatever is typed into it."""

import random

import pytest

from stlspec.compiler import files
from stlspec.source import Span
from stlspec.tools.lsp.documents import Change, Document, path_of, uri_of
from stlspec.tools.lsp.positions import Place

URI = "file:///specs/a%20b.stl"


def opened(text, encoding="utf-16", uri=URI):
    return Document.opened(uri, 1, text, encoding)


def test_a_change_replaces_the_stretch_it_names_in_the_editors_units():
    document = opened('signal x "😀"\r\nsignal y\r\n')
    after = document.changed(2, [Change("é", Place(0, 10), Place(0, 12)), Change("z", Place(1, 7), Place(1, 8))])
    assert after.lines.text == 'signal x "é"\r\nsignal z\r\n'
    assert after.version == 2
    assert document.lines.text.startswith('signal x "😀"')


def test_changes_without_a_stretch_replace_the_text():
    assert opened("a").changed(2, [Change("signal x")]).lines.text == "signal x"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-32"])
def test_random_changes_give_what_slicing_gives(encoding):
    rng = random.Random(7)
    text = "signal x\r\n😀 é\n"
    document = opened(text, encoding)
    for version in range(2, 100):
        stops = [i for i in range(len(text) + 1) if text[max(0, i - 1) : i + 1] != "\r\n"]
        start, end = sorted(rng.choices(stops, k=2))
        new = "".join(rng.choices("ax\n\r\t😀中", k=rng.randrange(4)))
        places = (document.lines.place(start), document.lines.place(end))
        text = text[:start] + new + text[end:]
        document = document.changed(version, [Change(new, *places)])
        assert document.lines.text == text


def test_a_stretch_that_is_reversed_or_outside_the_text_is_moved_inside():
    document = opened("signal x")
    assert document.changed(2, [Change("!", Place(0, 5), Place(0, 2))]).lines.text == "signa!l x"
    assert document.changed(2, [Change("!", Place(7, 5), Place(9, 2))]).lines.text == "signal x!"


def test_halves_of_a_character_that_come_one_by_one_are_joined():
    document = opened("# \ud83d").changed(2, [Change("\ude00", Place(0, 3), Place(0, 3))])
    assert document.source.text == "# 😀"
    assert opened("# \ud83d").source.text == "# \ufffd"


def test_a_byte_order_mark_is_counted_by_the_editor_and_not_by_the_compiler():
    document = opened("\ufeffsignal x")
    assert document.source.text == "signal x"
    assert document.places(Span(7, 8)) == (Place(0, 8), Place(0, 9))
    assert document.offset(Place(0, 8)) == 7
    assert document.offset(Place(0, 0)) == 0


@pytest.mark.parametrize(
    ("text", "code"),
    [("a\0b", "S091"), ("solid part\nfacet normal 0 0 1\n", "S090")],
)
def test_what_a_file_may_not_hold_is_refused_by_the_same_code(text, code):
    document = opened(text)
    assert document.source is None
    assert document.refusal.code == code
    assert document.refusal.file == "/specs/a b.stl"


def test_a_text_too_large_is_refused(monkeypatch):
    monkeypatch.setattr(files, "LARGEST_SPEC", 100)
    assert opened("é" * 50).refusal is None
    assert opened("é" * 51).refusal.code == "S093"


def test_a_uri_and_its_path():
    assert path_of(URI) == "/specs/a b.stl"
    assert path_of(uri_of("/specs/ä #1?.stl")) == "/specs/ä #1?.stl"
    assert path_of("file://localhost/a.stl") == "/a.stl"


@pytest.mark.parametrize(
    "uri", ["untitled:Untitled-1", "http://x/a.stl", "file://", "", "file:///a%00b", "//[", "a.stl"]
)
def test_what_is_no_file_has_no_path_and_still_is_a_buffer(uri):
    assert path_of(uri) is None
    document = opened("signal x", uri=uri)
    assert document.name == uri
    assert not document.is_file
