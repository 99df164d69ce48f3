"""A gradient is what central differences say, and in min/max it stands at the witness."""

import random

import numpy as np
import pytest

import stlspec
from stlspec.compiler.ir import Builder, reachable
from stlspec.errors import DataError, UsageError
from stlspec.semantics.algebra import BOOLEAN, MIN_MAX, Algebra, log_sum_exp
from stlspec.semantics.folds import evaluate_in
from stlspec.semantics.gradients import trace_gradient
from stlspec.traces import make_trace
from tests.strategies import DECLARED, SECONDS, STEP, random_interval, random_times

OPERATORS = [
    "neg",
    "add",
    "sub",
    "mul",
    "abs",
    "min",
    "max",
    "delta",
    "rate",
    "div",
    "sqrt",
    "exp",
    "log",
    "sin",
    "cos",
]
BOUNDED = ("always", "eventually", "until", "historically", "once", "since")


def smooth_expression(builder, rng, depth):
    """A random real expression that is smooth almost everywhere, its operands kept where it has a value."""

    def below():
        return smooth_expression(builder, rng, depth - 1)

    def above(least):
        return builder.add("add", [builder.add("const", value=least), builder.add("abs", [below()])])

    if depth <= 0:
        draw = rng.random()
        if draw < 0.75:
            return builder.add("signal", value=rng.choice("xy"))
        return builder.add("now") if draw < 0.85 else builder.add("const", value=rng.choice([-1.5, 0.5, 2.0]))
    op = rng.choice([*OPERATORS, "hypot", "pow"])
    if op in ("sqrt", "log"):
        return builder.add(op, [above(3.0)])
    if op == "exp":
        return builder.add(op, [builder.add("sin", [below()])])
    if op == "div":
        return builder.add(op, [below(), above(3.0)])
    if op == "pow":
        return builder.add(op, [above(1.0), builder.add("cos", [below()])])
    count = rng.randint(2, 3) if op in ("add", "mul", "min", "max") else 2 if op in ("sub", "hypot") else 1
    return builder.add(op, [below() for _ in range(count)])


def smooth_formula(builder, rng, depth):
    if depth <= 0 or rng.random() < 0.1:
        if rng.random() < 0.05:
            return builder.add("bool", value="b")
        sides = [smooth_expression(builder, rng, rng.choice([0, 1, 1, 2])), smooth_expression(builder, rng, 0)]
        return builder.add(rng.choice(["lt", "le", "gt", "ge", "eq", "ne"]), sides)
    op = rng.choice(["not", "and", "or", "next", "prev", *BOUNDED])
    count = {"and": rng.randint(2, 3), "or": rng.randint(2, 3), "until": 2, "since": 2}.get(op, 1)
    children = [smooth_formula(builder, rng, depth - 1) for _ in range(count)]
    return builder.add(op, children, interval=random_interval(rng) if op in BOUNDED else None)


def smooth_case(rng):
    """Nodes, root, and a function from signals to a trace, with signals that hit no bound."""
    builder = Builder()
    formula = smooth_formula(builder, rng, rng.randint(0, 4))
    nodes, order = reachable(builder.nodes, [formula])
    n, even = rng.randint(1, 12), rng.random() < 0.5
    stamps = None if even else [t / 10 for t in random_times(rng, n, even)]
    signals = {name: [rng.gauss(0, 1) for _ in range(n)] for name in "xy"}
    signals["b"] = [rng.random() < 0.5 for _ in range(n)]
    return nodes, order[formula], signals, lambda s: make_trace(STEP if even else SECONDS, DECLARED, s, stamps)


def difference(value, signals, name, sample, h=1e-6):
    """The central difference quotient."""
    ends = []
    for step in (h, -h):
        moved = {**signals, name: list(signals[name])}
        moved[name][sample] += step
        ends.append(value(moved))
    return (ends[0] - ends[1]) / (2 * h)


@pytest.mark.parametrize("seed", range(4))
def test_central_differences_agree_on_random_formulas(seed):
    rng, compared = random.Random(seed), 0
    for _ in range(90):
        nodes, root, signals, trace_of = smooth_case(rng)
        for algebra in (MIN_MAX, log_sum_exp(rng.choice([0.2, 1.0, 3.0]))):

            def value(moved, algebra=algebra, nodes=nodes, root=root, trace_of=trace_of):
                return float(evaluate_in(algebra, nodes, [root], trace_of(moved))[0][0])

            try:
                finite = np.isfinite(value(signals))
            except DataError:
                continue
            found = trace_gradient(nodes, root, trace_of(signals), ["x", "y"], algebra)
            for name in "xy" if finite else "":
                expected = [difference(value, signals, name, i) for i in range(len(signals["x"]))]
                assert found[name] == pytest.approx(np.array(expected), rel=1e-4, abs=1e-4), (algebra.name, nodes)
                compared += 1
    assert compared > 100


def compiled(formula, time="step"):
    return stlspec.compile(f"spec s\ntime {time}\nsignal x\nsignal y\nsignal b: bool\nhard r:\n  {formula}\n")


def flat(found):
    return {name: values.tolist() for name, values in found.items()}


@pytest.mark.parametrize(
    ("formula", "x", "expected"),
    [
        ("always (x >= 1)", [3, 2, 4], [0, 1, 0]),
        ("always (x <= 1)", [3, 2, 4], [0, 0, -1]),
        ("always (x >= 1)", [3, 1, 1], [0, 1, 0]),  # a tie on the bound: the earliest, its slope without the token
        ("always (x > 1)", [1, 2, 1], [1, 0, 0]),
        ("not eventually (x * x > 1)", [1, 3, -4], [0, 0, 8]),
        ("always (abs(x) > 1)", [2, -3, 0], [0, 0, 0]),
        ("eventually[1, 2] (delta(x) > 0)", [0, 5, 4], [-1, 1, 0]),
        ("always[5, 9] (x > 0)", [1, 2, 3], [0, 0, 0]),  # vacuous
        ("always (y > 0)", [1, 2, 3], [0, 0, 0]),
        ("(x > 0) until (x > 4)", [2, 3, 9], [1, 0, 0]),
    ],
)
def test_in_min_max_the_witness_alone_has_a_derivative(formula, x, expected):
    signals = {"x": x, "y": [1, 1, 1], "b": [0, 0, 0]}
    bundle = compiled(formula)
    found = bundle.gradient(signals)
    assert found.keys() == {"x", "y"}
    assert found["x"].tolist() == expected
    witness = bundle.evaluate(signals)["r"].witness
    moved = np.flatnonzero(found["x"])
    assert "delta" in formula or not len(moved) or moved.tolist() == [witness.sample]


def test_in_a_smooth_algebra_the_samples_of_a_window_share_one_unit():
    found = compiled("always[0, 3] (x > 0)").gradient({"x": [1, 1, 1, 1, 0], "y": [0] * 5, "b": [0] * 5}, None, "r")
    assert found["x"].tolist() == [1, 0, 0, 0, 0]
    smooth = compiled("always[0, 3] (x > 0)").gradient(
        {"x": [1, 1, 1, 1, 0], "y": [0] * 5, "b": [0] * 5}, algebra=log_sum_exp(2.0)
    )
    assert smooth["x"] == pytest.approx(np.array([0.25, 0.25, 0.25, 0.25, 0]))


def test_an_infinite_slope_is_infinite_where_it_counts_and_nothing_elsewhere():
    signals = {"x": [0, 4], "y": [0, 0], "b": [0, 0]}
    assert compiled("(sqrt(x) > -1)").gradient(signals)["x"].tolist() == [np.inf, 0]
    assert compiled("next (sqrt(x) > -1)").gradient(signals)["x"].tolist() == [0, 0.25]


def test_equal_infinities_on_a_bound_give_no_derivative_to_equality():
    signals = {"x": [np.inf], "y": [np.inf], "b": [0]}
    for algebra in (MIN_MAX, log_sum_exp(1.0)):
        assert compiled("x == y").gradient(signals, algebra=algebra)["x"].tolist() == [0]


def test_a_constant_or_boolean_requirement_has_none():
    signals = {"x": [1, 2], "y": [1, 2], "b": [1, 0]}
    for formula in ("always b", "true"):
        for algebra in (MIN_MAX, log_sum_exp(1.0)):
            assert flat(compiled(formula).gradient(signals, algebra=algebra)) == {"x": [0, 0], "y": [0, 0]}


def test_many_traces_give_an_array_for_each():
    bundle = compiled("always (x >= 1)")
    rows = {"x": [[3, 2], [1, 4]], "y": [[0, 0]] * 2, "b": [[0, 0]] * 2}
    assert bundle.gradient(rows)["x"].tolist() == [[0, 1], [1, 0]]
    ragged = {"x": [[3, 2, 1], [1, 4]], "y": [[0] * 3, [0] * 2], "b": [[0] * 3, [0] * 2]}
    assert [g.tolist() for g in bundle.gradient(ragged)["x"]] == [[0, 0, 1], [1, 0]]


def test_an_unknown_requirement_is_refused_with_a_suggestion():
    signals = {"x": [1], "y": [1], "b": [1]}
    with pytest.raises(UsageError, match="there is no requirement 'rr'") as caught:
        compiled("b").gradient(signals, requirement="rr")
    assert "did you mean 'r'" in str(caught.value)
    two = stlspec.compile("signal x\nhard a: x > 0\nhard c: x > 1\n")
    with pytest.raises(UsageError, match="several requirements"):
        two.gradient({"x": [1]})
    assert two.gradient({"x": [1]}, requirement="c")["x"].tolist() == [1]


@pytest.mark.parametrize("algebra", [BOOLEAN, Algebra("a", np.maximum, np.minimum, np.inf, -np.inf), None])
def test_an_algebra_without_slopes_is_refused(algebra):
    with pytest.raises(UsageError, match="D880"):
        compiled("b").gradient({"x": [1], "y": [1], "b": [1]}, algebra=algebra)


def test_following_the_smooth_gradient_repairs_a_trace():
    bundle = compiled("always[0, 5] (x >= 1) and eventually (y >= 2)")
    signals = {"x": np.zeros(8), "y": np.zeros(8), "b": [0] * 8}
    for _ in range(120):
        slopes = bundle.gradient(signals, algebra=log_sum_exp(0.1))
        signals |= {name: signals[name] + 0.3 * slope for name, slope in slopes.items()}
    assert bundle.evaluate(signals)["r"].verdict == "satisfied"
