"""Walks over trees: operands before what holds them, without a deep stack."""

from stlspec.lang.nodes import Group, Infix, Name, bounds, children, operators, post_order
from stlspec.lang.parse import parse_formula
from stlspec.source import SourceText, Span
from tests.lang.sexpr import sexpr


def read(text):
    return parse_formula(SourceText.of("f", text), frozenset())[0]


def test_operands_come_before_what_holds_them_from_left_to_right():
    order = [sexpr(node) for node in post_order(read("always (x + 1 > y) and abs(z) < 2"))]
    assert order == [
        "x", "1", "(+ x 1)", "y", "(> (+ x 1) y)", "(> (+ x 1) y)", "(always (> (+ x 1) y))",
        "z", "(call abs z)", "2", "(< (call abs z) 2)", "(and (always (> (+ x 1) y)) (< (call abs z) 2))",
    ]  # fmt: skip


def test_a_tree_deeper_than_the_stack_is_walked():
    node = Name(Span(0, 1), "x")
    for _ in range(50_000):
        node = Group(Span(0, 1), node)
    assert sum(1 for _ in post_order(node)) == 50_001


def test_operators_and_bounds_of_a_node_are_its_own():
    node = read("always[a, b] p until[c, d] x[t]")
    assert isinstance(node, Infix)
    assert [o.word for o in operators(node)] == ["until"]
    assert [sexpr(b) for b in bounds(node)] == ["c", "d"]
    left, right = children(node)
    assert [sexpr(b) for b in bounds(left)] == ["a", "b"]
    assert ([o.word for o in operators(right)], [sexpr(b) for b in bounds(right)]) == ([], ["t"])
