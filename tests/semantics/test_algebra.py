"""An algebra keeps the laws that it declares, and the smooth one stays within its stated distance of max and min."""

import math
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.compiler.ir import Builder
from stlspec.errors import DataError, UsageError
from stlspec.semantics.algebra import BOOLEAN, LAWS, MIN_MAX, Algebra, checked, embedded, error_bound, log_sum_exp
from stlspec.semantics.folds import evaluate_in
from stlspec.semantics.robustness import evaluate_nodes, shown
from stlspec.traces import make_trace
from tests.strategies import DECLARED, STEP, seeded_cases

INF = math.inf
numbers = st.floats(-1e6, 1e6) | st.sampled_from([INF, -INF])


def probability(x):
    return 1 / (1 + np.exp(-x))


def product(**changes):
    """Independent probabilities: ⊕ is x + y - xy, ⊗ the product, negation 1 - x."""
    parts = {
        "join": lambda x, y: x + y - x * y,
        "meet": np.multiply,
        "top": 1.0,
        "bottom": 0.0,
        "laws": frozenset({"absorbing", "de_morgan", "monotone"}),
        "negate": lambda x: 1 - x,
        "embed": probability,
    }
    return Algebra("product", **{**parts, **changes})


def test_min_max_and_boolean_are_lattices_and_declare_all_laws():
    assert MIN_MAX.laws == BOOLEAN.laws == LAWS
    assert embedded(BOOLEAN, np.array([-INF, -0.1, 3.0])).tolist() == [-1, -1, 1]


def test_log_sum_exp_of_equal_operands_is_a_temperature_times_log_two_off():
    algebra = log_sum_exp(0.5)
    x = np.array([1.0])
    assert algebra.join(x, x)[0] == pytest.approx(1 + 0.5 * math.log(2))
    assert algebra.meet(x, x)[0] == pytest.approx(1 - 0.5 * math.log(2))


@given(numbers, numbers, st.sampled_from([0.01, 1.0, 30.0]))
def test_log_sum_exp_is_what_its_name_says_for_all_numbers(x, y, temperature):
    algebra = log_sum_exp(temperature)
    high, low = max(x, y), min(x, y)
    excess = 0.0 if x == y and math.isinf(x) else temperature * math.log1p(math.exp((low - high) / temperature))
    assert algebra.join(np.array([x]), np.array([y]))[0] == pytest.approx(high + excess, rel=1e-12)
    assert algebra.meet(np.array([x]), np.array([y]))[0] == pytest.approx(low - excess, rel=1e-12)


@pytest.mark.parametrize("temperature", [0, -1, INF, math.nan, "1", True])
def test_a_temperature_that_is_no_positive_number_is_refused(temperature):
    with pytest.raises(UsageError, match="D880"):
        log_sum_exp(temperature)


def test_an_algebra_can_be_made_of_functions():
    assert product().name == "product"


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"join": 3}, "no callable `join`"),
        ({"embed": "x"}, "no callable `embed`"),
        ({"top": "1"}, "`top` of the algebra 'product' is no number"),
        ({"bottom": math.nan}, "`bottom` of"),
        ({"laws": frozenset({"nice"})}, "unknown law 'nice'"),
        ({"bottom": 0.5}, "the laws of ⊤ and ⊥"),
        ({"meet": lambda x, y: x * y * np.where(x < y, 1, 0.5 + y / 2)}, "does not fulfil"),
        ({"meet": lambda x: x}, "TypeError"),
        ({"laws": frozenset({"idempotent"})}, "x ⊕ x"),
        ({"laws": frozenset({"selective"})}, "one of the operands"),
        ({"laws": frozenset({"distributive"})}, "x ⊗ (y ⊕ z)"),
        ({"laws": frozenset({"lattice"})}, "max"),
        ({"laws": frozenset({"de_morgan"}), "negate": np.negative}, "-x ⊗ -y"),
        ({"laws": frozenset({"monotone"}), "embed": lambda x: 3 * probability(x) - 1}, "no lesser result"),
        ({"top": INF, "bottom": -INF, "join": np.maximum, "meet": np.minimum, "laws": LAWS}, "embed"),
    ],
)
def test_an_ill_formed_algebra_is_refused_with_what_is_wrong(changes, problem):
    with pytest.raises(UsageError) as caught:
        product(**changes)
    (found,) = caught.value.diagnostics
    assert found.code == "D880"
    assert problem in found.message


def test_an_algebra_with_an_element_that_does_not_absorb_may_not_say_so():
    with pytest.raises(UsageError, match="⊤ ⊕ x = ⊤"):
        Algebra("max-plus", np.maximum, np.add, 0.0, -INF, frozenset({"absorbing"}))


@pytest.mark.parametrize("value", [None, "min-max", np.maximum])
def test_what_is_no_algebra_is_refused(value):
    with pytest.raises(UsageError, match="give MIN_MAX, BOOLEAN"):
        checked(value)
    assert checked(BOOLEAN) is BOOLEAN


@pytest.mark.parametrize("seed", range(4))
def test_the_error_bound_holds_for_random_formulas(seed):
    rng = random.Random(seed)
    tight = 0
    for case in seeded_cases(250, seed):
        temperature, trace = rng.choice([0.05, 1.0, 4.0]), case.trace()
        try:
            exact = shown(evaluate_nodes(case.nodes, [case.root], trace)[0])
        except DataError:
            continue
        smooth = evaluate_in(log_sum_exp(temperature), case.nodes, [case.root], trace)[0]
        below, above = error_bound(case.nodes, case.root, trace, temperature)
        same = exact == smooth
        with np.errstate(invalid="ignore"):
            inside = (smooth >= exact - below - 1e-9) & (smooth <= exact + above + 1e-9)
        assert (same | inside).all(), case
        tight += above > 0 and bool((smooth[~same] >= exact[~same] + above - 1e-9).any())
    assert tight, "some formula reaches its bound"


def test_the_error_bound_is_a_temperature_times_log_of_the_window_at_each_level():
    builder = Builder()
    p = builder.add("gt", [builder.add("signal", value="x"), builder.add("const", value=0.0)])
    always = builder.add("always", [p], interval=(1, 3))
    root = builder.add("eventually", [always], interval=(0, 4))
    negated = builder.add("not", [root])
    trace = make_trace(STEP, DECLARED[:1], {"x": np.zeros(20)})
    below, above = 2 * math.log(3), 2 * math.log(5)
    assert error_bound(builder.nodes, root, trace, 2.0) == pytest.approx((below, above))
    assert error_bound(builder.nodes, negated, trace, 2.0) == pytest.approx((above, below))
    assert error_bound(builder.nodes, p, trace, 2.0) == (0, 0)
    until = builder.add("until", [p, p], interval=(2, 5))
    assert error_bound(builder.nodes, until, trace, 1.0) == pytest.approx((math.log(6), math.log(4)))
