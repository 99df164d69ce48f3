"""Bodies as clauses: what is multiplied out, merged and refused."""

import itertools

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.bodies import clause_tail, clauses_of, fills
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import PERIOD, STEP, bundle_of

INF = float("inf")


def found(build, base=STEP, ends="any", negated=False):
    b = Builder()
    p, q = (b.add("gt", [b.add("signal", value=n), b.add("const", value=0.0)]) for n in ("x", "y"))
    root = build(b, p, q)
    signals = (Signal("x", low=-1.0, high=2.0), Signal("y", low=-3.0, high=4.0))
    plan = make_plan(bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), signals, base), ends)
    return plan, clauses_of(plan, root, negated)


def eventually(b, p, high=3):
    return b.add("eventually", [p], interval=(0, high))


def test_a_response_is_one_clause_with_one_unknown():
    plan, clauses = found(lambda b, p, q: b.add("or", [b.add("not", [p]), eventually(b, q)]))
    ((clause),) = clauses
    assert (plan.nodes[clause.settled.node].op, [u.op for u in clause.unknowns]) == ("not", ["eventually"])
    assert clause_tail(plan, clause) == (-2.0, 4.0)


def test_a_disjunction_of_conjunctions_is_multiplied_out():
    def build(b, p, q):
        both = b.add("and", [eventually(b, p), b.add("always", [q], interval=(0, 3))])
        return b.add("or", [p, both])

    _, clauses = found(build)
    assert [[u.op for u in clause.unknowns] for clause in clauses] == [["eventually"], ["always"]]


def test_two_eventually_with_the_same_window_become_one():
    _, clauses = found(lambda b, p, q: b.add("or", [eventually(b, p), eventually(b, q)]))
    assert [len(clause.unknowns) for clause in clauses] == [1]
    _, clauses = found(lambda b, p, q: b.add("or", [eventually(b, p), eventually(b, q, 4)]))
    assert [len(clause.unknowns) for clause in clauses] == [2]


def test_settled_clauses_become_one():
    _, clauses = found(lambda b, p, q: b.add("and", [p, eventually(b, q), q]))
    assert [len(clause.unknowns) for clause in clauses] == [1, 0]


def test_a_negation_turns_operators_into_their_duals():
    for op, dual in (("always", "eventually"), ("eventually", "always")):
        _, clauses = found(lambda b, p, q, op=op: b.add(op, [p], interval=(0, 3)), negated=True)
        assert [u.op for u in clauses[0].unknowns] == [dual]
    _, clauses = found(lambda b, p, q: b.add("not", [b.add("until", [p, q], interval=(0, 3))]))
    assert [u.op for u in clauses[0].unknowns] == ["release"]


def test_deeper_formulas_and_next_with_gaps_are_refused():
    _, clauses = found(lambda b, p, q: b.add("always", [eventually(b, p)], interval=(0, 3)))
    assert clauses is None
    _, clauses = found(lambda b, p, q: b.add("next", [p]), PERIOD)
    assert clauses is None
    _, clauses = found(lambda b, p, q: b.add("next", [p]))
    assert clauses[0].unknowns[0].interval == (1, 1)


def test_too_many_clauses_are_refused():
    def build(b, p, q):
        pairs = [b.add("and", [eventually(b, p, i), eventually(b, q, i)]) for i in range(5)]
        return b.add("or", pairs)

    assert found(build)[1] is None


def test_what_an_unknown_may_still_be_worth():
    def fill(op, ends, *window):
        def build(b, p, q):
            return b.add(op, [p, q][2 - (2 if op == "until" else 1) :], interval=window)

        plan, clauses = found(build, ends=ends)
        return fills(plan, clauses[0].unknowns[0])

    assert fill("eventually", "any", 0, 3) == [(-INF, 4, -INF)] * 2
    assert fill("eventually", "horizon", 0, 3) == [(-3, 4, -INF)] * 2
    assert fill("always", "any", 0, 3) == [(-3, INF, INF)] * 2
    assert fill("until", "any", 2, 3) == [(-INF, 4, -INF), (-INF, 2, -INF)]
    assert fill("until", "horizon", 2, 3) == [(-3, 4, -INF), (-3, 2, -INF)]


def test_clauses_mean_the_same_as_the_formula():
    def build(b, p, q):
        late, stable = eventually(b, p), b.add("always", [q], interval=(0, 2))
        return b.add("not", [b.add("and", [b.add("or", [p, late]), b.add("or", [b.add("not", [late]), stable])])])

    _, clauses = found(build)
    for x, late, stable in itertools.product([-2.0, -1.0, 1.0, 2.0], repeat=3):
        expected = -min(max(x, late), max(-late, stable))
        ops = {"always": -late, "eventually": -stable}

        def value(clause, x=x, late=late, ops=ops):
            # An unknown is told apart by its operator; the negation of `not late` is `late` itself.
            unknowns = [late if u.op == "eventually" and u.interval == (0, 3) else ops[u.op] for u in clause.unknowns]
            settled = [-x if clause.settled.negated else x] if clause.settled.op == "formula" else []
            return max([*settled, *unknowns])

        assert min(map(value, clauses)) == expected
