"""The network of the reading `every`: shared operators, trimming, several requirements."""

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.every import Known, deferred, every_program
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import STEP, bundle_of


def bundle():
    """a: always[0, 2] x > 0; b: not a; c: x > 0; d: eventually not a, without end."""
    b = Builder()
    p = b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.0)])
    a = b.add("always", [p], interval=(0, 2))
    no = b.add("not", [a])
    d = b.add("eventually", [no], interval=(0, None))
    roots = {"a": a, "b": no, "c": p, "d": d}
    return bundle_of(tuple(b.nodes), tuple(Requirement(n, "hard", r) for n, r in roots.items()), (Signal("x"),), STEP)


def test_requirements_share_operators_and_come_each_at_its_time():
    spec = bundle()
    program = every_program(spec, make_plan(spec))
    objects = program.objects()
    step = program.bind(objects)
    assert step({"x": 2.0}, None) == [Known(0, 0.0, "c", 2.0, "satisfied")]
    assert step({"x": 0.0}, None) == [Known(1, 1.0, "c", 0.0, "violated")]
    assert set(step({"x": 3.0}, None)) == {
        Known(2, 2.0, "c", 3.0, "satisfied"),
        Known(0, 0.0, "a", 0.0, "violated"),
        Known(0, 0.0, "b", 0.0, "satisfied"),
    }
    network = objects.parts[program.network]
    assert len(network._late) == 2
    assert network.counts == [1, 1, 3, 0]
    assert [(first, len(rows)) for first, rows in network.open_samples(3)] == [(1, 2), (1, 2), (3, 0), (0, 3)]
    assert network.stamps(1).tolist() == [1.0, 2.0]


def test_what_looks_ahead_without_end_is_deferred():
    spec = bundle()
    assert deferred(spec, make_plan(spec)) == ("d",)
