"""The general kernels agree with the definition in any algebra, on even and uneven time, and can be reversed."""

import math

import numpy as np
import pytest

from stlspec.compiler.ir import Builder
from stlspec.errors import DataError
from stlspec.semantics import folds
from stlspec.semantics.algebra import BOOLEAN, MIN_MAX, Algebra, log_sum_exp
from stlspec.semantics.folds import all_values, evaluate_in, evaluate_in_at, fold_windows, lattice_elements, times
from stlspec.semantics.robustness import TIE
from stlspec.traces import make_trace
from tests.oracle import _ROBUST, NotANumberError, Oracle, distance
from tests.strategies import DECLARED, SECONDS, STEP, seeded_cases

INF = math.inf
WITHOUT_LAWS = Algebra("max and min without laws", np.maximum, np.minimum, INF, -INF)
PROBABILITY = Algebra(
    "independent",
    lambda x, y: x + y - x * y,
    np.multiply,
    1.0,
    0.0,
    negate=lambda x: 1 - x,
    embed=lambda x: 1 / (1 + np.exp(-x)),
)


def soft(values, temperature, sign):
    """Smooth max (sign 1) or min (-1) of a list, from the formula."""
    best = max(sign * v for v in values)
    if math.isinf(best):
        return sign * best
    return sign * (best + temperature * math.log(sum(math.exp((sign * v - best) / temperature) for v in values)))


def definition(temperature):
    parts = {"meet": lambda xs: soft(xs, temperature, -1), "join": lambda xs: soft(xs, temperature, 1)}
    return {**_ROBUST, "name": f"soft {temperature}", **parts}


def chance(op, a, b):
    """The logistic function of the distance."""
    return 1 / (1 + math.exp(-max(-700.0, distance(op, a, b))))


CHANCE = _ROBUST | {
    "name": "chance",
    "meet": math.prod,
    "join": lambda xs: 1 - math.prod(1 - x for x in xs),
    "negate": lambda x: 1 - x,
    "bottom": 0.0,
    "top": 1.0,
    "predicate": chance,
}


@pytest.mark.parametrize(
    ("algebra", "defined"),
    [
        (WITHOUT_LAWS, _ROBUST),
        (MIN_MAX, _ROBUST),
        (log_sum_exp(0.5), definition(0.5)),
        (log_sum_exp(3.0), definition(3.0)),
        (PROBABILITY, CHANCE),
    ],
)
@pytest.mark.parametrize("pairs", [2**20, 40])
def test_engine_and_definition_agree_in_any_algebra(algebra, defined, pairs, monkeypatch):
    monkeypatch.setattr(folds, "_PAIRS", pairs)
    for case in seeded_cases(150, pairs, depth=4, longest=20):
        oracle = Oracle(case.nodes, case.signals, case.times, case.ticks_per_unit)
        try:
            expected = oracle.within(case.root, defined)
        except NotANumberError:
            with pytest.raises(DataError):
                evaluate_in(algebra, case.nodes, [case.root], case.trace())
            continue
        found = evaluate_in(algebra, case.nodes, [case.root], case.trace())[0]
        assert np.allclose(found, expected, rtol=1e-9, atol=1e-9), case
        at = len(expected) // 2
        alone = evaluate_in_at(algebra, case.nodes, [case.root], case.trace(), at)
        assert np.allclose(alone, expected[at], rtol=1e-9, atol=1e-9), case


def test_boolean_is_one_where_a_formula_holds():
    for case in seeded_cases(150, 5):
        oracle = Oracle(case.nodes, case.signals, case.times, case.ticks_per_unit)
        try:
            expected = [1 if h else -1 for h in oracle.holds(case.root)]
            found = evaluate_in(BOOLEAN, case.nodes, [case.root], case.trace())[0]
        except (NotANumberError, DataError):
            continue
        if not any(node.op in ("exp", "log", "sin", "cos", "pow", "hypot") for node in case.nodes):
            assert found.tolist() == expected, case


def test_a_batch_equals_its_traces_in_any_algebra():
    rng = np.random.default_rng(0)
    for base in (STEP, SECONDS):
        stamps = None if base is STEP else np.cumsum(rng.integers(1, 4, 12)) / 10
        signals = {"x": rng.random((3, 12)), "y": rng.random((3, 12)), "b": rng.random((3, 12)) < 0.5}
        batch = make_trace(base, DECLARED, signals, stamps)
        for case in seeded_cases(40, 9, depth=4):
            for algebra in (WITHOUT_LAWS, log_sum_exp(1.0)):
                try:
                    together = evaluate_in(algebra, case.nodes, [case.root], batch)[0]
                except DataError:
                    continue
                for number in range(3):
                    trace = make_trace(base, DECLARED, {k: v[number] for k, v in signals.items()}, stamps)
                    alone = evaluate_in(algebra, case.nodes, [case.root], trace)[0]
                    assert np.allclose(together[:, number], alone, rtol=1e-12, atol=1e-12)


def test_windows_need_nothing_but_associativity():
    """Joining texts is neither idempotent nor commutative."""
    values = np.array(list("abcdefgh"), dtype=object)
    begin = np.array([0, 0, 1, 3, 3, 5, 8, 8])
    end = np.array([1, 3, 8, 3, 7, 8, 8, 8])
    result, _ = fold_windows(np.add, "", values, begin, end)
    assert result.tolist() == ["a", "abc", "bcdefgh", "", "defg", "fgh", "", ""]


def test_no_loop_runs_over_the_samples_of_a_window():
    calls = []

    def add(x, y):
        calls.append(1)
        return x + y

    n, width = 5000, 1000
    index = np.arange(n)
    result, _ = fold_windows(add, 0.0, np.ones(n), index, np.minimum(index + width, n))
    assert result[:3].tolist() == [width] * 3
    assert result[-3:].tolist() == [3, 2, 1]
    assert len(calls) <= 2 * math.log2(width) + 2


def test_until_at_one_sample_looks_at_the_samples_it_depends_on_only():
    builder = Builder()
    p = builder.add("gt", [builder.add("signal", value="x"), builder.add("const", value=0.0)])
    until = builder.add("until", [p, p], interval=(0, None))
    trace = make_trace(STEP, DECLARED[:1], {"x": np.ones(10)})
    values = all_values(WITHOUT_LAWS, builder.nodes, [until], trace, at=4)[until]
    assert values.tolist() == [-INF] * 4 + [1.0] + [-INF] * 5


def test_elements_of_a_lattice_are_shared_where_nothing_changes():
    values = np.array([1.0, -INF])
    assert lattice_elements(MIN_MAX, values) is values
    assert lattice_elements(MIN_MAX, np.array([TIE, -TIE])).tolist() == [0, 0]
    assert lattice_elements(BOOLEAN, np.array([TIE, -TIE, -3.0])).tolist() == [1, -1, -1]


def test_what_has_no_influence_has_none_however_steep_it_is():
    assert times(np.array([0.0, 2.0]), np.array([INF, INF])).tolist() == [0, INF]
