"""One climbing parser for all dialects: levels, associativity, what is a number, what loses its brackets."""

import pytest

from stlspec.lang.nodes import Group, Name, Number, post_order
from stlspec.source import SourceText
from stlspec.tools.importing.formulas import Binding, Dialect, Formulas, bare, every_node, is_real, positive
from stlspec.tools.importing.tokens import Cursor, Unreadable, lex
from stlspec.tools.importing.writing import expression_text

DIALECT = Dialect(
    "Tool",
    "=",
    prefixes={"not": Binding("not", 5, 5), "G": Binding("always", 2, 2), "-": Binding("neg", 9, 9)},
    infixes={
        "|": Binding("or", 3, 4),
        "->": Binding("implies", 1, 1),
        "<": Binding("lt", 6, 7),
        "+": Binding("add", 7, 8),
        "-": Binding("sub", 7, 8),
    },
    functions={"abs": ("abs", 1), "pow": ("pow", 2)},
    truths={"true": True},
    intervals=frozenset({"always"}),
)


def read(text):
    signs = ("->", "|", "<", "+", "-", "(", ")", "[", "]", ",", ":")
    cursor = Cursor(SourceText.of("f", text), lex(SourceText.of("f", text), r"[A-Za-z]+", signs, "#.*")[0], "Tool")
    made = Formulas(cursor, DIALECT, lambda f, token: Name(token.span, token.text), lambda f: f.formula()).formula()
    assert cursor.at_end, cursor.token
    return made


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("a < b | c", "(a < b) or c"),
        ("a | b | c", "a or b or c"),
        ("(a | b) | c", "(a or b) or c"),
        ("a -> b -> c", "a implies (b implies c)"),
        ("G a | b", "always (a or b)"),
        ("G a -> b", "always a implies b"),
        ("not a | b", "not a or b"),
        ("a | G b | c", "a or always (b or c)"),
        ("x - y - 2 < -3", "x - y - 2 < -3"),
        ("x - (y - 2) < 1", "x - (y - 2) < 1"),
        ("G[1:2] a", "always[1, 2] a"),
        ("G[1 2] a", "always[1, 2] a"),
        ("pow(abs(x), 2) < 1", "abs(x) ** 2 < 1"),
        ("true | a", "true or a"),
        ("((a))", "a"),
    ],
)
def test_operators_bind_at_their_levels(text, written):
    assert expression_text(bare(read(text))) == written


def test_brackets_are_kept_until_they_are_asked_away():
    node = read("(a | b) | (c)")
    assert sum(isinstance(n, Group) for n in post_order(node)) == 2
    assert not [n for n in every_node(bare(node)) if isinstance(n, Group)]


@pytest.mark.parametrize("text", ["", "a <", "G[1", "abs(x, y)", "pow(x)", "f(x)", "(a", ")", "a | | b", "(" * 300])
def test_what_cannot_be_read_is_one_diagnostic(text):
    with pytest.raises(Unreadable):
        read(text)


def test_numbers_are_told_from_formulas():
    reals = frozenset("xy")
    assert [is_real(bare(read(t)), reals) for t in ("x", "a", "x + 1", "-x", "abs(x)", "x < 1", "G x", "3")] == [
        *(True, False, True, True, True, False, False, True)
    ]
    assert expression_text(positive(Number(read("x").span, 3.0, None))) == "3 > 0"
