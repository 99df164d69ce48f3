"""Which engine serves which formula."""

import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.plan import make_plan
from stlspec.semantics.online.program import start_program
from tests.semantics.online.cases import PERIOD, STEP, bundle_of


def engines(build, base=STEP):
    b = Builder()
    p, q = (b.add("gt", [b.add("signal", value=n), b.add("const", value=0.0)]) for n in ("x", "y"))
    root = build(b, p, q)
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), (Signal("x"), Signal("y")), base)
    return [type(part).__name__ for part in start_program(bundle, make_plan(bundle)).objects().parts]


def windowed(op, low=0, high=3):
    return lambda b, *operands: b.add(op, operands, interval=(low, high))


G, F, U, O = (windowed(op) for op in ("always", "eventually", "until", "once"))  # noqa: E741


@pytest.mark.parametrize(
    ("build", "expected"),
    [
        (lambda b, p, q: p, ["First"]),
        (lambda b, p, q: G(b, p), ["Always"]),
        (lambda b, p, q: F(b, p), ["Always"]),
        (lambda b, p, q: U(b, p, q), ["Until"]),
        (lambda b, p, q: b.add("and", [G(b, p), U(b, p, q)]), ["Always", "Until"]),
        (lambda b, p, q: G(b, O(b, p)), ["Greatest", "Always"]),
        (lambda b, p, q: b.add("next", [G(b, p)]), ["Starting"]),
        (lambda b, p, q: G(b, b.add("or", [b.add("not", [p]), F(b, q)])), ["Nested"]),
        (lambda b, p, q: G(b, b.add("and", [p, F(b, q)])), ["Nested", "Always"]),
        (lambda b, p, q: F(b, G(b, p)), ["Nested"]),
        (lambda b, p, q: G(b, b.add("or", [G(b, p), F(b, q)])), ["Corners"]),
        (lambda b, p, q: G(b, F(b, G(b, p))), ["General"]),
        (lambda b, p, q: U(b, F(b, p), q), ["General"]),
        (lambda b, p, q: windowed("always", 0, None)(b, U(b, F(b, p), q)), ["General"]),
        (lambda b, p, q: windowed("until", 0, None)(b, windowed("always", 0, None)(b, p), q), ["Unending"]),
        (lambda b, p, q: O(b, G(b, p)), ["Always"]),
        (lambda b, p, q: windowed("once", 1)(b, G(b, p)), []),
        (lambda b, p, q: b.add("prev", [G(b, p)]), []),
    ],
)
def test_each_operator_gets_the_cheapest_engine(build, expected):
    assert engines(build) == expected


def test_equal_parts_of_requirements_share_an_engine():
    b = Builder()
    always = G(b, b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.0)]))
    roots = {"a": always, "b": b.add("not", [always])}
    bundle = bundle_of(tuple(b.nodes), tuple(Requirement(n, "hard", r) for n, r in roots.items()), (Signal("x"),), STEP)
    assert len(start_program(bundle, make_plan(bundle)).makers) == 1


def test_next_inside_a_body_needs_samples_without_gaps():
    def build(b, p, q):
        return b.add("always", [b.add("or", [p, b.add("next", [q])])], interval=(0, None))

    assert engines(build) == ["Nested"]
    assert engines(build, PERIOD) == ["General"]


def chain(op, n, interval=None):
    def build(b, p, q):
        for _ in range(n):
            p = b.add(op, [p] if op != "and" else [p, b.add("not", [p])], interval=interval)
        return p

    return build


@pytest.mark.parametrize(
    ("build", "expected"),
    [
        (chain("not", 3000), ["First"]),
        (chain("and", 3000), ["First"]),
        (chain("next", 3000), ["General"]),
        (chain("always", 1000, (0, 1)), ["General"]),
    ],
)
def test_long_chains_need_no_deep_stack(build, expected):
    assert engines(build) == expected


def test_shared_formulas_are_looked_at_once():
    def build(b, p, q):
        x, y = F(b, p), windowed("always", 0, None)(b, q)
        for _ in range(60):
            x, y = b.add("and", [x, y]), b.add("or", [y, x])
        return windowed("always", 0, None)(b, x)

    assert len(engines(build)) < 20
