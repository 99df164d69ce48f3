"""Every statement that has something to say under a name is listed once, in order."""

from stlspec.lang.parse import parse
from stlspec.source import SourceText
from stlspec.tools.lsp.outline import outline

TEXT = """spec s "A title"
use "signals.stl"
time step
signal x "Where it is"
param T = 5
let p = x > 0
let near(a) = a < 1
hard a: always p
soft b "Soon": eventually[0, T] near(x)
expect a fails on {x: [0]}
expect "good.csv" is good
expect "good.csv" outranks "bad.csv"
"""


def read(text):
    return outline(parse(SourceText.of("a.stl", text)))


def test_statements_are_listed_with_what_they_are():
    assert [(s.name, s.kind, s.detail) for s in read(TEXT)] == [
        ("s", "spec", "spec: A title"),
        ("signals.stl", "use", "use"),
        ("x", "signal", "signal: Where it is"),
        ("T", "param", "param"),
        ("p", "let", "let"),
        ("near", "template", "template"),
        ("a", "hard", "hard"),
        ("b", "soft", "soft: Soon"),
        ("expect a fails", "expect", ""),
        ('expect "good.csv" is good', "expect", ""),
        ('expect "good.csv" outranks "bad.csv"', "expect", ""),
    ]


def test_the_stretch_of_a_name_lies_in_that_of_its_statement():
    for symbol in read(TEXT):
        assert symbol.span.start <= symbol.name_span.start <= symbol.name_span.end <= symbol.span.end


def test_a_broken_statement_is_left_out_and_its_neighbours_stay():
    assert [s.name for s in read(TEXT.replace("param T = 5", "param T ="))] == [
        s.name for s in read(TEXT) if s.name != "T"
    ]
