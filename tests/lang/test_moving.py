"""A thing at another place is equal but for its places, and shares no node with the old one."""

from stlspec.lang.moving import moved
from stlspec.lang.nodes import post_order
from stlspec.lang.parse import parse
from stlspec.source import SourceText

TEXT = """\
spec a "title"
use "f.stl"
time 100 ms
signal x : real unit "m" in [-1, 2 * T] from "col" "doc" "again"
param T = -4 s
let f(a) = abs(a) > x[t] and not true U[0, inf] (a + 1 m/s < -2)
hard r "doc" depends on q, p scale 2 bound tanh: always[0, T] (x > 1)
expect r fails on {x: [1, true, -inf]} at -1 margin >= 0.5
expect "a.csv" episode 3 is good
expect "a.csv" episode "b" outranks "b.csv"
let deep = """
DEEP = TEXT + "not " * 3000 + "p\nhard z: (x > 1\n"


def test_moving_is_what_parsing_behind_other_text_gives():
    shift = "# é\n\n"
    here, there = SourceText.of("s", DEEP), SourceText.of("s", shift + DEEP)
    before, after = parse(here), parse(there)
    assert [moved(x, len(shift), there) for x in before.diagnostics] == list(after.diagnostics)
    assert len(before.diagnostics) == 3
    shallow = slice(0, 10)
    assert [moved(x, len(shift), there) for x in before.statements[shallow]] == list(after.statements[shallow])


def test_every_node_is_new():
    statement = parse(SourceText.of("s", TEXT)).statements[5]
    again = moved(statement, 0, SourceText.of("s", TEXT))
    assert again == statement
    assert not {id(node) for node in post_order(again.body)} & {id(node) for node in post_order(statement.body)}


def test_deep_nests_are_moved_too():
    (statement,) = parse(SourceText.of("s", "let deep = " + "not " * 3000 + "p")).statements
    deep = [node.span for node in post_order(moved(statement, 7, SourceText.of("s", "")).body)]
    assert [span.start - 7 for span in deep] == [node.span.start for node in post_order(statement.body)]
