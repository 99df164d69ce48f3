"""An editor drives the server over its standard streams, through every feature."""

import pytest

from tests.tools.lsp.client import Client, shape

TEXT = """signal d_obs unit "m" in [0, 50] "Distance"
signal d_goal unit "m" in [0, 50]
hard avoid "Never": always (d_obs >= 1 m)
soft reach depends on avoid: eventually[0, 8] (d_goal < 1 m)
"""
MAIN = 'use "signals.stl"\nhard avoid: always (d > 1)\n'


@pytest.fixture(scope="module")
def client():
    client = Client()
    yield client
    assert client.stop() == 0
    assert client.log == []


@pytest.fixture
def uri(client, tmp_path):
    uri = (tmp_path / "a.stl").as_uri()
    client.open(uri, TEXT)
    yield uri
    client.close(uri)


def test_an_edit_to_an_error_and_back_shows_and_takes_back_the_diagnostic(client, uri):
    assert client.diagnostics(uri) == []
    client.change(uri, ((3, 40), (3, 41), "s"))
    (found,) = client.diagnostics(uri)
    assert (found["code"], found["severity"], found["source"]) == ("N101", 1, "stlspec")
    assert found["message"].splitlines()[-1].startswith("help: ")
    client.change(uri, ((3, 40), (3, 41), "8"))
    assert client.diagnostics(uri) == []


def test_second_places_are_related_information(client, uri):
    client.change(uri, ((1, 7), (1, 13), "d_obs"))
    found = next(d for d in client.diagnostics(uri) if d["code"] == "N102")
    (related,) = found["relatedInformation"]
    assert related["location"] == {"uri": uri, "range": span(0, 7, 0, 12)}
    assert related["message"] == "first declared here"


def test_warnings_are_shown_and_unused_declarations_faded(client, uri):
    client.change(uri, ((2, 28), (2, 33), "d_goal"))
    found = next(d for d in client.diagnostics(uri) if d["code"] == "L615")
    assert (found["severity"], found["tags"]) == (2, [1])


def test_hover(client, uri):
    found = client.at("hover", uri, 2, 30)
    assert "Every sample lies in [0, 50]" in found["contents"]["value"]
    assert found["range"] == span(2, 28, 2, 33)
    assert client.at("hover", uri, 9, 9) is None


def test_definition(client, uri):
    assert client.at("definition", uri, 3, 25) == {"uri": uri, "range": span(2, 5, 2, 10)}
    assert client.at("definition", uri, 3, 30) is None


def test_formatting(client, uri):
    edits = client.request("textDocument/formatting", {"textDocument": {"uri": uri}, "options": OPTIONS})
    assert [e["range"] for e in edits] == [span(2, 0, 4, 0)]
    assert edits[0]["newText"] == (
        'hard avoid "Never":\n    always (d_obs >= 1 m)\n'
        "soft reach depends on avoid:\n    eventually[0, 8] (d_goal < 1 m)\n"
    )


def test_used_files_are_reached_open_or_closed(client, tmp_path):
    main, signals = ((tmp_path / name).as_uri() for name in ("main.stl", "signals.stl"))
    (tmp_path / "signals.stl").write_text("signal d\n")
    client.open(main, MAIN)
    assert client.diagnostics(main) == []
    assert client.at("definition", main, 1, 20) == {"uri": signals, "range": span(0, 7, 0, 8)}
    client.open(signals, "signal e\n")
    client.shown.pop(main)
    assert shape(client.diagnostics(main)) == [("N101", 1)]
    client.close(signals)
    client.shown.pop(main)
    assert client.diagnostics(main) == []
    client.close(main)


def test_a_file_that_changes_on_disk_is_read_again(client, tmp_path):
    main = (tmp_path / "main.stl").as_uri()
    client.open(main, MAIN)
    assert shape(client.diagnostics(main)) == [("N111", 0)]
    (tmp_path / "signals.stl").write_text("signal d\n")
    client.notify("workspace/didChangeWatchedFiles", {"changes": []})
    client.shown.pop(main)
    assert client.diagnostics(main) == []
    client.close(main)


def test_a_request_about_what_is_not_open_has_no_result(client):
    assert client.at("hover", "file:///not/open.stl", 0, 0) is None
    assert client.at("definition", "file:///not/open.stl", 0, 0) is None
    params = {"textDocument": {"uri": "file:///not/open.stl"}, "options": OPTIONS}
    assert client.request("textDocument/formatting", params) is None


OPTIONS = {"tabSize": 4, "insertSpaces": True}


def span(line, character, end_line, end_character):
    start, end = {"line": line, "character": character}, {"line": end_line, "character": end_character}
    return {"start": start, "end": end}
