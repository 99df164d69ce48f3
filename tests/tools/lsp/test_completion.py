"""What is offered is what fits, and what fits is offered."""

import pytest

from stlspec.compiler.compiling import check_source
from stlspec.source import SourceText
from stlspec.tools.lsp.completion import completion
from stlspec.tools.lsp.documents import uri_of
from stlspec.tools.lsp.workspace import Workspace

TEXT = """time 100 ms
signal d_obs unit "m" in [0, 50] "Distance"
signal on: bool
param T = 2 s
let near = d_obs < 1 m
let half = d_obs / 2
let slow(v, most) = rate(v) < most
hard avoid: always (d_obs >= 1 m)
soft reach depends on avoid: eventually[0, T] near
"""
FORMULA = {"always", "eventually", "not", "true", "d_obs", "on", "near", "half", "T", "slow", "abs", "now"}


def offered(line, uri="untitled:1", text=TEXT):
    """Return what is offered at the bar in a line behind the text, by text."""
    space = Workspace()
    at = line.index("|")
    space.open(uri, 1, text + line.replace("|", ""))
    return {item.text: item for item in completion(space.reviewed(uri), len(text) + at)}


@pytest.mark.parametrize(
    ("line", "fits", "not_"),
    [
        (
            "|",
            {"signal", "hard", "soft", "param", "let", "expect", "use", "depends on"} - {"depends on"},
            {"time", "abs"},
        ),
        ("ha|", {"hard"}, {"time"}),
        ("signal x|", set(), {"d_obs", "hard"}),
        ("signal x |", {"unit", "in", "from"}, {"d_obs", "always", "hard"}),
        ("signal x: |", {"real", "bool"}, {"d_obs"}),
        ("signal x in [|", {"T", "inf"}, {"d_obs", "always", "now"}),
        ("param |", set(), {"d_obs", "T"}),
        ("let |", set(), {"d_obs", "T"}),
        ("let f(a, b) = |", {"a", "b", "d_obs"}, {"hard"}),
        ("hard x |", {"depends on", "scale", "bound"}, {"d_obs", "always"}),
        ("hard x depends on |", {"avoid", "reach"}, {"d_obs", "always"}),
        ("hard x depends on avoid, |", {"reach"}, {"avoid", "T"}),
        ("hard x bound |", {"tanh", "linear", "none"}, {"d_obs"}),
        ("hard x: |", FORMULA, {"and", "avoid", "hard", "assign"}),
        ("hard x: alw|", FORMULA, {"and"}),
        ("hard x: G |", FORMULA, {"and"}),
        ("hard x: G[|", {"T", "half"}, {"d_obs", "on", "near", "now", "always"}),
        ("hard x: G[0, |", {"T"}, {"d_obs", "always"}),
        ("hard x: G[0, 5 |", {"s", "ms"}, {"m", "and"}),
        ("hard x: d_obs < 5 |", {"m", "s", "and", "until", "implies"}, {"not", "d_obs"}),
        ("hard x: d_obs |", {"and", "or"}, {"s", "not", "d_obs"}),
        ("hard x: d_obs < |", {"d_obs", "half", "T", "abs", "now", "slow"}, {"on", "near", "not", "always"}),
        ("hard x: (on and |", FORMULA, {"or"}),
        ("hard x: (on and on on |", {"d_obs", "always", "and"}, set()),
        ("expect |", {"avoid", "reach"}, {"d_obs"}),
        ("expect avoid |", {"holds", "fails"}, {"avoid"}),
        ("expect avoid holds on {|", {"d_obs", "on", "time"}, {"avoid", "T"}),
        ('expect "a.csv" |', {"is", "outranks", "episode"}, {"avoid"}),
        ('expect "a.csv" is |', {"good", "incomplete", "bad"}, {"avoid"}),
        ('signal x unit "|', {"m", "s", "kg"}, {"d_obs"}),
        ('signal x "|', set(), {"m", "d_obs"}),
        ("# d|", set(), {"d_obs", "L603"}),
        ("hard x: on # stlspec: ignore L|", {"L603", "L615"}, {"S001", "d_obs"}),
    ],
)
def test_what_is_offered(line, fits, not_):
    found = offered(line)
    assert fits <= found.keys()
    assert not found.keys() & not_


def test_time_is_offered_where_there_is_none_and_its_units_behind_it():
    assert "time" in offered("|", text="signal x\n")
    assert {"step", "ms", "s"} <= offered("time |", text="signal x\n").keys()


def test_an_item_replaces_the_word_that_is_being_typed_and_says_what_it_is():
    item = offered("hard x: always d_o|")["d_obs"]
    assert (item.span.end - item.span.start, item.kind) == (3, "signal")
    assert item.detail == 'signal d_obs unit "m" in [0, 50] "Distance"'
    assert item.doc == "Distance"
    assert offered("hard x: |")["always"].doc.startswith("p holds at every sample")


@pytest.mark.parametrize("line", ["hard x: |", "hard x: on and |", "hard x: d_obs < |", "let y = |"])
def test_a_name_that_is_offered_parses_where_it_is(line):
    for item in offered(line).values():
        written = line.replace("|", item.text)
        if item.kind in ("function", "word") or item.text == "slow":
            continue
        codes = {d.code for d in check_source(SourceText.of("a.stl", TEXT + written + "\n")).diagnostics}
        assert not {code for code in codes if code[0] in "SN"}, written


def test_paths_are_those_beside_the_spec(tmp_path):
    (tmp_path / "demos").mkdir()
    for name in ("main.stl", "signals.stl", "d.csv", "notes.txt", ".hidden.stl", "demos/e.jsonl", "demos/x.stlspec"):
        (tmp_path / name).write_text("")
    uri = uri_of(str(tmp_path / "main.stl"))
    assert offered('use "|', uri).keys() == {"signals.stl", "demos/"}
    assert offered('use "demos/|', uri).keys() == {"x.stlspec"}
    assert offered('expect avoid holds on "de|', uri).keys() == {"d.csv", "demos/"}
    assert offered('expect "demos/|', uri)["e.jsonl"].span.end == len(TEXT) + len('expect "demos/')
    assert offered('use "nowhere/|', uri) == {}
    assert offered('use "|') == {}


def test_names_of_used_files_are_offered_but_not_their_requirements(tmp_path):
    (tmp_path / "signals.stl").write_text("signal from_there\nhard theirs: always (from_there > 0)\n")
    uri = uri_of(str(tmp_path / "main.stl"))
    text = 'use "signals.stl"\nhard a: always (from_there > 0)\n'
    assert "from_there" in offered("hard b: |", uri, text)
    assert "theirs" not in offered("hard b depends on |", uri, text)


def test_nothing_is_offered_in_a_text_that_is_refused():
    assert offered("hard x: |", text="\0") == {}
