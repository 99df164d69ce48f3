"""One spelling of every operator; brackets where tools disagree, and no others."""

import pytest

from stlspec.errors import SpecError
from stlspec.lang.formatting.text import format_text


def body(formula, head="let p = "):
    return format_text(f"{head}{formula}\n").removeprefix(head).removesuffix("\n")


@pytest.mark.parametrize(
    ("written", "canonical"),
    [
        ("G x", "always x"),
        ("alw_[0:5]x", "always[0, 5] x"),
        ("F[0,5]x", "eventually[0, 5] x"),
        ("finally hist once_ globally x", "eventually historically once always x"),
        ("X Y wnext wprev x", "next prev wnext wprev x"),
        ("a U b", "a until b"),
        ("a since_[1 ,  2] b", "a since[1, 2] b"),
        ("a W b", "a unless b"),
        ("a R b", "a release b"),
        ("a S b", "a since b"),
        ("a&&b & c", "a and b and c"),
        ("a||b | c", "a or b or c"),
        ("!a", "not a"),
        ("a -> b", "a implies b"),
        ("a <=> b", "a iff b"),
        ("a xor b", "a xor b"),
        ("-x**2*3-y/z", "-x ** 2 * 3 - y / z"),
        ("0<=x<=5", "0 <= x <= 5"),
        ("x=5", "x = 5"),
        ("abs( x,y )", "abs(x, y)"),
        ("5   m/s < 3 m / s", "5 m/s < 3 m / s"),
        ("x[t] > t", "x > now"),
        ("x[t + 1] > 2", "x[now + 1] > 2"),
        ("true and false or inf > 1", "(true and false) or inf > 1"),
    ],
)
def test_every_operator_has_one_spelling(written, canonical):
    assert body(written) == canonical
    assert body(canonical) == canonical


@pytest.mark.parametrize(
    ("written", "canonical"),
    [
        ("G a & b", "(always a) and b"),
        ("a & b -> c", "(a and b) implies c"),
        ("a -> b -> c", "a implies (b implies c)"),
        ("a & b | c", "(a and b) or c"),
        ("a U b & c", "(a until b) and c"),
        ("G a U b", "(always a) until b"),
        ("not G a & b", "(not always a) and b"),
        ("a -> F b", "a implies eventually b"),
        ("F a & F b", "(eventually a) and (eventually b)"),
        ("(F a) & F b", "(eventually a) and (eventually b)"),
        ("G x > 5", "always (x > 5)"),
        ("not x > 5", "not (x > 5)"),
        ("not a and b", "not a and b"),
        ("(((a))) and ((b))", "(a) and (b)"),
        ("--x > 0", "-(-x) > 0"),
        ("x > 5 and y < 3", "x > 5 and y < 3"),
    ],
)
def test_brackets_stand_where_tools_split(written, canonical):
    assert body(written) == canonical
    assert body(canonical) == canonical


def test_t_stays_where_something_declares_it():
    assert format_text("signal t\nlet p = x[t] > t\n") == "signal t\nlet p = x[t] > t\n"
    assert format_text("let f(t) = t > 1\nlet p = t\n") == "let f(t) = t > 1\nlet p = t\n"


def test_declared_aliases_are_names():
    assert format_text("signal G\nlet p = G > 3 & F[0,1] G<2") == (
        "signal G\nlet p = G > 3 and eventually[0, 1] (G < 2)\n"
    )


def test_a_long_formula_breaks_at_its_loosest_operators():
    long = " and ".join(f"signal_number_{i} > {i}" for i in range(5))
    parts = "".join(f"        {'and ' if i else ''}signal_number_{i} > {i}\n" for i in range(5))
    assert format_text(f"let p = always[0, 5] ({long})\n") == f"let p =\n    always[0, 5] (\n{parts}    )\n"


def test_the_deepest_formulas_need_no_deep_stack():
    deep = "always (" * 90 + "a and (b or c > 1 + x[1])" + ")" * 90
    assert body(deep).count("always") == 90
    bounds = "always[(" * 99 + "1" + "), 9] a" * 99
    assert body(bounds).count("always") == 99


def test_what_is_broken_is_not_formatted():
    with pytest.raises(SpecError):
        body("a and")
