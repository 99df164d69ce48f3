"""Samples that are still open: which they are, and that only these are kept."""

import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online import make_monitor
from stlspec.semantics.online.opening import deferred
from stlspec.semantics.online.plan import make_plan
from stlspec.semantics.online.tape import CountedTape, Tape
from tests.semantics.online.cases import PERIOD, STEP, bundle_of

INF = float("inf")


def bundle(high, base=STEP):
    """r: always[0, high] x > 0, high in samples."""
    b = Builder()
    p = b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.0)])
    interval = (0, None if high is None else high * (base.period or 1))
    root = b.add("always", [p], interval=interval)
    return bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), (Signal("x"),), base)


def test_what_looks_ahead_without_end_is_deferred():
    for high, expected in ((None, ("r",)), (3, ())):
        spec = bundle(high)
        assert deferred(spec, make_plan(spec)) == expected


@pytest.mark.parametrize(("base", "kind"), [(STEP, CountedTape), (PERIOD, Tape)])
def test_the_tape_is_cut_where_nothing_is_open(base, kind):
    monitor = make_monitor(bundle(3, base), "every")
    for i in range(2000):
        monitor.update({"x": float(i)})
    opening = monitor._opening()
    assert type(opening.tape) is kind
    assert list(opening.first_open(2000)) == [1997]
    assert len(opening.tape) < 500
    pending = monitor.pending()["r"]
    unit = (base.period or 1) / base.ticks_per_unit
    assert (pending.samples.tolist(), pending.times.tolist()) == (
        [1997, 1998, 1999],
        [i * unit for i in (1997, 1998, 1999)],
    )
    assert (pending.low.tolist(), pending.high.tolist()) == ([-INF] * 3, [1997.0, 1998.0, 1999.0])
