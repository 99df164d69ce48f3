"""The engine agrees with the definition; ties carry the verdict in their sign."""

import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stlspec import api
from stlspec.compiler.ir import REAL, Builder
from stlspec.errors import DataError
from stlspec.semantics import robustness
from stlspec.semantics.robustness import TIE, evaluate_at, evaluate_nodes, needed_nodes, schedule, shown
from stlspec.traces import make_trace
from tests.oracle import disagreement, main
from tests.strategies import DECLARED, STEP, cases, random_case, random_signals, seeded_cases

INF = float("inf")


@pytest.mark.parametrize("seed", range(4))
def test_engine_and_definition_agree_on_random_formulas_and_traces(seed):
    assert [d for d in map(disagreement, seeded_cases(500, seed)) if d] == []


@settings(max_examples=60, deadline=None)
@given(cases(depth=3, longest=8))
def test_engine_and_definition_agree_on_what_hypothesis_tries(case):
    assert disagreement(case) is None


def test_the_comparison_can_be_run_from_the_command_line(capsys):
    assert main(["--cases", "50", "--seed", "7"]) == 0
    assert capsys.readouterr().out == "50 cases, 0 disagreements\n"


def predicate(op, x, bound):
    builder = Builder()
    root = builder.add(op, [builder.add("signal", value="x"), builder.add("const", value=bound)])
    trace = make_trace(STEP, DECLARED[:1], {"x": [x]})
    return float(evaluate_nodes(builder.nodes, [root], trace)[0][0])


@pytest.mark.parametrize(
    ("op", "x", "expected"),
    [
        *[(op, 2.0, TIE) for op in ("ge", "le", "eq")],
        *[(op, 2.0, -TIE) for op in ("gt", "lt", "ne")],
        *[("ge", 5.0, 3), ("gt", 5.0, 3), ("le", 5.0, -3), ("lt", 5.0, -3), ("eq", 5.0, -3), ("ne", 5.0, 3)],
        *[("ge", -INF, -INF), ("lt", -INF, INF), ("eq", INF, -INF), ("ne", INF, INF)],
    ],
)
def test_a_predicate_is_worth_its_distance_and_on_its_bound_a_signed_tie(op, x, expected):
    assert predicate(op, x, 2.0) == expected


@pytest.mark.parametrize(("op", "expected"), [("ge", TIE), ("eq", TIE), ("gt", -TIE), ("ne", -TIE)])
@pytest.mark.parametrize("x", [INF, -INF])
def test_equal_infinities_differ_by_nothing(op, expected, x):
    assert predicate(op, x, x) == expected


def test_ties_are_shown_as_zero_never_as_minus_zero():
    values = np.array([TIE, -TIE, 1.0, -INF, 1e-323])
    result = shown(values)
    assert result.tolist() == [0, 0, 1, -INF, 1e-323]
    assert not np.signbit(result[:2]).any()
    assert values[0] == TIE


def test_only_the_nodes_that_the_roots_need_are_evaluated():
    builder = Builder()
    x = builder.add("signal", value="x")
    builder.add("ge", [builder.add("signal", value="absent"), x])
    root = builder.add("ge", [x, builder.add("const", value=1.0)])
    assert needed_nodes(builder.nodes, [root]) == [0, 3, 4]
    trace = make_trace(STEP, DECLARED[:1], {"x": [3.0]})
    assert evaluate_nodes(builder.nodes, [root], trace)[0].tolist() == [2.0]


@settings(max_examples=40, deadline=None)
@given(st.randoms(use_true_random=False), st.integers(1, 5))
def test_a_batch_equals_its_traces_bit_for_bit(rng, n_traces):
    case = random_case(rng, 3, 20)
    n = len(case.times)
    several = [random_signals(rng, n) for _ in range(n_traces)]
    time = None if case.base.kind == "step" else [t / 10 for t in case.times]
    batch = {name: [s[name] for s in several] for name in case.signals}
    try:
        alone = [evaluate_nodes(case.nodes, [case.root], make_trace(case.base, DECLARED, s, time))[0] for s in several]
    except ValueError:
        raise
    except Exception:
        return
    together = evaluate_nodes(case.nodes, [case.root], make_trace(case.base, DECLARED, batch, time))[0]
    assert together.tobytes() == np.stack(alone, axis=1).tobytes()


@pytest.mark.parametrize("seed", range(3))
def test_one_sample_has_the_bits_that_it_has_among_all(seed, monkeypatch):
    rng = random.Random(seed)
    monkeypatch.setattr(robustness, "_BATCH", 64)
    compared = 0
    for _ in range(150):
        case = random_case(rng, 5, 30)
        n = len(case.times)
        several = [random_signals(rng, n) for _ in range(4)]
        time = None if case.base.kind == "step" else [t / 10 for t in case.times]
        trace = make_trace(case.base, DECLARED, {name: [s[name] for s in several] for name in case.signals}, time)
        formulas = [i for i, node in enumerate(case.nodes) if node.op not in REAL]
        roots = [case.root, *rng.sample(formulas, min(2, len(formulas)))]
        try:
            whole = evaluate_nodes(case.nodes, roots, trace)
        except DataError as refusal:
            # What is refused does not depend on what is asked.
            with pytest.raises(DataError) as found:
                evaluate_at(case.nodes, roots, trace, rng.randrange(n))
            assert found.value.diagnostics[0].code == refusal.diagnostics[0].code
            continue
        compared += 1
        for at in {0, n - 1, rng.randrange(n)}:
            expected = np.stack([values[at] for values in whole])
            assert evaluate_at(case.nodes, roots, trace, at).tobytes() == expected.tobytes()
    assert compared > 50


def test_a_sample_without_a_value_is_refused_where_it_decides_nothing():
    bundle = api.compile("signal x\nhard a: always[0,1] (sqrt(x) >= 0)\n")
    with pytest.raises(DataError, match="sample 3 of trace 1"):
        bundle.evaluate({"x": [[1.0] * 5, [1.0, 1.0, 1.0, -1.0, 1.0]]})


def test_only_what_the_wanted_sample_needs_is_computed(monkeypatch):
    bundle = api.compile("signal x\nhard a: always[0,3] eventually[0,2] (x >= 0)\nhard b: once[0,2] (x >= 0)\n")
    seen = []
    compare = robustness.compare
    monkeypatch.setattr(robustness, "compare", lambda *given: (seen.append(given[3].shape), compare(*given)))
    bundle.evaluate({"x": np.ones((2, 1000))})
    assert seen == [(6, 2)]


def test_several_roots_share_their_nodes_and_keep_their_own_values():
    builder = Builder()
    p = builder.add("ge", [builder.add("signal", value="x"), builder.add("const", value=1.0)])
    always = builder.add("always", [p], interval=(0, 1))
    roots = [always, p, builder.add("not", [always]), p]
    trace = make_trace(STEP, DECLARED[:1], {"x": [3, 2, 5]})
    values = [v.tolist() for v in evaluate_nodes(builder.nodes, roots, trace)]
    assert values == [[1, 1, 4], [2, 1, 4], [-1, -1, -4], [2, 1, 4]]


def test_a_thousand_nested_operators_need_no_recursion():
    builder = Builder()
    node = builder.add("ge", [builder.add("signal", value="x"), builder.add("const", value=1.0)])
    for i in range(1000):
        interval = (0, 1)
        op = ("always", "eventually", "not", "next")[i % 4]
        node = builder.add(op, [node], interval=interval if op in ("always", "eventually") else None)
    trace = make_trace(STEP, DECLARED[:1], {"x": [3.0] * 10})
    # 250 times strong `next` under 250 negations: every sample ends beyond the trace.
    assert np.isinf(evaluate_nodes(builder.nodes, [node], trace)[0]).all()


def test_scans_run_while_few_results_are_kept_and_children_come_first():
    nodes = api.compile("signal x\nhard a: always (x > 0)\nhard b: (x > 0) until (x > 1)\n").nodes
    roots = [next(i for i, node in enumerate(nodes) if node.op == op) for op in ("always", "until")]
    order = schedule(nodes, roots)
    assert order.index(roots[1]) < order.index(roots[0])
    assert sorted(order) == list(range(len(nodes)))
    for place, index in enumerate(order):
        assert set(nodes[index].children) <= set(order[:place])


def test_writing_over_an_operand_changes_no_other_value():
    bundle = api.compile("signal x\nlet p = x > 0\nhard a: p and x < 3 and p\nhard b: not p\nhard c: p or not p\n")
    found = bundle.evaluate({"x": [1.0, 2.0]})
    assert [r.signal.tolist() for r in found.values()] == [[1.0, 1.0], [-1.0, -2.0], [1.0, 2.0]]
