"""The Python API keeps its contract."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import stlspec

SPECS = Path(__file__).parents[1] / "specs"
TEXT = "signal x\nparam c = 1\nhard up: always (x >= c)\nsoft high depends on up: eventually[0, 2] (x > 3)\n"


def test_text_is_a_spec_and_a_path_is_a_file() -> None:
    assert stlspec.compile(TEXT).requirements[0].name == "up"
    assert stlspec.compile(SPECS / "example_1.stl").name == "example_1"
    with pytest.raises(stlspec.UsageError, match=r"Path\(\.\.\.\)"):
        stlspec.compile("specs/example_1.stl")
    with pytest.raises(stlspec.UsageError, match="int"):
        stlspec.compile(42)  # type: ignore[arg-type]
    with pytest.raises(stlspec.SpecError) as caught:
        stlspec.compile("no spec at all")
    assert caught.value.diagnostics[0].code == "S003"


def test_params_are_bound_at_compile_time_and_are_part_of_the_meaning() -> None:
    one, other = stlspec.compile(TEXT), stlspec.compile(TEXT, params={"c": 2})
    assert [p.value for p in other.params] == [2.0]
    assert one.meaning_sha256 != other.meaning_sha256
    assert one.source_sha256 == other.source_sha256


def test_one_trace_gives_floats_and_a_witness() -> None:
    result = stlspec.compile(TEXT).evaluate({"x": [2, 1, 4]})
    assert (result["up"].robustness, result["up"].verdict) == (0.0, stlspec.Verdict.SATISFIED)
    assert result["up"].witness is not None
    assert result["up"].witness.sample == 1
    assert result["up"].signal.tolist() == [0.0, 0.0, 3.0]


def test_a_batch_gives_arrays_and_a_ragged_list_gives_lists() -> None:
    bundle = stlspec.compile(TEXT)
    batch = bundle.evaluate({"x": [[2, 1, 4], [2, 0, 0]]})
    assert batch["up"].satisfied.tolist() == [True, False]
    assert batch["up"].witness_sample.tolist() == [1, 1]
    assert batch["up"].signal.shape == (2, 3)
    ragged = bundle.evaluate({"x": [[2, 1, 4], [2, 0]]})
    assert ragged["high"].robustness.tolist() == [1.0, -1.0]
    assert [len(row) for row in ragged["up"].signal] == [3, 2]


def test_a_bundle_survives_file_and_pickle(tmp_path: Path) -> None:
    bundle = stlspec.compile(TEXT)
    bundle.save(tmp_path / "x.stlb")
    for copy in (stlspec.load(tmp_path / "x.stlb"), pickle.loads(pickle.dumps(bundle))):
        assert copy == bundle
        assert hash(copy) == hash(bundle)
        assert copy.evaluate({"x": [5]})["up"].robustness == 4.0


def test_a_bundle_cannot_be_changed() -> None:
    bundle = stlspec.compile(TEXT)
    with pytest.raises(AttributeError):
        bundle.name = "other"  # type: ignore[misc]


def test_a_bundle_shows_what_it_is_in_one_line() -> None:
    shown = repr(stlspec.compile(TEXT))
    assert shown.startswith("<Bundle without a name: up, high; meaning ")


def test_one_path_of_demonstrations_needs_no_list() -> None:
    path = SPECS / "demos" / "grid_5x5.jsonl"
    assert len(stlspec.load_demonstrations(path)) == len(stlspec.load_demonstrations([path])) == 4


def test_the_methods_of_a_bundle_reach_monitor_explanation_gradient_and_named_values() -> None:
    bundle = stlspec.compile("signal x\nlet up = x >= 1\nhard h: always up\n")
    monitor = bundle.monitor()
    assert monitor.update({"x": 3})["h"].current == 2.0
    result = bundle.evaluate({"x": [3, 0]})["h"]
    assert bundle.explain("h", result).requirement == "h"
    assert bundle.gradient({"x": [3.0, 0.0]})["x"].tolist() == [0.0, 1.0]
    assert bundle.named_values({"x": [3, 0]})["up"].tolist() == [2.0, -1.0]
    smooth = bundle.evaluate({"x": [3, 0]}, algebra=stlspec.log_sum_exp(0.01))["h"]
    assert smooth.robustness == pytest.approx(-1, abs=0.01)


def test_the_graph_carries_weights() -> None:
    graph = stlspec.compile(TEXT).to_networkx()
    assert list(graph.edges) == [("up", "high")]
    assert graph.nodes["up"]["raw_weight"] == 2
    assert np.isclose(graph.nodes["up"]["weight"] + graph.nodes["high"]["weight"], 1)


def test_unknown_names_are_attribute_errors_and_dir_lists_the_surface() -> None:
    with pytest.raises(AttributeError, match="nothing"):
        _ = stlspec.nothing
    assert "compile" in dir(stlspec)


def test_a_text_uses_files_only_of_a_folder_that_it_is_given(tmp_path: Path) -> None:
    (tmp_path / "signals.stl").write_text("signal d")
    text = 'use "signals.stl"\nhard safe: d > 1'
    with pytest.raises(stlspec.SpecError, match="folder="):
        stlspec.compile(text)
    bundle = stlspec.compile(text, folder=tmp_path)
    assert [s.name for s in bundle.signals] == ["d"]
    assert pickle.loads(pickle.dumps(bundle)) == bundle
    (tmp_path / "spec.stl").write_text(text)
    assert stlspec.compile(tmp_path / "spec.stl").meaning_sha256 == bundle.meaning_sha256


TIMED = "time 100 ms\nsignal x\nhard a: eventually[0, 300 ms] (x > 5)"
LATE = {"x": [0, 0, 6, 0], "time": [0, 100, 900, 1000]}


def test_the_key_time_of_the_data_means_the_stamps_as_in_files(tmp_path: Path) -> None:
    bundle = stlspec.compile(TIMED)
    file = tmp_path / "late.csv"
    file.write_text("time,x\n" + "".join(f"{t},{x}\n" for t, x in zip(LATE["time"], LATE["x"], strict=True)))
    ranking = stlspec.score(bundle, stlspec.load_demonstrations([file]))
    assert ranking.demonstrations[0].label == "bad"
    assert bundle.evaluate(LATE)["a"].verdict is stlspec.Verdict.VIOLATED
    assert bundle.evaluate({"x": LATE["x"]})["a"].verdict is stlspec.Verdict.SATISFIED
    assert bundle.evaluate(LATE, end="interval")["a"].verdict is stlspec.Verdict.VIOLATED
    assert bundle.gradient(LATE)["x"].tolist() == bundle.gradient({"x": LATE["x"]}, LATE["time"])["x"].tolist()
    assert bundle.gradient(LATE)["x"].tolist() != bundle.gradient({"x": LATE["x"]})["x"].tolist()


def test_stamps_of_a_batch_are_common_or_one_row_each() -> None:
    bundle, x = stlspec.compile(TIMED), [LATE["x"], LATE["x"]]
    assert bundle.evaluate({"x": x, "time": LATE["time"]})["a"].satisfied.tolist() == [False, False]
    rows = [LATE["time"], [0, 100, 200, 300]]
    assert bundle.evaluate({"x": x, "time": rows})["a"].satisfied.tolist() == [False, True]
    ragged = {"x": [LATE["x"], [0, 6]], "time": [LATE["time"], [0, 100]]}
    assert bundle.evaluate(ragged)["a"].satisfied.tolist() == [False, True]


def test_a_spec_with_stamps_finds_them_in_the_data() -> None:
    bundle = stlspec.compile("time s\nsignal x\nlet p = x > 5\nhard a: eventually[0, 3 s] p")
    assert bundle.evaluate({"x": [0, 6], "time": [0, 9]})["a"].verdict is stlspec.Verdict.VIOLATED
    assert bundle.named_values({"x": [0, 6], "time": [0, 9]})["p"].tolist() == [-5.0, 1.0]
    with pytest.raises(stlspec.DataError, match="D810"):
        bundle.evaluate({"x": [0, 6]})
    with pytest.raises(stlspec.UsageError, match="given twice"):
        bundle.evaluate({"x": [0, 6], "time": [0, 9]}, time=[0, 9])


def test_a_signal_that_is_called_time_keeps_its_key() -> None:
    bundle = stlspec.compile("signal time\nhard a: always (time > 0)")
    assert bundle.evaluate({"time": [3, 2]})["a"].robustness == 2.0
    assert bundle.monitor().update({"time": 3})["a"].current == 3.0
