"""Monitors over finitely many states: the same as for the values of the states, and what is refused."""

import random

import numpy as np
import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.errors import DataError, UsageError
from stlspec.semantics.online import Monitor, make_monitor
from stlspec.semantics.online.plan import make_plan
from stlspec.semantics.online.states import make_states
from tests.semantics.online.cases import STEP, VALUES, bundle_of, nested_formula, random_case
from tests.semantics.online.test_monitor import avoid, respond, spec

ONE = (Signal("x"),)


def random_states(rng, case, count=5):
    """A table of states whose values a sample of the case may have."""
    return {
        name: [rng.random() < 0.5 if name == "b" else rng.choice(VALUES) for _ in range(count)] for name in case.signals
    }


def plainly(result):
    """What an update gave, as texts that tell bits apart."""
    return repr(result)


@pytest.mark.parametrize("reading", ["start", "every"])
def test_a_state_tells_what_its_values_tell_on_any_formula(reading):
    rng = random.Random(f"states {reading}")
    for i in range(300):
        case = random_case(rng, nested_formula if i % 2 else None, longest=12)
        bundle, states = case.bundle(), random_states(rng, case)
        plain = make_monitor(bundle, reading, case.ends)
        tabled = make_monitor(bundle, reading, case.ends, states)
        for n in range(case.n):
            state = rng.randrange(5)
            sample = {name: values[state] for name, values in states.items()}
            expected = plain.update(sample, case.stamp(n))
            if rng.random() < 0.2:
                tabled = tabled.copy()
            elif rng.random() < 0.2:
                tabled = Monitor.from_bytes(bundle, tabled.to_bytes(), states)
            assert plainly(tabled.update(state, case.stamp(n))) == plainly(expected), case
            assert plainly(tabled.pending()) == plainly(plain.pending())
        assert plainly(tabled.finish()) == plainly(plain.finish())


def test_an_array_has_a_column_for_each_signal_of_the_spec():
    bundle = spec(respond, (Signal("x"), Signal("y")))
    monitor = make_monitor(bundle, states=np.array([[1.0, -2.0], [-1.0, 3.0]]))
    monitor.update(0)
    assert monitor.update(np.int64(1))["r"].current == 3.0
    assert monitor.n_samples == 2


def test_only_what_depends_on_the_state_alone_becomes_a_table():
    b = Builder()
    x, two = b.add("signal", value="x"), b.add("const", value=2.0)
    present = b.add("not", [b.add("gt", [b.add("mul", [x, x]), two])])
    changing = b.add("gt", [b.add("delta", [x]), two])
    root = b.add("and", [b.add("or", [present, changing]), b.add("once", [present], interval=(0, 3))])
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), ONE, STEP)
    states = make_states(bundle, make_plan(bundle), {"x": [1.0, 2.0, 5.0]})
    assert dict(sorted(states.tables.items())) == {
        x: [1.0, 2.0, 5.0],
        present: [1.0, -2.0, -23.0],
    }
    monitor = make_monitor(bundle, states={"x": [1.0, 2.0, 5.0]})
    monitor.update(1)
    assert monitor.update(2)["r"].current == -2.0


@pytest.mark.parametrize("state", [3, -1, True, 1.0, "1", None, {"x": 1.0}, np.bool_(True), 10**30])
def test_a_state_that_does_not_exist_is_refused_and_changes_nothing(state):
    monitor = make_monitor(spec(avoid, ONE), states={"x": [3.0, 2.0, 1.0]})
    monitor.update(1)
    before = monitor.to_bytes()
    with pytest.raises(DataError, match="states are numbered 0 to 2") as caught:
        monitor.update(state)
    assert caught.value.diagnostics[0].code == "D895"
    assert monitor.to_bytes() == before
    assert monitor.update(0)["avoid"].current == 1.0


def test_states_that_no_sample_can_have_are_refused_before_any_sample():
    bundle = spec(avoid, (Signal("x", low=0.0, high=5.0),))
    for values, code in (([1.0, 9.0], "D807"), ([float("nan")], "D801"), ([], "D803"), (["a"], "D806")):
        with pytest.raises(DataError) as caught:
            make_monitor(bundle, states={"x": values})
        assert caught.value.diagnostics[0].code == code
    with pytest.raises(DataError, match="x"):
        make_monitor(bundle, states={"z": [1.0]})
    b = Builder()
    quotient = b.add("div", [b.add("signal", value="x"), b.add("signal", value="x")])
    root = b.add("gt", [quotient, b.add("const", value=0.0)])
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), ONE, STEP)
    with pytest.raises(DataError, match="x / x is not a number at sample 1"):
        make_monitor(bundle, states={"x": [1.0, 0.0]})


@pytest.mark.parametrize("states", [[1.0, 2.0], [[1.0, 2.0]], 3, {"x": [[1.0, 2.0], [3.0, 4.0]]}])
def test_states_of_another_shape_are_refused(states):
    with pytest.raises(UsageError, match="n_states"):
        make_monitor(spec(avoid, ONE), states=states)


def test_a_monitor_is_restored_with_its_own_states_only():
    bundle, states = spec(avoid, ONE), {"x": [3.0, 2.0, 1.0]}
    monitor = make_monitor(bundle, states=states)
    monitor.update(2)
    data = monitor.to_bytes()
    assert Monitor.from_bytes(bundle, data, states).update(0)["avoid"].current == 0.0
    for others in (None, {"x": [3.0, 2.0, 1.5]}, {"x": [3.0, 2.0]}):
        with pytest.raises(DataError, match="other states"):
            Monitor.from_bytes(bundle, data, others)
    with pytest.raises(DataError, match="other states"):
        Monitor.from_bytes(bundle, make_monitor(bundle).to_bytes(), states)


def test_the_callers_arrays_may_change_afterwards():
    values = np.array([3.0, 1.0])
    monitor = make_monitor(spec(avoid, ONE), states={"x": values})
    values[0] = -9.0
    assert monitor.update(0)["avoid"].current == 2.0
