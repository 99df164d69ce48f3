"""Explanations say what the definition says: the chain, its values, where it is wrong, and what would turn it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stlspec
from stlspec.semantics.evaluation import Verdict
from stlspec.semantics.explain import explain, named_values
from tests.oracle import Oracle

SPECS = Path(__file__).parents[2] / "specs"


def explained(spec, signals, time=None, name="h", at=0):
    bundle = stlspec.compile(spec)
    return explain(bundle, name, bundle.evaluate(signals, time, at=at)[name])


def test_text_of_a_violation():
    found = explained("signal d\nhard h: always (d >= 1)\n", {"d": [3, 2, 1, 0, 2]})
    assert found.lines() == [
        "h (hard) is violated: robustness -1",
        "  decided by  d = 0, needs >= 1, at sample 3",
        "  by way of   always (d >= 1) at 0 → d >= 1 at 3",
        "  violating   sample 3: 1 of 5",
        "  to hold     d at sample 3 from 0 to at least 1",
    ]


def test_text_of_what_holds_with_a_let_and_time_stamps():
    spec = 'time s\nsignal x unit "m"\nlet near = x < 1\nsoft h: eventually[0, 2 s] near\n'
    found = explained(spec, {"x": [4, 0.25, 0]}, time=[0.5, 1.25, 9])
    assert found.lines() == [
        "h (soft) is satisfied: robustness 0.75",
        "  decided by  x = 0.25, needs < 1, at sample 1 (1.25 s)",
        "  by way of   eventually[0, 2 s] near at 0 → near at 1",
        "  to fail     x at sample 1 from 0.25 to at least 1",
    ]


def test_text_of_a_response_that_is_missing():
    spec = "signal p: bool\nsignal q: bool\nhard h: always (p implies eventually[0, 2] q)\n"
    rows = {"p": [1, 0, 0, 1, 0, 0, 0, 0], "q": [0, 1, 0, 0, 0, 0, 0, 1]}
    assert explained(spec, rows).lines() == [
        "h (hard) is violated: robustness -∞",
        "  decided by  p is true, needs false, at sample 3",
        "  by way of   always (p implies (eventually[0, 2] q)) at 0 → p implies (eventually[0, 2] q) at 3"
        " → not p at 3 → p at 3",
        "  violating   sample 3: 1 of 8",
        "  to hold     p at sample 3 from true to false",
    ]


def test_text_of_a_vacuous_value():
    found = explained("signal x\nhard h: always[5, 9] (x > 0)\n", {"x": [1, 1]})
    assert found.lines() == [
        "h (hard) is satisfied: robustness ∞",
        "  decided by  no sample: what `always[5, 9] (x > 0)` reads at sample 0 lies outside the trace",
        "  to fail     no values of the signals would do",
    ]
    assert found.decided_by == "vacuous"
    assert found.violations == ()


def test_text_of_a_constant():
    found = explained("signal x\nhard h: always (x > 0 or true)\n", {"x": [1, 1]})
    assert found.lines() == [
        "h (hard) is satisfied: robustness ∞",
        "  decided by  no sample: `true` is constant",
        "  by way of   always (x > 0 or true) at 0 → x > 0 or true at 0 → true at 0",
        "  to fail     no values of the signals would do",
    ]


def test_text_where_several_samples_must_change():
    found = explained("signal x\nhard h: always (x > 1)\n", {"x": [2, 1, 1, 5, 0.5]})
    assert found.lines()[3:] == [
        "  violating   samples 1 to 2, 4: 3 of 5",
        "  to hold     no change of one sample would do; all 3 must change: x at samples 1 to 2, 4 to more than 1",
    ]


def test_text_at_a_later_sample_and_of_a_long_chain():
    spec = "signal x\nhard h: always eventually always eventually (x > 1)\n"
    found = explained(spec, {"x": [9, 1, 0]}, at=1)
    assert found.lines()[:3] == [
        "h (hard) is violated at sample 1: robustness -1",
        "  decided by  x = 0, needs > 1, at sample 2",
        "  by way of   always eventually always eventually (x > 1) at 1 → eventually always eventually (x > 1) at 1"
        " → … 2 more … → x > 1 at 2",
    ]
    assert len(found.steps) == 5


def test_data_has_every_part_and_is_json():
    spec = "signal x\nsignal y\nlet far = x - 2 * y > 1\nhard h: always (far or y > 9)\n"
    found = explained(spec, {"x": [4, 2, 4], "y": [1, 3, float("-inf")]})
    document = json.loads(json.dumps(found.to_json(), allow_nan=False))
    (change,) = document["flip"].pop("changes")
    assert change.pop("value") == pytest.approx(0.5)
    assert change == {
        "signal": "y",
        "sample": 1,
        "before": 3.0,
        "bound": 0.5,
        "strict": True,
        "beyond": False,
        "text": "y at sample 1 from 3 to just below 0.5",
    }
    assert document == {
        "requirement": "h",
        "verdict": "violated",
        "robustness": -5.0,
        "sample": 0,
        "decided_by": "predicate",
        "reason": "x - 2 * y = -4, needs > 1",
        "witness": {"sample": 1, "time": 1.0},
        "steps": [
            {"text": "always (far or y > 9)", "name": None, "sample": 0, "time": 0.0, "robustness": -5.0},
            {"text": "far or y > 9", "name": None, "sample": 1, "time": 1.0, "robustness": -5.0},
            {"text": "x - 2 * y > 1", "name": "far", "sample": 1, "time": 1.0, "robustness": -5.0},
        ],
        "operands": [{"text": "x - 2 * y", "value": -4.0}, {"text": "1", "value": 1.0}],
        "signals": {"x": 2.0, "y": 3.0},
        "violations": [[1, 1]],
        "flip": {"kind": "single", "least": 1},
    }


def test_an_undecided_verdict_has_no_flip():
    bundle = stlspec.compile("signal x\nhard h: always (x > 0)\n")
    result = replace(bundle.evaluate({"x": [1]})["h"], verdict=Verdict.UNDECIDED)
    assert explain(bundle, "h", result).flip is None


@pytest.mark.parametrize("demos", ["frozenlake_8x8", "example_2", "grid_two_goals", "mountain_car"])
def test_steps_have_the_values_of_the_definition(demos):
    bundle = stlspec.compile(SPECS / f"{demos}.stl")
    files = {"grid_two_goals": "grid_5x5_two_goals.jsonl", "example_2": "example_2.csv"}
    loaded = stlspec.load_demonstrations([SPECS / "demos" / files.get(demos, f"{demos}.jsonl")])
    for demonstration in stlspec.score(bundle, loaded[:2]).demonstrations:
        for name, score in demonstration.requirements.items():
            found = explain(bundle, name, score.result)
            trace = score.result.origin.trace
            signals = {key: values.tolist() for key, values in trace.signals.items()}
            oracle = Oracle(bundle.nodes, signals, trace.times.tolist(), trace.ticks_per_unit)
            assert found.steps[0].robustness == found.robustness == oracle.rho(score.result.origin.root)[0]
            witness = score.result.witness
            assert found.steps[-1].sample == witness.sample
            assert found.steps[-1].robustness == oracle.rho(witness.predicate)[witness.sample]
            assert 3 <= len(found.lines()) <= 6


def test_explaining_twice_gives_the_same():
    bundle = stlspec.compile("signal x\nhard h: always (x > 1)\n")
    result = bundle.evaluate({"x": [2, 0]})["h"]
    assert explain(bundle, "h", result) == explain(bundle, "h", result)


def test_what_cannot_be_explained_is_refused_with_a_way_out():
    bundle = stlspec.compile("signal x\nhard h: always (x > 1)\n")
    batch = bundle.evaluate({"x": [[2, 0], [1, 1]]})["h"]
    with pytest.raises(stlspec.UsageError) as caught:
        explain(bundle, "h", batch)
    assert caught.value.diagnostics[0].help == "evaluate one trace, and explain its result"
    with pytest.raises(stlspec.UsageError) as caught:
        explain(bundle, "g", bundle.evaluate({"x": [2, 0]})["h"])
    assert "'h'" in caught.value.diagnostics[0].help


def test_every_let_has_its_values_real_ones_too():
    spec = "signal x\nsignal y\nlet gap = x - y\nlet near = gap <= 1\nhard h: always (near and gap > -5)\n"
    found = named_values(stlspec.compile(spec), {"x": [4, 2, 0], "y": [1, 1, 1]})
    assert found.keys() == {"gap", "near"}
    assert found["gap"].tolist() == [3, 1, -1]
    assert found["near"].tolist() == [-2, 0, 2]
    assert not np.signbit(found["near"][1])
    with pytest.raises(ValueError, match="read-only"):
        found["gap"][0] = 1


def test_values_of_lets_over_a_batch_have_a_row_for_each_trace():
    spec = "signal x\nlet up = x > 1\nhard h: eventually up\n"
    found = named_values(stlspec.compile(spec), {"x": [[1, 2, 3], [4, 5, 6]]})
    assert found["up"].tolist() == [[0, 1, 2], [3, 4, 5]]


def test_without_lets_there_are_no_values():
    assert dict(named_values(stlspec.compile("signal x\nhard h: always (x > 1)\n"), {"x": [1]})) == {}
