"""An editor drives the server over its standard streams, through every feature."""

import contextlib
import json
import random

import pytest

from stlspec.errors import InputError
from stlspec.lang.incremental import Incremental
from stlspec.tools.lsp.completion import completion
from stlspec.tools.lsp.edits import actions, formatting
from stlspec.tools.lsp.hover import hover
from stlspec.tools.lsp.navigation import definition, references
from stlspec.tools.lsp.outline import outline
from stlspec.tools.lsp.renaming import rename
from stlspec.tools.lsp.workspace import Workspace
from tests.benchmarks.parsing import spec_of
from tests.lang.mutate import SPECS, mutate, statements
from tests.lang.soup import soup
from tests.tools.lsp.client import Client, RefusedError, applied, shape

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


def test_completion(client, uri):
    client.change(uri, ((4, 0), (4, 0), "hard near: always d_"))
    items = {i["label"]: i for i in client.at("completion", uri, 4, 20)}
    assert {"d_obs", "d_goal", "always", "abs"} <= items.keys()
    assert items["d_obs"]["textEdit"] == {"newText": "d_obs", "range": span(4, 18, 4, 20)}
    assert items["d_obs"]["documentation"] == "Distance"


def test_references(client, uri):
    context = {"context": {"includeDeclaration": True}}
    found = client.at("references", uri, 3, 25, **context)
    assert [f["range"] for f in found] == [span(2, 5, 2, 10), span(3, 22, 3, 27)]
    context = {"context": {"includeDeclaration": False}}
    assert client.at("references", uri, 3, 25, **context) == found[1:]


def test_rename(client, uri):
    assert client.at("prepareRename", uri, 2, 30) == span(2, 28, 2, 33)
    assert client.at("prepareRename", uri, 2, 0) is None
    (change,) = client.at("rename", uri, 2, 30, newName="clearance")["documentChanges"]
    assert change["textDocument"] == {"uri": uri, "version": 1}
    assert applied(TEXT, change["edits"]) == TEXT.replace("d_obs", "clearance")
    with pytest.raises(RefusedError, match="a word of the language") as caught:
        client.at("rename", uri, 2, 30, newName="always")
    assert caught.value.code == -32803


def test_a_fix_is_a_code_action_and_mends_the_text(client, uri):
    client.change(uri, ((3, 39), (3, 45), "[8, 0]"))
    (found,) = client.diagnostics(uri)
    assert found["code"] == "I401"
    everywhere = {"range": span(0, 0, 9, 0), "context": {"diagnostics": [found]}, "textDocument": {"uri": uri}}
    (action,) = client.request("textDocument/codeAction", everywhere)
    assert (action["kind"], action["isPreferred"], action["diagnostics"]) == ("quickfix", True, [found])
    (change,) = action["edit"]["documentChanges"]
    mended = applied(TEXT.replace("[0, 8]", "[8, 0]"), change["edits"])
    assert mended == TEXT
    client.change(uri, mended)
    assert client.diagnostics(uri) == []
    assert (
        client.request("textDocument/codeAction", everywhere | {"context": {"diagnostics": [], "only": ["source"]}})
        == []
    )


def test_symbols(client, uri):
    found = client.request("textDocument/documentSymbol", {"textDocument": {"uri": uri}})
    assert [s["name"] for s in found] == ["d_obs", "d_goal", "avoid", "reach"]
    assert found[0]["detail"] == "signal: Distance"
    assert found[2]["selectionRange"] == span(2, 5, 2, 10)


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
    assert client.at("completion", "file:///not/open.stl", 0, 0) == []
    assert client.at("references", "file:///not/open.stl", 0, 0, context={"includeDeclaration": True}) == []
    assert client.at("prepareRename", "file:///not/open.stl", 0, 0) is None
    assert client.at("rename", "file:///not/open.stl", 0, 0, newName="x") is None
    params = {"textDocument": {"uri": "file:///not/open.stl"}, "options": OPTIONS}
    assert client.request("textDocument/formatting", params) is None
    assert client.request("textDocument/documentSymbol", params) == []
    assert (
        client.request("textDocument/codeAction", params | {"range": span(0, 0, 0, 0), "context": {"diagnostics": []}})
        == []
    )


def test_the_editor_is_told_what_there_is(client):
    told = client.capabilities
    assert told["textDocumentSync"] == {"openClose": True, "change": 2, "save": {}}
    assert told["renameProvider"] == {"prepareProvider": True}
    assert told["codeActionProvider"] == {"codeActionKinds": ["quickfix"]}
    assert {"hoverProvider", "completionProvider", "definitionProvider", "referencesProvider"} <= told.keys()
    assert {"documentFormattingProvider", "documentSymbolProvider"} <= told.keys()


def test_the_editor_is_asked_to_watch_specs_and_settings(client):
    (asked,) = [m for m in client.asked if m["method"] == "client/registerCapability"]
    (registered,) = asked["params"]["registrations"]
    assert [w["globPattern"] for w in registered["registerOptions"]["watchers"]] == [
        *("**/*.stl", "**/*.stlspec", "**/pyproject.toml"),
    ]


def test_an_editor_that_can_do_little_gets_the_older_forms(tmp_path):
    client = Client(modern=False, inside=True)
    uri = (tmp_path / "a.stl").as_uri()
    client.open(uri, TEXT)
    assert "relatedInformation" not in (client.diagnostics(uri) or [{}])[0]
    found = client.request("textDocument/documentSymbol", {"textDocument": {"uri": uri}})
    assert found[0]["location"]["uri"] == uri
    edit = client.at("rename", uri, 2, 30, newName="clearance")
    assert applied(TEXT, edit["changes"][uri]) == TEXT.replace("d_obs", "clearance")
    assert client.asked == []
    assert client.stop() == 0


@pytest.mark.parametrize(
    ("encodings", "column"), [(None, 21), (["utf-8", "utf-16"], 23), (["utf-32"], 20), (["x"], 21)]
)
def test_columns_are_counted_as_agreed(tmp_path, encodings, column):
    client = Client(encodings=encodings, inside=True)
    assert client.capabilities["positionEncoding"] == (encodings or ["utf-16"])[0].replace("x", "utf-16")
    uri = (tmp_path / "a.stl").as_uri()
    client.open(uri, 'signal x\nhard a "😀": always (y > 0)\n')
    (found,) = [d for d in client.diagnostics(uri) if d["code"] == "N101"]
    start = found["range"]["start"]
    assert start == {"line": 1, "character": column}
    client.change(uri, ((1, column), (1, column + 1), "x"))
    assert client.diagnostics(uri) == []
    assert client.stop() == 0


def test_renaming_reaches_files_of_the_folder_that_are_not_open(tmp_path):
    (tmp_path / "specs").mkdir()
    (tmp_path / "signals.stl").write_text("signal d\n")
    (tmp_path / "specs/other.stl").write_text('use "../signals.stl"\nhard a: always (d > 2)\n')
    client = Client(folders=[{"uri": tmp_path.as_uri(), "name": "here"}], inside=True)
    uri = (tmp_path / "main.stl").as_uri()
    client.open(uri, MAIN)
    made = client.at("rename", uri, 1, 20, newName="gap")["documentChanges"]
    assert {(m["textDocument"]["uri"].rsplit("/", 1)[1], m["textDocument"].get("version")) for m in made} == {
        *(("main.stl", 1), ("signals.stl", None), ("other.stl", None)),
    }
    assert client.stop() == 0


def test_fifty_random_edits_end_where_a_fresh_start_does(client, tmp_path):
    rng = random.Random(50)
    uri, fresh = ((tmp_path / name).as_uri() for name in ("a.stl", "b.stl"))
    text = rng.choice(SPECS)
    client.open(uri, text)
    for _ in range(50):
        parts = statements(text)
        k = rng.randrange(len(parts))
        after = (
            "\n".join([*parts[:k], mutate(rng, parts[k]), *parts[k + 1 :]]) if rng.random() < 0.6 else rng.choice(SPECS)
        )
        start = shared(text, after)
        tail = shared(text[start:][::-1], after[start:][::-1])
        end = len(text) - tail
        places = [(text.count("\n", 0, i), i - text.rfind("\n", 0, i) - 1) for i in (start, end)]
        client.change(uri, (*places, after[start : len(after) - tail]))
        text = after
    client.open(fresh, text)
    shown = [json.dumps(client.diagnostics(one)).replace(one, "here") for one in (uri, fresh)]
    assert shown[0] == shown[1]
    found = [client.request("textDocument/documentSymbol", {"textDocument": {"uri": u}}) for u in (uri, fresh)]
    assert found[0] == found[1]
    for one in (uri, fresh):
        client.close(one)


def test_an_edit_of_a_long_spec_reads_only_the_statement_that_it_touches(tmp_path, monkeypatch):
    work = []
    read = Incremental.parse

    def parse(self, source, names=frozenset()):
        syntax = read(self, source, names)
        work.append((self.work.lexed, self.work.parsed, len(syntax.statements)))
        return syntax

    monkeypatch.setattr(Incremental, "parse", parse)
    client = Client(inside=True)
    uri = (tmp_path / "long.stl").as_uri()
    text = spec_of(1000)
    client.open(uri, text)
    before = client.diagnostics(uri)
    (first,) = work
    assert first[0] >= first[2] > 300
    work.clear()
    for word in ("let", "soft"):
        line = next(i for i, written in enumerate(text.split("\n")) if i > 500 and written.startswith(word))
        client.change(uri, ((line, len(word)), (line, len(word)), " "))
        assert shape(client.diagnostics(uri)) == shape(before)
    client.change(uri, ((line, len(word)), (line, len(word)), " ("))
    assert [at for code, at in shape(client.diagnostics(uri)) if code.startswith("S")] == [line]
    assert [made[:2] for made in work] == [(1, 1)] * 3
    assert client.stop() == 0


def test_no_text_and_no_place_makes_a_feature_fail():
    rng = random.Random(4)
    for _ in range(120):
        text = (
            soup(rng) if rng.random() < 0.5 else "\n".join(mutate(rng, part) for part in statements(rng.choice(SPECS)))
        )
        space = Workspace()
        space.open("untitled:1", 1, text)
        known = space.reviewed("untitled:1")
        formatting(known)
        for offset in (rng.randrange(len(text) + 1), rng.randrange(len(text) + 1), len(text)):
            for place in (hover(known, offset), *completion(known, offset)):
                assert place is None or 0 <= place.span.start <= place.span.end <= len(text)
            found = definition(known, offset)
            assert (found is not None) <= bool(references(space, known, offset))
            actions(known, 0, offset)
            with contextlib.suppress(InputError):
                rename(space, known, offset, "fresh")
        for symbol in outline(known.syntax) if known.syntax else ():
            assert 0 <= symbol.span.start <= symbol.span.end <= len(text)


def shared(one, other):
    """How many characters two texts share from their beginning."""
    return next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))


OPTIONS = {"tabSize": 4, "insertSpaces": True}


def span(line, character, end_line, end_character):
    start, end = {"line": line, "character": character}, {"line": end_line, "character": end_character}
    return {"start": start, "end": end}
