"""What a formula DAG and its parts must obey, whoever wrote them."""

import pytest

from stlspec.compiler.bundle import Requirement, Signal, TimeBase
from stlspec.compiler.ir import Node
from stlspec.compiler.structure import (
    Malformed,
    Reader,
    check_names,
    check_nodes,
    check_requirements,
    check_signals,
    check_time,
)

X, B = Node("signal", value="x"), Node("bool", value="b")
ONE = Node("const", value=1.0)
SIGNALS = {"x": "real", "b": "bool"}


@pytest.mark.parametrize(
    "nodes",
    [
        [B],
        [X, ONE, Node("lt", (0, 1)), Node("always", (2,), interval=(0, None))],
        [B, Node("until", (0, 0), interval=(0, 5)), Node("and", (0, 1, 0))],
        [X, ONE, Node("min", (0, 1, 1)), Node("eq", (2, 0))],
    ],
)
def test_a_good_dag_passes(nodes):
    check_nodes(nodes, SIGNALS)


@pytest.mark.parametrize(
    "nodes",
    [
        [Node("eval", ())],
        [Node("not", (0,))],
        [B, Node("and", (0, 5))],
        [B, Node("and", (0,))],
        [B, Node("not", (0, 0))],
        [X, Node("not", (0,))],
        [B, ONE, Node("add", (0, 1))],
        [B, Node("always", (0,))],
        [B, Node("not", (0,), interval=(0, 1))],
        [Node("signal", value="b")],
        [Node("bool", value="x")],
        [Node("signal", value="zzz")],
        [Node("const")],
        [Node("const", value="x")],
        [Node("true", value=1.0)],
        [B, Node("true", (0,))],
    ],
)
def test_a_dag_that_breaks_a_rule_is_refused(nodes):
    with pytest.raises(Malformed):
        check_nodes(nodes, SIGNALS)


@pytest.mark.parametrize(
    "requirements",
    [
        [],
        [Requirement("a", "hard", 1)],
        [Requirement("a", "hard", 0, ("z",))],
        [Requirement("a", "hard", 0), Requirement("b", "hard", 0, ("a", "a"))],
        [Requirement("a", "soft", 0), Requirement("b", "hard", 0, ("a",))],
    ],
)
def test_requirements_are_formulas_that_depend_on_what_may_come_first(requirements):
    check_requirements([Requirement("a", "hard", 0), Requirement("b", "soft", 0, ("a",))], [B, X])
    with pytest.raises(Malformed):
        check_requirements(requirements, [B, X])


@pytest.mark.parametrize("names", [["a b"], ["a", "a"], [""], ["1"], ["a\n"], ["a", "b", "a"]])
def test_names_are_words_and_unique_over_all_kinds(names):
    check_names(["a"], ["b"], [])
    with pytest.raises(Malformed):
        check_names(names[:1], names[1:])


@pytest.mark.parametrize(
    "signal",
    [
        Signal("x", low=1.0),
        Signal("x", low=2.0, high=1.0),
        Signal("x", low=1.0, high=1.0),
        Signal("x", "bool", low=0.0, high=1.0),
    ],
)
def test_a_range_has_two_ends_in_order_and_belongs_to_a_real_signal(signal):
    check_signals([Signal("x"), Signal("y", low=-1.0, high=float("inf"))])
    with pytest.raises(Malformed):
        check_signals([signal])


@pytest.mark.parametrize(
    "time",
    [
        TimeBase("step", "s", 1),
        TimeBase("step", "step", 2),
        TimeBase("step", "step", 1, 5),
        TimeBase("stamps", "s", 1),
        TimeBase("stamps", "parsec", 1),
        TimeBase("stamps", "step", 1),
        TimeBase("period", "ms", 10**6),
    ],
)
def test_a_time_base_is_one_that_a_time_statement_can_give(time):
    check_time(TimeBase("period", "ms", 10**6, 10**8))
    with pytest.raises(Malformed):
        check_time(time)


GOOD = {
    "text": "a",
    "number": 1.5,
    "inf": "-inf",
    "whole": 3,
    "list": [1, 2],
    "pair": [0, None],
    "texts": ["a"],
    "none": None,
}


def test_a_reader_gives_values_of_the_right_type():
    reader = Reader(GOOD, "it")
    assert (reader.text("text"), reader.name("text"), reader.choice("text", ("a", "b"))) == ("a", "a", "a")
    assert (reader.number("number"), reader.number("inf"), reader.number("whole")) == (1.5, float("-inf"), 3.0)
    assert (reader.whole("whole", 0, 3), reader.index("whole", 4), reader.wholes("list")) == (3, 3, [1, 2])
    assert (reader.pair("pair"), reader.texts("texts")) == ((0, None), ["a"])
    assert (reader.optional_text("none"), reader.optional_number("none")) == (None, None)


@pytest.mark.parametrize(
    ("method", "value"),
    [
        ("text", 1),
        ("text", "\ud800"),
        ("name", "a b"),
        ("number", True),
        ("number", "1"),
        ("number", float("nan")),
        ("number", float("inf")),
        ("number", 10**400),
        ("wholes", [True]),
        ("wholes", [-1]),
        ("wholes", 3),
        ("texts", ["a", 1]),
        ("pair", [1]),
        ("pair", [3, 1]),
        ("pair", [-1, 1]),
        ("pair", [0, 2**63]),
        ("pair", [0, 1.0]),
        ("pair", None),
    ],
)
def test_a_reader_refuses_everything_else(method, value):
    with pytest.raises(Malformed, match=r"`key` of it|of `key`"):
        getattr(Reader({"key": value}, "it"), method)("key")


def test_a_reader_refuses_what_is_no_object_or_list_and_indices_outside():
    with pytest.raises(Malformed):
        Reader([], "it")
    with pytest.raises(Malformed):
        list(Reader({"key": 3}, "it").entries("key"))
    with pytest.raises(Malformed):
        list(Reader({"key": [3]}, "it").entries("key"))
    for wrong in (4, -1, 3.0, True):
        with pytest.raises(Malformed):
            Reader({"key": wrong}, "it").index("key", 4)
