"""The reading `every`: shared operators, trimming, several requirements, with and without counted samples."""

import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.counted import Counted
from stlspec.semantics.online.every import Known, Network, every_program
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import PERIOD, STEP, bundle_of


def bundle(base=STEP):
    """a: always[0, 2] x > 0; b: not a; c: x > 0; d: eventually not a, without end."""
    b = Builder()
    p = b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.0)])
    a = b.add("always", [p], interval=(0, 2 * (base.period or 1)))
    no = b.add("not", [a])
    d = b.add("eventually", [no], interval=(0, None))
    roots = {"a": a, "b": no, "c": p, "d": d}
    return bundle_of(tuple(b.nodes), tuple(Requirement(n, "hard", r) for n, r in roots.items()), (Signal("x"),), base)


@pytest.mark.parametrize(("base", "kind"), [(STEP, Counted), (PERIOD, Network)])
def test_requirements_come_each_at_its_time(base, kind):
    unit = (base.period or 1) / base.ticks_per_unit
    spec = bundle(base)
    program = every_program(spec, make_plan(spec))
    objects = program.objects()
    step = program.bind(objects)
    assert step({"x": 2.0}, None) == [Known(0, 0.0, "c", 2.0, "satisfied")]
    assert step({"x": 0.0}, None) == [Known(1, unit, "c", 0.0, "violated")]
    assert set(step({"x": 3.0}, None)) == {
        Known(2, 2 * unit, "c", 3.0, "satisfied"),
        Known(0, 0.0, "a", 0.0, "violated"),
        Known(0, 0.0, "b", 0.0, "satisfied"),
    }
    opening = objects.parts[program.opening]
    assert type(opening) is kind
    assert opening.first_open(3) == [1, 1, 3, 0]
    assert [(first, len(columns[0])) for first, columns in opening.open_samples(3)] == [(1, 2), (1, 2), (3, 0), (0, 3)]
    assert opening.positions(1, 3)[1].tolist() == [unit, 2 * unit]


def test_operators_are_shared():
    spec = bundle(PERIOD)
    assert len(Network(spec, make_plan(spec))._late) == 2
    assert [type(part).__name__ for part in every_program(bundle(), make_plan(bundle())).objects().parts] == [
        "Counted",
        "Block",
    ]
