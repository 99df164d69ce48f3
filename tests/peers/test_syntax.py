"""Each tool gets formulas in its own notation, and the definition gets them as nodes."""

import pytest

from tests.oracle import Oracle
from tests.peers.syntax import WRITERS, nodes_of

P, Q = ["pred", "x", "<=", 1.0], ["pred", "y", ">=", -0.5]


@pytest.mark.parametrize(
    ("tool", "formula", "text"),
    [
        ("rtamt", ["U", [1, 2], P, Q], "(x <= 1) until[1,2] (y >= -0.5)"),
        ("rtamt", ["implies", ["pred", "x", "!=", 2.0], ["O", None, P]], "(x !== 2) -> (once (x <= 1))"),
        ("rtamt", ["R", [0, 3], P, Q], "not ((not (x <= 1)) until[0,3] (not (y >= -0.5)))"),
        ("rtamt", ["W", [0, 3], P, Q], "(x <= 1) unless[0,3] (y >= -0.5)"),
        ("pybanquo", ["next", ["G", [0, 3], P]], "X (always{0,3} (x <= 1))"),
        ("pybanquo", ["F", None, ["not", Q]], "eventually (not (y >= -0.5))"),
        ("reelay", ["S", [0, 3], P, ["bool", "b"]], "({x <= 1}) since[0:3] ({b: true})"),
        ("reelay", ["prev", ["H", [2, "inf"], P]], "pre (historically[2:] ({x <= 1}))"),
        ("mstlo", ["U", [0, 2], P, ["and", P, Q]], "(x <= 1) U[0, 2] (y >= -0.5)"),
        ("mstlo", ["or", ["not", P], ["G", [1, 2], Q]], "(! (x <= 1)) or (G[1, 2] (y >= -0.5))"),
        ("stlrom", ["implies", P, ["U", [0, 3], P, Q]], "(x[t] <= 1) => ((x[t] <= 1) until_[0, 3] (y[t] >= -0.5))"),
        ("moonlight", ["implies", P, ["G", [0, 3], Q]], "(! ((x <= 1))) | (globally [0, 3] ((y >= -0.5)))"),
        (
            "stlspec",
            ["and", ["O", None, P], ["U", [1, 2], P, Q]],
            "(once (x <= 1)) and ((x <= 1) until[1, 2] (y >= -0.5))",
        ),
    ],
)
def test_a_formula_is_written_as_the_tool_reads_it(tool, formula, text):
    assert WRITERS[tool](formula) == text


@pytest.mark.parametrize(
    ("tool", "formula"),
    [
        ("rtamt", ["next", P]),
        ("rtamt", ["iff", P, Q]),
        ("pybanquo", ["U", [0, 1], P, Q]),
        ("reelay", ["G", [0, 1], P]),
        ("mstlo", ["U", [0, 2], P, Q]),
        ("mstlo", ["O", [0, 2], P]),
    ],
)
def test_what_a_tool_cannot_say_is_not_written(tool, formula):
    with pytest.raises(KeyError):
        WRITERS[tool](formula)


@pytest.mark.parametrize(
    ("formula", "values"),
    [
        # x <= 1 is worth 0, -2, 1 and y >= -0.5 is worth 2.5, -1.5, 1.5
        (["implies", P, Q], [2.5, 2.0, 1.5]),
        (["iff", P, Q], [0.0, 1.5, 1.0]),
        (["xor", P, Q], [0.0, -1.5, -1.0]),
        (["U", [1, 2], P, Q], [-1.5, -2.0, -float("inf")]),
        (["W", None, P, Q], [2.5, -1.5, 1.5]),
        (["R", None, P, Q], [0.0, -1.5, 1.5]),
        (["O", [1, "inf"], P], [-float("inf"), 0.0, 0.0]),
        (["prev", ["next", P]], [-float("inf"), -2.0, 1.0]),
    ],
)
def test_nodes_for_the_definition_mean_what_the_formula_says(formula, values):
    nodes, root = nodes_of(formula)
    signals = {"x": [1.0, 3.0, 0.0], "y": [2.0, -2.0, 1.0]}
    assert Oracle(nodes, signals, [0, 1, 2], 1).rho(root) == values
