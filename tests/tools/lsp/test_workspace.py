"""An open buffer gets what `check` says of a file with its text, and is what the others use."""

import pytest

from stlspec.lang.incremental import Incremental
from stlspec.source import Span
from stlspec.tools.lsp import workspace
from stlspec.tools.lsp.documents import Change, uri_of
from stlspec.tools.lsp.positions import Place
from stlspec.tools.lsp.workspace import Workspace

SIGNALS = "signal d_obs\nsignal d_goal\n"
MAIN = 'use "signals.stl"\nhard avoid: always (d_obs >= 1)\nsoft reach depends on avoid: eventually (d_goal < 1)\n'


@pytest.fixture
def here(tmp_path):
    (tmp_path / "signals.stl").write_text(SIGNALS)
    (tmp_path / "main.stl").write_text(MAIN)
    return tmp_path


def codes(space, uri):
    return [d.code for d in space.findings()[uri]]


def test_a_clean_spec_has_nothing_to_show(here):
    space = Workspace()
    uri = uri_of(str(here / "main.stl"))
    space.open(uri, 1, MAIN)
    assert space.findings() == {uri: ()}
    assert not space.reviewed(uri).errors


def test_a_used_file_counts_as_it_stands_in_its_buffer(here):
    space = Workspace()
    main, signals = (uri_of(str(here / name)) for name in ("main.stl", "signals.stl"))
    space.open(main, 1, MAIN)
    space.open(signals, 1, SIGNALS)
    assert codes(space, main) == []
    space.change(signals, 2, [Change("far", Place(1, 7), Place(1, 13))])
    assert codes(space, main) == ["N101"]
    space.close(signals)
    assert codes(space, main) == []


def test_only_what_rests_on_a_changed_buffer_is_reviewed_again(here):
    space = Workspace()
    main, signals, other = (uri_of(str(here / name)) for name in ("main.stl", "signals.stl", "other.stl"))
    for uri, text in ((main, MAIN), (signals, SIGNALS), (other, "signal x\nhard a: always (x > 0)\n")):
        space.open(uri, 1, text)
    before = {uri: space.reviewed(uri) for uri in (main, signals, other)}
    space.change(signals, 2, [Change("# more\n", Place(0, 0), Place(0, 0))])
    assert space.reviewed(main) is not before[main]
    assert space.reviewed(other) is before[other]
    space.change(other, 2, [Change("\n", Place(0, 0), Place(0, 0))])
    assert space.reviewed(main).document.version == 1


def test_a_problem_in_a_used_file_that_is_closed_is_shown_there(here):
    (here / "signals.stl").write_text(SIGNALS + "signal\n")
    space = Workspace()
    main, signals = (uri_of(str(here / name)) for name in ("main.stl", "signals.stl"))
    space.open(main, 1, MAIN)
    assert codes(space, main) == []
    assert codes(space, signals) == ["S002"]
    (found,) = space.findings()[signals]
    assert space.location(found.source, found.span).uri == signals
    space.close(main)
    assert space.findings() == {}


def test_a_problem_that_a_file_and_its_user_both_report_is_shown_once(here):
    space = Workspace()
    main, signals = (uri_of(str(here / name)) for name in ("main.stl", "signals.stl"))
    space.open(main, 1, MAIN)
    space.open(signals, 1, SIGNALS + "signal\n")
    assert codes(space, signals).count("S002") == 1


def test_settings_are_those_of_the_folder_and_broken_ones_are_said(here):
    text = "signal x\nsignal y\nhard a: always (x > 0)\n"
    space = Workspace()
    uri = uri_of(str(here / "main.stl"))
    space.open(uri, 1, text)
    assert codes(space, uri) == ["L615"]
    (here / "pyproject.toml").write_text('[tool.stlspec]\nignore = ["L615"]\n')
    space.refresh()
    assert codes(space, uri) == []
    (here / "pyproject.toml").write_text('[tool.stlspec]\nignore = ["L999"]\n')
    space.refresh()
    assert codes(space, uri) == ["S094", "L615"]


def test_a_comment_ignores_a_warning_as_in_check(here):
    space = Workspace()
    uri = uri_of(str(here / "main.stl"))
    space.open(uri, 1, "signal x\nsignal y  # stlspec: ignore L615\nhard a: always (x > 0)\n")
    assert codes(space, uri) == []


def test_a_buffer_that_is_no_file_has_no_folder_to_look_in():
    space = Workspace()
    space.open("untitled:1", 1, MAIN)
    assert codes(space, "untitled:1") == ["N111"]
    assert space.location(space.reviewed("untitled:1").syntax.source, space.findings()["untitled:1"][0].span).uri == (
        "untitled:1"
    )


def test_a_refused_text_is_one_diagnostic_and_for_its_users_a_file_that_cannot_be_read(here):
    space = Workspace()
    main, signals = (uri_of(str(here / name)) for name in ("main.stl", "signals.stl"))
    space.open(main, 1, MAIN)
    space.open(signals, 1, "signal d\0")
    assert codes(space, signals) == ["S091"]
    assert codes(space, main) == ["N111"]
    space.change(signals, 2, [Change(SIGNALS)])
    assert codes(space, main) == []


def test_what_is_not_open_is_not_known():
    space = Workspace()
    space.change("file:///a.stl", 2, [Change("x")])
    space.close("file:///a.stl")
    assert space.reviewed("file:///a.stl") is None
    assert space.documents == ()


@pytest.fixture
def work(monkeypatch):
    """What parsers lexed and parsed since this list was last emptied: a pair for each text read."""
    found = []
    read = Incremental.parse

    def parse(self, source, names=frozenset()):
        syntax = read(self, source, names)
        found.append((self.work.lexed, self.work.parsed))
        return syntax

    monkeypatch.setattr(Incremental, "parse", parse)
    return found


def test_a_file_that_did_not_change_is_not_read_again_where_it_is_used(here, work):
    space = Workspace()
    main, signals = (uri_of(str(here / name)) for name in ("main.stl", "signals.stl"))
    space.open(main, 1, MAIN)
    space.open(signals, 1, SIGNALS)
    assert codes(space, main) == []
    work.clear()
    space.change(main, 2, [Change(" ", Place(1, 12), Place(1, 12))])
    assert codes(space, main) == []
    assert sum(lexed for lexed, _ in work) == 1


def test_what_is_no_longer_open_or_used_is_forgotten(here):
    space = Workspace()
    main, other = (uri_of(str(here / name)) for name in ("main.stl", "other.stl"))
    space.open(main, 1, MAIN)
    space.open(other, 1, SIGNALS)
    space.findings()
    assert len(space._parse._known) == 3
    space.close(other)
    assert {name.rsplit("/", 1)[1] for name in space._parse._known} == {"main.stl", "signals.stl"}
    space.close(main)
    assert space._parse._known == {}


def test_the_checks_are_run_when_they_are_asked_for_and_once(here, monkeypatch):
    ran = []
    review = workspace.review_syntax
    monkeypatch.setattr(workspace, "review_syntax", lambda *given: ran.append(1) or review(*given))
    space = Workspace()
    uri = uri_of(str(here / "main.stl"))
    space.open(uri, 1, MAIN)
    assert space.reviewed(uri).syntax.statements
    assert ran == []
    assert space.reviewed(uri).model is space.reviewed(uri).model
    assert space.reviewed(uri).diagnostics == ()
    assert ran == [1]


def test_a_place_in_a_buffer_counts_its_byte_order_mark():
    space = Workspace()
    space.open("untitled:1", 1, "\ufeffsignal x\n")
    source = space.reviewed("untitled:1").syntax.source
    found = space.location(source, Span(7, 8))
    assert (found.start, found.end) == (Place(0, 8), Place(0, 9))
