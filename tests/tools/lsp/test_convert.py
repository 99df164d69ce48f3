"""Diagnostics carry everything that `check` says, in the form that editors show."""

from lsprotocol import types

from stlspec.errors import Edit
from stlspec.source import Span
from stlspec.tools.lsp import convert
from stlspec.tools.lsp.documents import Change
from stlspec.tools.lsp.positions import Place
from stlspec.tools.lsp.workspace import Workspace

URI = "untitled:1"


def shown(text, related=True):
    space = Workspace()
    space.open(URI, 1, text)
    return [convert.shown(space, found, related=related) for found in space.findings()[URI]]


def test_a_message_has_what_stands_beside_the_carets_and_the_way_out():
    (found,) = shown("signal d\nhard a: always[3, 1] (d > 0)\n")
    assert (found.code, found.severity) == ("I401", types.DiagnosticSeverity.Error)
    assert found.message.splitlines()[0] == "the interval ends before it begins"
    assert found.message.splitlines()[-1] == "help: write [1, 3]"
    assert found.range == types.Range(types.Position(1, 14), types.Position(1, 20))


def test_second_places_are_left_out_for_an_editor_that_does_not_show_them():
    text = "signal d\nsignal d\nhard a: always (d > 0)\n"
    assert shown(text)[0].related_information[0].location.uri == URI
    assert shown(text, related=False)[0].related_information is None


def test_what_has_no_place_is_shown_at_the_beginning():
    (found,) = shown("signal d\0")
    assert found.range == types.Range(types.Position(0, 0), types.Position(0, 0))


def test_changes_and_edits_keep_their_places():
    part = types.TextDocumentContentChangePartial(types.Range(types.Position(1, 2), types.Position(3, 4)), "x")
    assert convert.change(part) == Change("x", Place(1, 2), Place(3, 4))
    assert convert.change(types.TextDocumentContentChangeWholeDocument("y")) == Change("y")
    space = Workspace()
    space.open(URI, 1, 'signal x "😀"\n')
    source = space.reviewed(URI).syntax.source
    (edit,) = convert.text_edits(space, source, [Edit(Span(10, 11), "!")])
    assert edit == types.TextEdit(types.Range(types.Position(0, 10), types.Position(0, 12)), "!")
