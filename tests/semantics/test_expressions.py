"""Real expressions follow IEEE arithmetic, and one without a value is refused with its operands."""

import numpy as np
import pytest

from stlspec.compiler.bundle import Signal, TimeBase
from stlspec.compiler.ir import Builder
from stlspec.errors import DataError
from stlspec.semantics.robustness import evaluate_nodes
from stlspec.traces import make_trace

INF = float("inf")
DECLARED = (Signal("x"), Signal("y"))
SECONDS = TimeBase("stamps", "s", 10**9)
STEP = TimeBase("step", "step", 1)


def build(tree):
    builder = Builder()

    def add(term):
        if isinstance(term, str):
            return builder.add("now") if term == "now" else builder.add("signal", value=term)
        if isinstance(term, (int, float)):
            return builder.add("const", value=float(term))
        return builder.add(term[0], [add(t) for t in term[1:]])

    return builder.nodes, add(tree)


def values(tree, x=(4.0, -1.0, 0.0), y=(2.0, 3.0, 3.0), time=(10.0, 10.5, 12.5)):
    nodes, root = build(tree)
    trace = make_trace(SECONDS, DECLARED, {"x": x, "y": y}, time)
    return evaluate_nodes(nodes, [root], trace)[0].tolist()


@pytest.mark.parametrize(
    ("tree", "expected"),
    [
        (5.0, [5, 5, 5]),
        ("x", [4, -1, 0]),
        ("now", [0, 0.5, 2.5]),
        (("neg", "x"), [-4, 1, 0]),
        (("abs", "x"), [4, 1, 0]),
        (("add", "x", "y", 1), [7, 3, 4]),
        (("sub", "x", "y"), [2, -4, -3]),
        (("mul", "x", "y", 2), [16, -6, 0]),
        (("div", "y", "x"), [0.5, -3, INF]),
        (("pow", "x", 2), [16, 1, 0]),
        (("min", "x", "y"), [2, -1, 0]),
        (("max", "x", "y", 3.5), [4, 3.5, 3.5]),
        (("sqrt", ("abs", "x")), [2, 1, 0]),
        (("exp", ("mul", "x", 0)), [1, 1, 1]),
        (("log", ("abs", "x")), [np.log(4), 0, -INF]),
        (("sin", 0), [0, 0, 0]),
        (("cos", ("mul", 0, "x")), [1, 1, 1]),
        (("hypot", ("sub", "y", "y"), "x"), [4, 1, 0]),
        (("delta", "x"), [0, -5, 1]),
        (("rate", "x"), [0, -10, 0.5]),
        (("delta", 3), [0, 0, 0]),
    ],
)
def test_operators_have_their_usual_values(tree, expected):
    assert values(tree) == expected


def test_infinite_samples_are_values():
    assert values(("add", "x", 1), x=(INF, -INF, 0)) == [INF, -INF, 1]
    assert values(("min", "x", 2), x=(INF, -INF, 0)) == [2, -INF, 0]
    assert values(("pow", "x", 0.5), x=(INF, -INF, 4)) == [INF, INF, 2]


def test_now_and_rate_are_those_of_every_trace_of_a_batch():
    for tree, expected in ((("rate", "x"), [[0, 0], [2, -4]]), ("now", [[0, 0], [0.5, 0.5]])):
        nodes, root = build(tree)
        trace = make_trace(SECONDS, DECLARED[:1], {"x": [[1, 2], [3, 1]]}, [0, 0.5])
        assert evaluate_nodes(nodes, [root], trace)[0].tolist() == expected


@pytest.mark.parametrize(
    ("tree", "message"),
    [
        (("sqrt", "x"), "sqrt(x) is not a number at sample 1: x = -1"),
        (("log", ("sub", "x", 1)), "log(x - 1) is not a number at sample 1: x - 1 = -2"),
        (("div", "x", ("mul", "x", 0)), "x / (x * 0) is not a number at sample 2: x = 0, x * 0 = 0"),
        (("div", 0, "x"), "0 / x is not a number at sample 2: x = 0"),
        (("sub", ("div", 1, "x"), ("div", 1, "x")), "is not a number at sample 2: 1 / x = inf"),
        (("pow", "x", 0.5), "x ** 0.5 is not a number at sample 1: x = -1"),
        (("sqrt", -1), "sqrt(-1) is not a number at sample 0: its operands are constants"),
    ],
)
def test_an_expression_without_a_value_is_refused_with_its_operands(tree, message):
    with pytest.raises(DataError) as caught:
        values(tree)
    (found,) = caught.value.diagnostics
    assert found.code == "D808"
    assert found.message.endswith(message)


def test_a_change_between_equal_infinities_is_refused_with_both_samples():
    with pytest.raises(DataError, match=r"delta\(x\) is not a number at sample 2: x = inf after inf"):
        values(("delta", "x"), x=(0, INF, INF))


def test_in_a_batch_the_trace_is_named():
    nodes, root = build(("sqrt", "x"))
    trace = make_trace(STEP, DECLARED[:1], {"x": [[1, 2], [3, -1]]}, numbers=(3, 8))
    with pytest.raises(DataError, match=r"sample 1 of trace 8: x = -1"):
        evaluate_nodes(nodes, [root], trace)


@pytest.mark.parametrize("op", ["min", "max"])
@pytest.mark.parametrize("operands", [("x", ("neg", "x")), (("neg", "x"), "x"), (("neg", "x"), ("neg", "x"))])
def test_the_sign_of_a_zero_minimum_does_not_depend_on_order_or_processor(op, operands):
    zeros = (0.0, 0.0, 0.0)
    assert values(("div", 1, (op, *operands)), x=zeros) == [INF, INF, INF]
