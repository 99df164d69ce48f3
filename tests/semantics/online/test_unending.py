"""Formulas without end at any depth: one table, equal to the naive recursion."""

import random

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online import make_monitor
from stlspec.semantics.online.plan import make_plan
from stlspec.semantics.online.program import start_program
from stlspec.semantics.online.unending import MOST_UNKNOWNS, unending_operators
from tests.semantics.online.cases import STEP, bundle_of, check_start, random_case, random_predicate


def endless_formula(builder, rng, depth, scale=1):
    """Boolean operators, always, eventually and until without bounds."""
    if depth <= 0 or rng.random() < 0.1:
        return random_predicate(builder, rng)
    op = rng.choice(["not", "and", "or", "until", "always", "eventually", "always", "eventually"])
    count = {"and": 2, "or": 2, "until": 2}.get(op, 1)
    interval = (0, None) if op in ("always", "eventually", "until") else None
    return builder.add(op, [endless_formula(builder, rng, depth - 1) for _ in range(count)], interval=interval)


def test_what_is_known_equals_the_naive_recursion():
    rng = random.Random(1)
    engines = 0
    for _ in range(400):
        case = random_case(rng, endless_formula, depth=5, longest=10)
        parts = start_program(case.bundle(), make_plan(case.bundle(), case.ends)).objects().parts
        engines += any(type(part).__name__ == "Unending" for part in parts)
        check_start(case)
    assert engines > 50


def sequence(b):
    """always (x > 0 implies eventually (y > 0 and eventually x < 0)): three levels."""
    zero = b.add("const", value=0.0)
    x, y = b.add("signal", value="x"), b.add("signal", value="y")
    last = b.add("eventually", [b.add("lt", [x, zero])], interval=(0, None))
    then = b.add("eventually", [b.add("and", [b.add("gt", [y, zero]), last])], interval=(0, None))
    return b.add("always", [b.add("or", [b.add("le", [x, zero]), then])], interval=(0, None))


def test_a_sequence_without_end_keeps_one_table():
    b = Builder()
    root = sequence(b)
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), (Signal("x"), Signal("y")), STEP)
    monitor = make_monitor(bundle)
    sizes = []
    for count in (10, 3000):
        for i in range(count):
            monitor.update({"x": float(i % 3), "y": -1.0})
        sizes.append(len(monitor.to_bytes()))
    assert sizes[1] < sizes[0] + 100


def test_operators_come_after_those_under_them():
    b = Builder()
    root = sequence(b)
    plan = make_plan(bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), (Signal("x"), Signal("y")), STEP))
    found = unending_operators(plan, (root, False))
    assert [(plan.nodes[i].op, negated) for i, negated in found] == [
        ("eventually", False),
        ("eventually", False),
        ("always", False),
    ]


def test_bounds_and_too_many_operators_are_refused():
    b = Builder()
    p = b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.0)])
    bounded = b.add("always", [b.add("eventually", [p], interval=(0, 5))], interval=(0, None))
    chain = p
    for i in range(MOST_UNKNOWNS + 1):
        chain = b.add("eventually" if i % 2 else "always", [chain], interval=(0, None))
    requirements = (Requirement("a", "hard", bounded), Requirement("b", "hard", chain))
    plan = make_plan(bundle_of(tuple(b.nodes), requirements, (Signal("x"),), STEP))
    assert unending_operators(plan, (bounded, False)) is None
    assert unending_operators(plan, (chain, False)) is None
    assert unending_operators(plan, (plan.nodes[chain].children[0], True)) is not None
