"""The generated lines: settled formulas as the offline engine has them, and no word of the spec in the code."""

import random
import sys

import numpy as np
import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder, reachable
from stlspec.errors import DataError
from stlspec.semantics.evaluation import evaluate
from stlspec.semantics.online import make_monitor
from stlspec.semantics.online.front import Front, Lines
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import STEP, bundle_of
from tests.strategies import random_predicate, random_signals


def test_expressions_have_the_bits_of_the_offline_engine():
    rng = random.Random(1)
    refused = compared = 0
    for _ in range(500):
        builder = Builder()
        nodes, order = reachable(builder.nodes, [random_predicate(builder, rng)])
        signals = (Signal("x"), Signal("y"), Signal("b", "bool"))
        bundle = bundle_of(nodes, (Requirement("r", "hard", order[len(builder.nodes) - 1]),), signals, STEP)
        data = random_signals(rng, 6)
        data["x"] = [v + rng.random() if np.isfinite(v) else v for v in data["x"]]
        try:
            expected = evaluate(bundle, data)["r"].signal.tolist()
        except DataError as error:
            expected = str(error)
        monitor, told = make_monitor(bundle, "every"), []
        try:
            for i in range(6):
                told += [k.robustness for k in monitor.update({n: v[i] for n, v in data.items()})]
        except DataError as error:
            # Offline a node is computed at all samples, online a sample at all nodes: another may come first.
            assert isinstance(expected, str)
            assert error.diagnostics[0].code == "D808"
            refused += 1
            continue
        assert [v.hex() for v in told] == [v.hex() for v in expected]
        compared += 1
    assert compared > 300
    assert refused > 5


def test_nothing_of_the_text_of_a_spec_gets_into_the_code():
    evil = 'x"]; import os; os.abort() #'
    b = Builder()
    root = b.add("gt", [b.add("signal", value=evil), b.add("const", value=0.5)])
    bundle = bundle_of(tuple(b.nodes), (Requirement(evil, "hard", root),), (Signal(evil),), STEP)
    lines = Lines()
    front = Front(make_plan(bundle), bundle.signals, lines)
    front.write_samples()
    front.value(root)
    assert "import" not in "\n".join(lines.lines)
    assert make_monitor(bundle).update({evil: 2.0})[evil].current == 1.5
    (known,) = make_monitor(bundle, "every").update({evil: 2.0})
    assert (known.requirement, known.robustness) == (evil, 1.5)


def lines_run(call):
    """How many lines of Python a call runs: what a clock cannot tell from what else the machine does."""
    before, count = sys.gettrace(), 0

    def trace(frame, event, argument):
        nonlocal count
        count += event == "line"
        return trace

    sys.settrace(trace)
    try:
        call()
    finally:
        sys.settrace(before)
    return count


def test_the_work_for_a_requirement_does_not_grow_with_their_number():
    b = Builder()
    x = b.add("signal", value="x")
    roots = [b.add("not", [b.add("gt", [x, b.add("const", value=float(i))])]) for i in range(300)]
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", roots[0]),), (Signal("x"),), STEP)
    front = Front(make_plan(bundle), bundle.signals, Lines())
    front.write_samples()
    first, *_, last = (lines_run(lambda root=root: front.value(root)) for root in roots)
    assert 0 < last <= first


def test_shared_nodes_are_computed_once():
    b = Builder()
    p = b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.5)])
    root = b.add("and", [b.add("once", [p], interval=(0, 3)), b.add("historically", [p], interval=(0, 3)), p])
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), (Signal("x"),), STEP)
    lines = Lines()
    front = Front(make_plan(bundle), bundle.signals, lines)
    front.write_samples()
    front.value(root)
    assert sum(" - " in line for line in lines.lines) == 1


def test_the_least_of_names_leaves_out_what_cannot_count():
    lines = Lines()
    assert lines.least(["INF", "a"]) == "a"
    assert lines.least(["a", "NINF"]) == "NINF"
    assert lines.greatest([]) == "NINF"
    assert lines.lines == []
    assert lines.negated("INF") == "NINF"


@pytest.mark.parametrize(("x", "y", "message"), [(0.0, 0.0, "x / y is not a number at sample 0: x = 0, y = 0")])
def test_an_expression_without_a_value_is_refused_with_its_operands(x, y, message):
    b = Builder()
    quotient = b.add("div", [b.add("signal", value="x"), b.add("signal", value="y")])
    root = b.add("gt", [quotient, b.add("const", value=0.0)])
    bundle = bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), (Signal("x"), Signal("y")), STEP)
    monitor = make_monitor(bundle)
    with pytest.raises(DataError, match=message):
        monitor.update({"x": x, "y": y})
    assert monitor.update({"x": 1.0, "y": 0.0})["r"].current == float("inf")
