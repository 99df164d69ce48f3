"""Programs: one function for all copies of a monitor, memory of its own for each."""

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.plan import make_plan
from stlspec.semantics.online.program import Standing, shown, start_program
from stlspec.semantics.robustness import TIE
from tests.semantics.online.cases import STEP, bundle_of


def program():
    b = Builder()
    root = b.add("once", [b.add("ge", [b.add("signal", value="x"), b.add("const", value=1.0)])], interval=(0, None))
    always = b.add("always", [root], interval=(0, None))
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", always),), (Signal("x"),), STEP)
    return start_program(bundle, make_plan(bundle))


def test_two_sets_of_objects_do_not_disturb_each_other():
    made = program()
    first, second = (made.bind(made.objects()) for _ in range(2))
    assert first({"x": 3.0}, None)["r"].current == 2.0
    assert second({"x": 1.0}, None)["r"] == Standing(float("-inf"), 0.0, 0.0, "undecided")
    assert first({"x": 0.0}, None)["r"].current == 2.0


def test_ties_are_shown_as_0():
    assert [shown(v) for v in (TIE, -TIE, 1e-300, -0.0)] == [0.0, 0.0, 1e-300, 0.0]


def test_the_state_goes_from_one_set_of_objects_to_another():
    made = program()
    old, new = made.objects(), made.objects()
    made.bind(old)({"x": 3.0}, None)
    new.load(old.save())
    assert new.save() == old.save()
    assert made.bind(new)({"x": 0.0}, None)["r"].current == 2.0
