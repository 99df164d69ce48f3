"""Nodes read as the user would write them, and never longer than a line."""

import pytest

from stlspec.compiler.ir import Builder
from stlspec.compiler.printing import LONGEST, counted, expression_text, number_text


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.0, "1"), (0.1, "0.1"), (-2.5, "-2.5"), (1e300, "1e+300"), (float("inf"), "inf"), (-0.0, "-0")],
)
def test_numbers_are_printed_shortest(value, text):
    assert number_text(value) == text


def build(tree):
    builder = Builder()

    def add(term):
        if isinstance(term, str):
            return builder.add("now") if term == "now" else builder.add("signal", value=term)
        if isinstance(term, (int, float)):
            return builder.add("const", value=float(term))
        if term[0] == "bool":
            return builder.add("bool", value=term[1])
        return builder.add(term[0], [add(t) for t in term[1:]])

    return builder.nodes, add(tree)


@pytest.mark.parametrize(
    ("tree", "text"),
    [
        (("sub", "d_obs", ("mul", 2, "x")), "d_obs - 2 * x"),
        (("mul", ("sub", "a", "b"), "c"), "(a - b) * c"),
        (("sub", "a", ("sub", "b", "c")), "a - (b - c)"),
        (("sub", ("sub", "a", "b"), "c"), "a - b - c"),
        (("add", "a", "b", "c"), "a + b + c"),
        (("add", "a", ("add", "b", "c")), "a + (b + c)"),
        (("div", "a", ("mul", "b", "c")), "a / (b * c)"),
        (("pow", ("neg", "x"), 2), "(-x) ** 2"),
        (("neg", ("pow", "x", 2)), "-x ** 2"),
        (("pow", -2, "x"), "(-2) ** x"),
        (("pow", ("pow", "x", 2), 3), "(x ** 2) ** 3"),
        (("pow", "x", ("pow", 2, 3)), "x ** 2 ** 3"),
        (("neg", ("neg", "x")), "-(-x)"),
        (("neg", ("add", "x", 1)), "-(x + 1)"),
        (("sub", "x", -2), "x - -2"),
        (("max", ("delta", "x"), ("sqrt", ("add", "x", "now"))), "max(delta(x), sqrt(x + now))"),
        (("ge", ("add", "x", 1), "y"), "x + 1 >= y"),
        (("bool", "in_a"), "in_a"),
    ],
)
def test_expressions_read_as_written_with_the_parentheses_that_they_need(tree, text):
    assert expression_text(*build(tree)) == text


def test_a_shared_expression_is_cut_off_instead_of_growing_exponentially():
    builder = Builder()
    node = builder.add("signal", value="x")
    for _ in range(1000):
        node = builder.add("add", [node, node])
    text = expression_text(builder.nodes, node)
    assert len(text) == LONGEST
    assert text.endswith("…")


@pytest.mark.parametrize(("count", "text"), [(0, "0 errors"), (1, "1 error"), (2, "2 errors")])
def test_nouns_agree_with_their_number(count: int, text: str) -> None:
    assert counted(count, "error") == text
