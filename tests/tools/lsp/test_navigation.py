"""A name leads to its declaration, wherever that stands."""

import pytest

from stlspec.tools.lsp.documents import uri_of
from stlspec.tools.lsp.navigation import definition, references
from stlspec.tools.lsp.workspace import Workspace

SIGNALS = '# of the arena\nsignal d unit "m"\nlet near(x) = x < 1\nhard a: always (d > 0 m)\n'
MAIN = 'use "signals.stl"\nhard a: always (d > 1 m)\nsoft b depends on a: eventually (near(now) and d < 5 m)\n'


@pytest.fixture
def space(tmp_path):
    space = Workspace()
    (tmp_path / "signals.stl").write_text(SIGNALS)
    space.open(uri_of(str(tmp_path / "main.stl")), 1, MAIN)
    return space


def lead(space, mark, text=None):
    """Return the file name and the text from where the definition of what stands at `mark` begins."""
    (document,) = space.documents
    if text is not None:
        space.open(document.uri, 2, text)
    found = definition(space.reviewed(document.uri), (text or MAIN).index(mark))
    if found is None:
        return None
    return found.source.name.rsplit("/", 1)[1], found.source.text[found.span.start :].split("\n")[0]


def test_a_name_leads_into_the_used_file(space):
    assert lead(space, "d > 1") == ("signals.stl", 'd unit "m"')
    assert lead(space, "near(") == ("signals.stl", "near(x) = x < 1")


def test_a_requirement_is_that_of_its_own_file(space):
    assert lead(space, "a: eventually") == ("main.stl", "a: always (d > 1 m)")


def test_a_path_leads_to_the_file(space):
    assert lead(space, "signals.stl") == ("signals.stl", "# of the arena")


def test_a_word_leads_nowhere(space):
    assert lead(space, "always") is None
    assert lead(space, "now") is None


def test_a_name_in_a_broken_statement_leads_to_its_declaration(space):
    broken = MAIN.replace("eventually (near", "eventually ((near")
    assert lead(space, "d < 5", broken) == ("signals.stl", 'd unit "m"')
    assert lead(space, "a: eventually", broken) == ("main.stl", "a: always (d > 1 m)")


def standing(space, mark, text):
    """Return `file:line` of each place where the name at `mark` stands."""
    uri = space.documents[0].uri
    space.open(uri, 2, text)
    found = references(space, space.reviewed(uri), text.index(mark))
    return [
        f"{f.source.name.rsplit('/', 1)[1]}:{f.source.position(f.span.start).line}{' declared' if d else ''}"
        for f, d in found
    ]


def test_a_name_is_found_in_every_spec_that_uses_its_file_open_or_not(space, tmp_path):
    (tmp_path / "other.stl").write_text('use "main.stl"\nhard c: always (d > 2 m)\n')
    (tmp_path / "stranger.stl").write_text("signal d\nhard c: always (d > 2)\n")
    (tmp_path / "mesh.stl").write_text("solid x\nfacet normal 0 0 1\n")
    (tmp_path / "main.stl").write_text("signal stale\n")
    assert standing(space, "d > 1", MAIN) == [
        *("main.stl:2", "main.stl:3"),
        *("signals.stl:2 declared", "signals.stl:4"),
        "other.stl:2",
    ]


def test_a_requirement_and_an_argument_are_found_in_their_own_file_only(space):
    assert standing(space, "a: always", MAIN) == ["main.stl:2 declared", "main.stl:3"]
    assert standing(space, "q)", "let near(q) = q < 1\n") == ["main.stl:1 declared", "main.stl:1"]


def test_what_is_no_name_is_found_nowhere(space):
    assert standing(space, "always", MAIN) == []
    assert standing(space, "d", "signal d\0") == []
