"""A spec's requirements on one trace, on a batch, on traces of unequal length."""

import json
import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

import stlspec
from stlspec.compiler.bundle import BundleData, Requirement, Signal, TimeBase
from stlspec.compiler.ir import Builder
from stlspec.errors import DataError, UsageError
from stlspec.semantics import robustness
from stlspec.semantics.algebra import BOOLEAN, MIN_MAX, log_sum_exp
from stlspec.semantics.evaluation import BatchResult, Evaluation, RequirementResult, Verdict, evaluate

INF = float("inf")
STEP = TimeBase("step", "step", 1)
SECONDS = TimeBase("stamps", "s", 10**9)
SIGNALS = (Signal("x"), Signal("y"), Signal("b", "bool"))
DOCUMENT = json.loads((Path(__file__).parent.parent / "conformance" / "vectors.json").read_text())
# Bad intervals are refused before there are nodes.
VECTORS = [v for v in DOCUMENT["vectors"] if v["expected"] != "error:interval"]


def bundle(build, base=STEP):
    """A spec whose requirements `build` returns by name."""
    builder = Builder()
    roots = build(builder)
    return BundleData(
        name="test",
        title=None,
        time=base,
        signals=SIGNALS,
        params=(),
        requirements=tuple(Requirement(name, "hard", root) for name, root in roots.items()),
        nodes=tuple(builder.nodes),
        names=MappingProxyType({}),
        raw_weights=(),
        weights=(),
        sources=(),
    )


def compare(builder, op, name, bound):
    return builder.add(op, [builder.add("signal", value=name), builder.add("const", value=float(bound))])


def grid_world(b):
    """avoid: always x >= 1; reach: eventually[0, 2] y < 1."""
    return {
        "avoid": b.add("always", [compare(b, "ge", "x", 1)], interval=(0, None)),
        "reach": b.add("eventually", [compare(b, "lt", "y", 1)], interval=(0, 2)),
    }


GRID = bundle(grid_world)


def bundle_of(formula):
    """A compiled spec with one requirement r over the signal x."""
    return stlspec.compile(f"signal x\nhard r: {formula}\n")


def test_one_trace_gives_a_number_a_verdict_a_witness_and_all_values():
    result = evaluate(GRID, {"x": [3, 1, 2], "y": [4, 2, 1]})
    assert list(result) == ["avoid", "reach"]
    assert isinstance(result, Evaluation)
    avoid, reach = result["avoid"], result["reach"]
    assert isinstance(avoid, RequirementResult)
    assert (avoid.robustness, avoid.verdict) == (0.0, Verdict.SATISFIED)
    assert (reach.robustness, reach.verdict) == (0.0, Verdict.VIOLATED)
    assert avoid.signal.tolist() == [0, 0, 1]
    assert reach.signal.tolist() == [0, 0, 0]
    assert (avoid.witness.sample, avoid.witness.time, avoid.witness.reason) == (1, 1.0, "x = 1, needs >= 1")
    assert (reach.witness.sample, reach.witness.reason) == (2, "y = 1, needs < 1")
    assert GRID.nodes[avoid.witness.predicate].op == "ge"
    assert not avoid.vacuous
    assert avoid.reason == "x = 1, needs >= 1"


def test_verdicts_are_the_words_of_the_reports():
    assert [str(v) for v in Verdict] == ["satisfied", "violated", "undecided"]
    assert json.dumps(Verdict.VIOLATED) == '"violated"'


def test_a_vacuous_value_has_no_witness_and_says_so():
    spec = bundle(lambda b: {"late": b.add("always", [compare(b, "ge", "x", 1)], interval=(5, 9))})
    late = evaluate(spec, {"x": [1, 2]})["late"]
    assert (late.robustness, late.verdict, late.witness, late.vacuous) == (INF, Verdict.SATISFIED, None, True)
    assert late.reason == "no sample in its window"


def test_an_infinite_value_of_a_predicate_is_not_vacuous():
    avoid = evaluate(GRID, {"x": [INF, INF], "y": [0, 0]})["avoid"]
    assert (avoid.robustness, avoid.vacuous, avoid.witness.sample) == (INF, False, 0)


def test_a_constant_requirement_has_no_witness_and_is_not_vacuous():
    result = evaluate(bundle(lambda b: {"r": b.add("true")}), {"x": [1, 2]})["r"]
    assert (result.robustness, result.witness, result.vacuous, result.reason) == (INF, None, False, "it is constant")


def test_the_witness_has_the_time_that_was_given():
    spec = bundle(grid_world, SECONDS)
    avoid = evaluate(spec, {"x": [3, 0, 2], "y": [4, 2, 1]}, time=[100.0, 100.3, 101.0])["avoid"]
    assert (avoid.witness.sample, avoid.witness.time) == (1, 100.3)


@pytest.mark.parametrize(("at", "expected"), [(0, -1.0), (2, 1.0), (-1, 4.0), (-4, -1.0)])
def test_any_sample_can_be_reported(at, expected):
    result = evaluate(GRID, {"x": [3, 0, 2, 5], "y": [4, 2, 1, 1]}, at=at)
    assert result["avoid"].robustness == expected
    assert result["avoid"].signal.tolist() == [-1, -1, 1, 4]


@pytest.mark.parametrize("at", [4, -5, 1.0, "1", None])
def test_a_sample_that_does_not_exist_is_refused(at):
    with pytest.raises(UsageError, match="D880"):
        evaluate(GRID, {"x": [3, 0, 2, 5], "y": [4, 2, 1, 1]}, at=at)


def test_only_the_signals_that_requirements_use_are_required():
    spec = bundle(lambda b: {"r": compare(b, "ge", "x", 1)})
    assert evaluate(spec, {"x": [2.0]})["r"].robustness == 1.0
    with pytest.raises(DataError, match="D804"):
        evaluate(spec, {"y": [2.0]})


def test_a_batch_gives_arrays():
    x, y = np.array([[3, 1, 2], [3, 0, 2]]), np.array([[4, 2, 1], [4, 2, 0]])
    result = evaluate(GRID, {"x": x, "y": y})
    avoid, reach = result["avoid"], result["reach"]
    assert isinstance(avoid, BatchResult)
    assert avoid.robustness.tolist() == [0, -1]
    assert avoid.satisfied.tolist() == [True, False]
    assert avoid.witness_sample.tolist() == [1, 1]
    assert avoid.vacuous.tolist() == [False, False]
    assert avoid.signal.tolist() == [[0, 0, 1], [-1, -1, 1]]
    assert reach.satisfied.tolist() == [False, True]


def test_a_batch_of_one_is_still_a_batch():
    assert evaluate(GRID, {"x": [[3, 1, 2]], "y": [[4, 2, 1]]})["avoid"].signal.shape == (1, 3)


def test_traces_of_unequal_length_give_a_list_of_values():
    x, y = [[3, 1, 2], [5], [0, 2, 2]], [[4, 2, 1], [0], [4, 2, 0]]
    avoid = evaluate(GRID, {"x": x, "y": y})["avoid"]
    assert avoid.robustness.tolist() == [0, 4, -1]
    assert avoid.witness_sample.tolist() == [1, 0, 0]
    assert [s.tolist() for s in avoid.signal] == [[0, 0, 1], [4], [-1, 1, 1]]
    last = evaluate(GRID, {"x": x, "y": y}, at=-1)["avoid"]
    assert last.robustness.tolist() == [1, 4, 1]


def test_traces_of_a_batch_may_have_their_own_times():
    spec = bundle(grid_world, SECONDS)
    x, y = np.ones((3, 2)) * 2, np.array([[1, 0], [1, 0], [1, 0]])
    times = [[0, 1], [0, 3], [5, 6]]
    # reach looks 2 ns ahead: with stamps in seconds its window holds the first sample only.
    result = evaluate(spec, {"x": x, "y": y}, time=times)["reach"]
    assert result.satisfied.tolist() == [False, False, False]
    assert result.signal.shape == (3, 2)
    wide = bundle(
        lambda b: {"reach": b.add("eventually", [compare(b, "lt", "y", 1)], interval=(0, 2 * 10**9))}, SECONDS
    )
    assert evaluate(wide, {"x": x, "y": y}, time=times)["reach"].satisfied.tolist() == [True, False, True]


def test_a_bad_sample_of_ragged_input_names_its_trace():
    with pytest.raises(DataError, match=r"'y' is NaN at sample 0 of trace 1"):
        evaluate(GRID, {"x": [[3, 1], [5], [0]], "y": [[4, 2], [np.nan], [4]]})
    with pytest.raises(DataError, match=r"no samples in trace 1"):
        evaluate(GRID, {"x": [[3, 1], []], "y": [[4, 2], []]})


def test_strict_refuses_a_trace_shorter_than_a_bounded_horizon():
    short = {"x": [3, 1], "y": [4, 2]}
    with pytest.raises(DataError) as caught:
        evaluate(GRID, short, end="strict")
    (found,) = caught.value.diagnostics
    assert (found.code, "'reach'" in found.message) == ("D809", True)
    assert "it lasts 1 step, the formula looks 2 steps ahead" in found.message
    full = {"x": [3, 1, 2], "y": [4, 2, 1]}
    assert evaluate(GRID, full, end="strict")["reach"].robustness == 0.0
    with pytest.raises(DataError, match="D809"):
        evaluate(GRID, full, end="strict", at=1)


def test_an_unknown_end_is_refused():
    with pytest.raises(UsageError, match="end='interval'"):
        evaluate(GRID, {"x": [3], "y": [4]}, end="interval")


def test_results_cannot_be_changed():
    result = evaluate(GRID, {"x": [[3, 1]], "y": [[4, 2]]})
    with pytest.raises(TypeError):
        result["avoid"] = None
    for values in (result["avoid"].robustness, result["avoid"].signal, result["avoid"].witness_sample):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 3
    with pytest.raises(AttributeError):
        result["avoid"].robustness = 3


def test_evaluation_leaves_its_input_alone_and_later_changes_do_not_reach_the_result():
    x, y = np.array([3.0, 0.0, 2.0]), np.array([4.0, 2.0, 1.0])
    result = evaluate(GRID, {"x": x, "y": y})["avoid"]
    assert (x.tolist(), y.tolist()) == ([3, 0, 2], [4, 2, 1])
    x[:] = 9
    assert result.witness.sample == 1
    assert result.signal.tolist() == [-1, -1, 1]


def test_twice_the_same_call_gives_the_same_bits_also_from_many_threads():
    rng = np.random.default_rng(0)
    data = {"x": rng.standard_normal((20, 300)), "y": rng.standard_normal((20, 300))}

    def bits(_):
        result = evaluate(GRID, data)
        return b"".join(
            r.robustness.tobytes() + r.signal.tobytes() + r.witness_sample.tobytes() for r in result.values()
        )

    with ThreadPoolExecutor(4) as pool:
        assert len(set(pool.map(bits, range(16)))) == 1


@pytest.mark.parametrize("at_a_time", [100, 2**18])
def test_a_batch_equals_its_traces_bit_for_bit(at_a_time, monkeypatch):
    monkeypatch.setattr(robustness, "_BATCH", at_a_time)
    rng = np.random.default_rng(1)
    x, y = rng.standard_normal((7, 50)), rng.standard_normal((7, 50))
    batch = evaluate(GRID, {"x": x, "y": y})
    for j in range(7):
        alone = evaluate(GRID, {"x": x[j], "y": y[j]})
        for name, result in alone.items():
            assert batch[name].robustness[j] == result.robustness
            assert batch[name].satisfied[j] == (result.verdict is Verdict.SATISFIED)
            assert batch[name].signal[j].tobytes() == result.signal.tobytes()
            assert batch[name].witness_sample[j] == result.witness.sample


ALIASES = {"G": "always", "F": "eventually", "H": "historically", "O": "once", "U": "until", "S": "since"}
SIGNS = {">=": "ge", ">": "gt", "<=": "le", "<": "lt", "==": "eq", "!=": "ne"}


def ticks(bounds):
    return (0, None) if bounds is None else tuple(round(b * 10**9) for b in bounds)


def lower(b, formula):
    """Nodes of a conformance formula, derived operators rewritten after their definition."""
    op, *rest = formula
    if op == "pred":
        return compare(b, SIGNS[rest[1]], rest[0], rest[2])
    if op == "bool":
        return b.add("bool", value=rest[0])
    if op in ALIASES:
        return b.add(ALIASES[op], [lower(b, f) for f in rest[1:]], interval=ticks(rest[0]))
    if op == "R":
        negated = [["not", f] for f in rest[1:]]
        return lower(b, ["not", ["U", rest[0], *negated]])
    if op == "W":
        bounds = None if rest[0] is None else [0, rest[0][1]]
        return lower(b, ["or", ["U", *rest], ["G", bounds, rest[1]]])
    if op == "implies":
        return lower(b, ["or", ["not", rest[0]], rest[1]])
    if op == "iff":
        return lower(b, ["and", ["implies", *rest], ["implies", *rest[::-1]]])
    if op == "xor":
        return lower(b, ["not", ["iff", *rest]])
    return b.add(op, [lower(b, f) for f in rest])


@pytest.mark.parametrize("vector", VECTORS, ids=[v["id"] for v in VECTORS])
def test_the_conformance_vectors_hold(vector):
    signals = {name: [float(v) for v in values] for name, values in vector["trace"].items()}
    time = signals.pop("t")
    spec = bundle(lambda b: {"r": lower(b, vector["formula"])}, SECONDS)
    if vector["expected"] == "error:nan":
        with pytest.raises(DataError, match="D801"):
            evaluate(spec, signals, time=time)
        return
    result = evaluate(spec, signals, time=time, at=vector["at"])["r"]
    assert (result.robustness, result.verdict) == (float(vector["expected"]), vector["verdict"])
    assert not np.signbit(result.robustness) or result.robustness < 0


def test_another_algebra_changes_robustness_and_signal_but_no_verdict():
    bundle = bundle_of("always[0, 1] (x >= 1)")
    exact, smooth, boolean = (
        bundle.evaluate({"x": [2.0, 1.0, 3.0]}, algebra=a)["r"] for a in (MIN_MAX, log_sum_exp(1.0), BOOLEAN)
    )
    assert exact.signal.tolist() == [0, 0, 2]
    assert smooth.signal == pytest.approx([-math.log(1 + math.exp(-1)), -math.log(1 + math.exp(-2)), 2])
    assert smooth.robustness == smooth.signal[0]
    assert boolean.signal.tolist() == [1, 1, 1]
    assert boolean.robustness == 1
    assert {r.verdict for r in (exact, smooth, boolean)} == {Verdict.SATISFIED}
    assert exact.witness == smooth.witness == boolean.witness
    assert not boolean.signal.flags.writeable
    assert not smooth.signal.flags.writeable


def test_a_vacuous_value_is_vacuous_in_every_algebra():
    bundle = bundle_of("always[5, 9] (x >= 1)")
    for algebra in (MIN_MAX, log_sum_exp(1.0), BOOLEAN):
        assert bundle.evaluate({"x": [2.0]}, algebra=algebra)["r"].vacuous


def test_a_batch_has_the_values_of_its_traces_in_every_algebra():
    bundle = bundle_of("(x >= 0) until[0, 2] (x >= 1)")
    rows = np.random.default_rng(0).normal(size=(5, 7))
    for algebra in (log_sum_exp(0.5), BOOLEAN):
        batch = bundle.evaluate({"x": rows}, algebra=algebra, at=1)["r"]
        alone = [bundle.evaluate({"x": row}, algebra=algebra, at=1)["r"] for row in rows]
        assert batch.robustness == pytest.approx([one.robustness for one in alone])
        assert batch.satisfied.tolist() == [one.verdict is Verdict.SATISFIED for one in alone]
        assert batch.signal == pytest.approx(np.stack([one.signal for one in alone]))


def test_what_is_no_algebra_is_refused():
    with pytest.raises(UsageError, match="D880"):
        bundle_of("x >= 1").evaluate({"x": [1]}, algebra="max")


def test_the_passes_change_no_result_and_no_witness():
    """The witness names the node of the bundle, not that of the optimised formula."""
    bundle = bundle_of("not eventually[0, 2] eventually[0, 1] not (x >= 1)")
    result = bundle.evaluate({"x": [2, 1.5, 1, 0.5, 0]})["r"]
    assert (result.robustness, result.verdict) == (-0.5, Verdict.VIOLATED)
    assert (result.witness.sample, bundle.nodes[result.witness.predicate].op) == (3, "ge")


def test_a_result_shows_its_robustness_over_time_in_a_notebook():
    result = bundle_of("x >= 1").evaluate({"x": [2, 0]})["r"]
    assert "robustness: satisfied, robustness 1" in result._repr_svg_()
    assert "r &lt;1&gt;: satisfied" in result.chart("r <1>")
