"""Every pass keeps every value to the bit, ties and diagnostics included, and does away with what it promises."""

import random

import pytest
from hypothesis import given, settings

from stlspec.compiler import passes
from stlspec.compiler.ir import REAL, Builder, reachable
from stlspec.compiler.passes import PARTIAL, PASSES, optimised
from stlspec.errors import DataError
from stlspec.semantics.algebra import LAWS
from stlspec.semantics.expressions import _NEVER_NAN
from stlspec.semantics.robustness import evaluate_nodes
from tests.strategies import SECONDS, STEP, Case, cases, random_signals, random_times, seeded_cases

TEMPORAL = ("always", "eventually", "historically", "once")


def outcome(nodes, roots, case):
    """Values at every sample, or the message of the error."""
    try:
        return evaluate_nodes(nodes, roots, case.trace())[0].tolist()
    except DataError as error:
        return str(error)


def run(number, case):
    return PASSES[number].run(case.nodes, [case.root], case.trace().spacing)


@pytest.mark.parametrize("number", range(len(PASSES)), ids=[p.name for p in PASSES])
@pytest.mark.parametrize("seed", range(3))
def test_a_pass_changes_no_value_of_a_random_formula(number, seed):
    for case in seeded_cases(400, seed):
        assert outcome(*run(number, case), case) == outcome(case.nodes, [case.root], case), case


@settings(max_examples=100, deadline=None)
@given(cases(depth=4, longest=8))
def test_all_passes_together_change_no_value_that_hypothesis_finds(case):
    nodes, roots = optimised(case.nodes, [case.root], LAWS, case.trace().spacing)
    assert outcome(nodes, roots, case) == outcome(case.nodes, [case.root], case)


def chain(rng):
    """A case that is rich in windows of windows, negations and constants."""
    builder = Builder()
    side = [builder.add("signal", value="x"), builder.add("const", value=rng.choice([-1.0, 0.0, 0.5]))]
    index = builder.add(rng.choice(["lt", "ge", "eq"]), side)
    for _ in range(rng.randint(1, 5)):
        kind = rng.choice([*TEMPORAL[:2], *TEMPORAL, "not", "until", "and"])
        low = rng.choice([0, 0, 1, 3, 7])
        interval = (low, rng.choice([None, low, low + 1, low + 4]))
        if kind == "until":
            constant = builder.add(rng.choice(["true", "false"]))
            sides = rng.choice([(constant, index), (index, constant)])
            index = builder.add(rng.choice(["until", "since"]), sides, interval=interval)
        elif kind == "and":
            index = builder.add(rng.choice(["and", "or"]), [index, builder.add(rng.choice(["true", "false"]))])
        else:
            index = builder.add(kind, [index], interval=interval if kind != "not" else None)
    nodes, order = reachable(builder.nodes, [index])
    n, even = rng.randint(1, 14), rng.random() < 0.5
    return Case(nodes, order[index], random_signals(rng, n), random_times(rng, n, even), STEP if even else SECONDS)


@pytest.mark.parametrize("seed", range(3))
def test_chains_of_windows_negations_and_constants_keep_their_values(seed):
    rng = random.Random(seed)
    for _ in range(700):
        case = chain(rng)
        expected = outcome(case.nodes, [case.root], case)
        for number in range(len(PASSES)):
            assert outcome(*run(number, case), case) == expected, case
        assert outcome(*optimised(case.nodes, [case.root], LAWS, case.trace().spacing), case) == expected, case


def build(tree):
    """Nodes and root of a nested tuple (op, children..., interval?) over "p" (x > 1) and "q" (y < x / y)."""
    builder = Builder()

    def add(term):
        if term in ("true", "false"):
            return builder.add(term)
        x, y, one = builder.add("signal", value="x"), builder.add("signal", value="y"), builder.add("const", value=1.0)
        if term == "p":
            return builder.add("gt", [x, one])
        if term == "p complement":
            return builder.add("le", [x, one])
        if term == "q":
            return builder.add("lt", [y, builder.add("div", [x, y])])
        op, *rest = term
        interval = rest.pop() if op in (*TEMPORAL, "until", "since") else None
        return builder.add(op, [add(t) for t in rest], interval=interval)

    root = add(tree)
    nodes, order = reachable(builder.nodes, [root])
    return nodes, order[root]


@pytest.mark.parametrize(
    ("tree", "expected"),
    [
        (("and", "p", "true"), "p"),
        (("and", "p", "false"), "false"),
        (("and", "q", "false"), ("and", "q", "false")),  # 0 / 0 is still reported
        (("or", ("not", "false"), "p"), "true"),
        (("always", "true", (3, 5)), "true"),
        (("always", "false", (3, 5)), ("always", "false", (3, 5))),  # true where the window is empty
        (("once", "true", (0, 5)), "true"),
        (("until", "true", "p", (2, 9)), ("eventually", "p", (2, 9))),
        (("since", "true", "p", (2, 9)), ("once", "p", (2, 9))),
        (("until", "false", "p", (0, 9)), "p"),
        (("until", "false", "p", (1, 9)), ("until", "false", "p", (1, 9))),
        (("until", "p", "false", (1, 9)), "false"),
        (("until", "q", "false", (1, 9)), ("until", "q", "false", (1, 9))),
        (("next", "true"), ("next", "true")),
    ],
)
def test_constants_are_folded_where_that_hides_no_diagnostic(tree, expected):
    nodes, root = build(tree)
    folded, roots = passes.fold_constants(nodes, [root], 1)
    assert (folded, roots) == (build(expected)[0], (build(expected)[1],))


@pytest.mark.parametrize(
    ("tree", "expected"),
    [
        (("not", "p"), "p complement"),
        (("not", ("always", "p", (0, 3))), ("eventually", "p complement", (0, 3))),
        (("not", ("and", "p", ("not", "q"))), ("or", "p complement", "q")),
        (("and", "p", ("not", "p")), ("and", "p", ("not", "p"))),  # both signs are needed: negating is cheaper
        (("not", ("next", "p")), ("not", ("next", "p"))),
        (("not", ("until", ("not", "p"), "q", (0, 3))), ("not", ("until", "p complement", "q", (0, 3)))),
    ],
)
def test_negations_vanish_in_comparisons_that_are_used_once(tree, expected):
    nodes, root = build(tree)
    pushed, roots = passes.push_negations(nodes, [root], 1)
    assert (pushed, roots) == (build(expected)[0], (build(expected)[1],))


@pytest.mark.parametrize(
    ("outer", "inner", "spacing", "fused"),
    [
        ((0, 3), (0, 4), 1, (0, 7)),
        ((2, 3), (1, 4), 1, (3, 7)),
        ((2, None), (1, 4), 1, (3, None)),
        ((2, 5), (1, None), 1, (3, None)),
        ((1, 25), (9, 31), 10, (20, 50)),  # in samples [1, 2] and [1, 3]
        ((1, 9), (0, 30), 10, None),  # no sample in the outer window, ever
        ((0, 30), (1, 9), 10, None),
        ((0, 3), (0, 4), None, None),
        ((4, None), (0, 4), None, (4, None)),
        ((0, 3), (4, None), None, (4, None)),
        ((1, 3), (4, None), None, None),
    ],
)
@pytest.mark.parametrize("op", TEMPORAL)
def test_two_windows_become_one_where_that_is_the_same_window(op, outer, inner, spacing, fused):
    nodes, root = build((op, (op, "p", inner), outer))
    expected = build((op, "p", fused)) if fused else (nodes, root)
    assert passes.fuse_windows(nodes, [root], spacing) == (expected[0], (expected[1],))


def test_uneven_windows_are_not_fused_because_a_hole_may_lie_between():
    """Samples at 0 and 5: always[0,3] always[0,3] sees the first only, always[0,6] both."""
    nodes, root = build(("always", ("always", "p", (0, 30)), (0, 30)))
    case = Case(nodes, root, {"x": [2.0, 0.0], "y": [1.0, 1.0], "b": [0, 0]}, [0, 50], SECONDS)
    assert outcome(*optimised(nodes, [root], LAWS, None), case) == [1, -1]


def test_a_pass_runs_only_under_its_laws():
    nodes, root = build(("always", ("always", ("not", "p"), (0, 3)), (0, 4)))
    pushed = build(("always", ("always", "p complement", (0, 3)), (0, 4)))
    assert optimised(nodes, [root], frozenset(), 1) == (nodes, (root,))
    assert optimised(nodes, [root], frozenset({"de_morgan"}), 1) == (pushed[0], (pushed[1],))
    assert optimised(nodes, [root], LAWS, 1)[0] == build(("always", "p complement", (0, 7)))[0]


def test_passes_of_the_same_nodes_run_once():
    nodes, root = build(("not", "p"))
    assert optimised(nodes, [root], LAWS, 1)[0] is optimised(nodes, [root], LAWS, 1)[0]


def test_the_operators_that_may_have_no_value_are_those_that_evaluation_checks():
    assert PARTIAL == REAL - _NEVER_NAN


def test_equal_nodes_are_shared_after_a_pass():
    nodes, root = build(("or", ("not", "p"), ("always", "p complement", (0, 3))))
    pushed, _ = passes.push_negations(nodes, [root], 1)
    assert [n.op for n in pushed].count("le") == 1
    assert [n.op for n in pushed] == ["signal", "const", "le", "always", "or"]
