"""The tape keeps what is looked at, and no more."""

import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.arrays import needed
from stlspec.semantics.online.plan import make_plan
from stlspec.semantics.online.saving import Unsound
from stlspec.semantics.online.tape import CountedTape, Tape, reach_back
from tests.semantics.online.cases import STAMPS, STEP, bundle_of


def filled(count):
    tape = Tape(1)
    for i in range(count):
        tape.push(2 * i, [float(i)])
    return tape


def test_a_tape_gives_its_rows_as_arrays():
    times, columns = filled(5).arrays(3)
    assert (times.tolist(), columns[0].tolist()) == ([6, 8], [3.0, 4.0])


def test_a_tape_can_grow_after_its_arrays_were_taken():
    tape = filled(3)
    tape.arrays(0)
    tape.push(6, [3.0])
    assert len(tape.times) == 4


def test_samples_within_reach_are_needed():
    assert [filled(100).needed(50, reach) for reach in (0, 1, 2, 5, 400, None)] == [50, 50, 49, 48, 0, 0]


def test_a_tape_forgets_what_is_out_of_reach():
    tape = filled(400)
    tape.drop(300, 10)
    assert (tape.base, tape.times[0], len(tape.times)) == (295, 590, 105)
    tape.drop(390, None)
    assert tape.base == 295


def test_a_few_rows_are_not_worth_forgetting():
    tape = filled(60)
    tape.drop(60, 0)
    assert tape.base == 0


def test_columns_of_unequal_length_are_refused():
    tape = filled(3)
    state = tape.save()
    state["columns"] = [[1.0]]
    with pytest.raises(Unsound):
        tape.load(state)
        tape.check(3, 4)


def counted(count):
    tape = CountedTape(2)
    for i in range(count):
        tape.columns[0].append(float(i))
        tape.columns[1].append(-float(i))
    return tape


def test_a_counted_tape_needs_no_times():
    tape = counted(400)
    assert [tape.needed(50, reach) for reach in (0, 1, 60, None)] == [50, 49, 0, 0]
    assert tape.needed(400, 0) == 399
    tape.drop(300, 10)
    assert (tape.base, len(tape)) == (290, 110)
    tape.drop(390, None)
    assert tape.base == 290
    times, columns = tape.arrays(398)
    assert (times.tolist(), columns[0].tolist(), columns[1].tolist()) == ([398, 399], [398.0, 399.0], [-398.0, -399.0])
    state = tape.save()
    tape.load(state | {"columns": [[1.0], []]})
    with pytest.raises(Unsound):
        tape.check(400, 399)


@pytest.mark.parametrize(
    ("base", "build", "expected"),
    [
        (STEP, lambda b, f: f, 0),
        (STEP, lambda b, f: b.add("once", [f], interval=(1, 4)), 4),
        (STEP, lambda b, f: b.add("prev", [b.add("once", [f], interval=(1, 4))]), 5),
        (STEP, lambda b, f: b.add("once", [f], interval=(1, None)), None),
        (STAMPS, lambda b, f: b.add("prev", [f]), None),
        (STEP, lambda b, f: b.add("since", [f, b.add("historically", [f], interval=(0, 2))], interval=(0, 3)), 5),
    ],
)
def test_the_reach_adds_up_along_past_operators(base, build, expected):
    builder = Builder()
    future = builder.add("next", [builder.add("bool", value="b")])
    root = build(builder, future)
    bundle = bundle_of(tuple(builder.nodes), (Requirement("r", "hard", root),), (Signal("b", "bool"),), base)
    plan = make_plan(bundle)
    assert reach_back(plan, needed(plan, [root])[1], [root]) == expected
