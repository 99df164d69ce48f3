"""One diagnostic for each slip that can be told from the tokens, with the way out."""

import pytest

from stlspec.lang.parse import parse
from stlspec.source import SourceText


def only(text):
    (problem,) = parse(SourceText.of("s", text)).diagnostics
    return problem


@pytest.mark.parametrize(
    ("formula", "code", "at", "help_"),
    [
        ("always[0, 5 (x > 1)", "S004", "", "write `]` after `5`"),
        ("always[0, x (x > 1)", "S004", "", "write `]` after `x`"),
        ("always[0, 5 x > 1", "S004", "", "write `]` after `5`"),
        ("always[0, 5 s (x > 1)", "S004", "", "write `]` after `s`"),
        ("(x > 1", "S004", "", "write `)` after `1`"),
        ("(x > 1]", "S004", "]", "write `)` in place of `]`"),
        ("x > 1)", "S019", ")", "remove it, or open a bracket before"),
        ("eventualy[0,5] (x > 1)", "S018", "eventualy", "write `eventually`"),
        ("alwas x > 1", "S018", "alwas", "write `always`"),
        ("x > 1 adn x < 2", "S018", "adn", "write `and`"),
        ("x > 1 AND x < 2", "S018", "AND", "write `and`"),
        ("always_[0, 5] x > 1", "S018", "always_", "write `always`"),
        ("always[0 s 5 s] x > 1", "S021", "5", "write `[0 s, 5 s]`"),
        ("always[0..5] x > 1", "S021", ".5", "write `[0, 5]`"),
        ("always (0, 5] x > 1", "S025", "(0, 5]", "write [0, 5]"),
        ("always[0, 5) x > 1", "S025", "[0, 5)", "write [0, 5]"),
        ("next[0, 5] x > 1", "S024", "[", "remove the interval, or write one of always"),
        ("x > 1 scale 2", "S010", "scale", "move it in front of the `:`"),
        ("x > 1\n depends on b", "S010", "depends", "move it in front of the `:`"),
        ("x ≥ 1", "S005", "≥", "write `>=` in its place"),
        ("x ^ 2 > 1", "S005", "^", "write `**` in its place"),
        ("x > 1;", "S005", ";", "remove it"),
        ("x > 1 ∘", "S005", "∘", "remove it; words and signs"),
        ("x'(t) > 1", "S005", "'", "write `rate(x)` for a derivative"),
        ("x > 'a'", "S005", "'", 'write `"` in its place'),
        ("always[0; 5] x > 1", "S005", ";", "write `,` in its place"),
        ("x > \u200b1", "S005", "\u200b", "remove it"),
        ("x > 1 and", "S002", "", "complete the statement here, or remove `and`"),
        ("x := 1", "S012", ":=", "a named formula is `let x = ...`"),
        ("x > 1 hard b: x > 2", "S011", "hard", "begin a new line before `hard`"),
        ("x > 1 time s", "S011", "time", "begin a new line before `time`"),
        ('x > "open', "S006", '"open', 'write `"` at its end'),
    ],
)
def test_a_slip_in_a_formula_has_its_code_its_place_and_its_way_out(formula, code, at, help_):
    problem = only(f"signal x\nhard a: {formula}")
    assert (problem.code, problem.source.slice(problem.span)) == (code, at)
    assert problem.help.startswith(help_)


@pytest.mark.parametrize(
    ("statement", "label"),
    [
        ("signal", "expected a name"),
        ("signal x unit m", "expected a quoted text"),
        ("signal x in 0", "expected `[`"),
        ("param T = x", "expected a number"),
        ("time 5", "expected a unit"),
        ("let p q", "write `=` here"),
        ("let p = x > ,", "expected a number or a signal"),
        ("hard a x > 1", "write `:` here"),
        ("hard a depends b: x > 1", "write `on` here"),
        ("hard a: x > 1 5", "expected an operator or the end of the statement"),
        ("hard a: (x > 1 5)", "write `)` here"),
        ("hard a: always[] x > 1", "expected a number or a signal"),
        ("spec a b", "expected a quoted text or the end of the statement"),
    ],
)
def test_what_was_expected_is_said_in_the_words_of_the_language(statement, label):
    assert only(statement).label == label


@pytest.mark.parametrize("word", ["signal", "always", "true", "inf", "until", "expect"])
def test_a_reserved_word_is_no_name(word):
    problem = only(f"signal {word}")
    assert (problem.code, problem.help) == ("S017", f"choose another name, such as `{word}_`")


@pytest.mark.parametrize(
    ("word", "meant"), [("sginal", "signal"), ("hrad", "hard"), ("Soft", "soft"), ("parm", "param")]
)
def test_a_misspelt_statement_is_told_what_it_was_meant_to_be(word, meant):
    assert only(f"signal x\n{word} y = 1").help == f"did you mean `{meant}`?"


def test_a_unit_behind_an_interval_is_told_its_place():
    problem = only("signal x\nhard a: always[0, 5] ms x > 1")
    assert (problem.code, problem.span.start) == ("S001", 30)
    assert "inside the interval, as in `[0, 5 ms]`" in problem.help


def test_a_line_that_is_no_statement_is_told_the_words():
    problem = only("always (x > 1)")
    assert problem.code == "S003"
    assert "signal, param, let, hard, soft" in problem.help


def test_long_or_unprintable_text_is_shortened_in_messages():
    problem = only("signal x\nhard a: x > " + "9" * 500 + " " + "8" * 500)
    assert len(problem.message) < 60
    assert "\\u0001" in only("signal x\nhard a: x > \x01").message


@pytest.mark.parametrize(
    ("statement", "code", "says"),
    [
        ('expect a hold on "x"', "S018", "write `holds`"),
        ('expect a holds "x"', "S026", "write `on` after `holds`"),
        ("expect a holds on x", "S001", "expected a quoted text or data in braces"),
        ('expect a holds on "x" margin > 3', "S001", "expected `>=`"),
        ('expect a holds on "x" at 3 at 4', "S020", "keep one of the two"),
        ("expect a holds on {x: [1, 2]", "S004", "write `}` after `]`"),
        ("expect a holds on {x: [1, 2}", "S004", "write `]` after `2`"),
        ("expect a holds on {x: 1}", "S001", "expected `[`"),
        ("expect", "S002", "expected a name or a quoted text"),
        ("use common.stl", "S045", 'write `"common.stl"`'),
        ("use ../lib/common.stl", "S045", 'write `"../lib/common.stl"`'),
        ("expect a holds on demos/d1.csv at 3", "S045", 'write `"demos/d1.csv"`'),
        ("expect d1.csv is good", "S045", 'write `"d1.csv"`'),
        ('expect "a.csv" outranks b.csv', "S045", 'write `"b.csv"`'),
        ("expect a holds on [1, 2]", "S001", "expected a quoted text or data in braces"),
        ("expect a holds on {x: [0.5.5]}", "S004", "write `]` after `0.5`"),
        (
            "signal p, q",
            "S044",
            "write `signal q` on a line of its own; a whole spec of Breach is translated by `stlspec import FILE`",
        ),
        (
            "param p = 1, q = 2",
            "S044",
            "write `param q` on a line of its own; a whole spec of Breach is translated by `stlspec import FILE`",
        ),
        (
            "input float y",
            "S003",
            "declare it with `signal`; a whole spec of RTAMT is translated by `stlspec import FILE`",
        ),
    ],
)
def test_a_slip_in_an_expectation_has_its_way_out(statement, code, says):
    problem = only(f"signal x\nhard a: x > 1\n{statement}")
    assert problem.code == code
    assert says in (problem.label, problem.help)
