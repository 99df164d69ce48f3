"""Minari datasets as recordings, and back. The datasets are made here; nothing is fetched."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from stlspec.cli.main import run
from stlspec.errors import DataError
from stlspec.readers import minari
from stlspec.readers.model import Recording
from tests.readers.recorded import frozen_lake, mountain_car

SPECS = Path(__file__).parents[2] / "specs"

HAS_MINARI = all(__import__("importlib.util").util.find_spec(name) for name in ("minari", "h5py", "PIL"))
needs_minari = pytest.mark.skipif(not HAS_MINARI, reason="the extra minari is not installed")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "datasets"))


def code(call, *arguments):
    with pytest.raises(DataError) as error:
        call(*arguments)
    return error.value.diagnostics[0].code


@needs_minari
def test_numbered_states_and_infos_survive():
    first = Recording(states=(0, 1, 5), actions=(2, 1), columns={"info.speed": np.array([0.0, 0.5, 1.0])})
    second = Recording(states=(0, 0), actions=(3,), columns={"speed": np.array([1.0, 2.0])})
    minari.write([first, second], "lake/two-v0")
    again = minari.read(Path("minari:lake/two-v0"))
    assert [(r.states, r.actions, r.episode) for r in again] == [((0, 1, 5), (2, 1), "0"), ((0, 0), (3,), "1")]
    assert again[0].columns["info.speed"].tolist() == [0, 0.5, 1]
    assert again[0].env is None


@needs_minari
def test_raw_observations_survive_to_the_bit():
    rng = np.random.default_rng(1)
    rows = rng.normal(size=(30, 2))
    minari.write([Recording(states=tuple(map(list, rows.tolist())), actions=(1,) * 29)], "car-v0")
    (again,) = minari.read(Path("minari:car-v0"))
    assert np.array(again.states).tobytes() == rows.tobytes()


@needs_minari
def test_the_environment_is_described_and_not_made(monkeypatch):
    import gymnasium

    live = gymnasium.make("FrozenLake-v1", map_name="8x8", is_slippery=False)
    minari.write([Recording(states=(0, 1), actions=(2,))], "lake/one-v3", live)
    monkeypatch.setattr(gymnasium, "make", None)
    (again,) = minari.read(Path("minari:lake/one-v3"))
    assert again.env == {"id": "FrozenLake-v1", "args": {"map_name": "8x8", "is_slippery": False}}


@needs_minari
def test_a_dataset_is_never_written_over():
    one = [Recording(states=(0, 1), actions=(2,))]
    minari.write(one, "lake/one-v0")
    assert code(minari.write, one, "lake/one-v0") == "D830"


@needs_minari
@pytest.mark.parametrize("name", ["no/such-v0", "", "../../etc", "a" * 5000])
def test_what_is_no_dataset_is_refused(name):
    assert code(minari.read, Path(f"minari:{name}")) in ("D830", "D836")


@needs_minari
def test_a_damaged_dataset_is_one_diagnostic(tmp_path):
    minari.write([Recording(states=(0, 1), actions=(2,))], "lake/one-v0")
    (data,) = (tmp_path / "datasets").rglob("*.hdf5")
    data.write_bytes(data.read_bytes()[:200])
    assert code(minari.read, Path("minari:lake/one-v0")) == "D836"


@needs_minari
@pytest.mark.parametrize("lacking", ["states", "actions"])
def test_a_recording_needs_states_and_actions(lacking):
    parts = {"states": (0, 1), "actions": (2,), "columns": {"x": np.array([1.0, math.inf])}}
    assert code(minari.write, [Recording(**{**parts, lacking: None})], "half-v0") == "D837"


def test_without_the_extra_the_way_out_is_named(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "minari", None)
    assert code(minari.read, Path("minari:a/b-v0")) == "D847"


@needs_minari
def test_a_dataset_of_the_lake_is_scored_and_learned_from(tmp_path, capsys):
    frozen_lake("lake/paths-v0")
    assert run(["score", str(SPECS / "frozenlake_4x4.stl"), "minari:lake/paths-v0", "--format", "json"]) == 0
    scores = json.loads(capsys.readouterr().out)["demonstrations"]
    assert [d["label"] for d in scores] == ["good", "good", "bad"]
    assert scores[2]["requirements"]["avoid"]["witness"]["sample"] == 2
    # The environment is the one that the dataset names.
    words = ["learn", str(SPECS / "frozenlake_4x4.stl"), "--episodes", "500", "--out", str(tmp_path / "out")]
    assert run([*words, "--demos", "minari:lake/paths-v0"]) == 0
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["success"] and result["policy"]["states"][-1] == [3, 3]
    assert "breaks avoid; forbids down from [0, 1]" in capsys.readouterr().out


@needs_minari
def test_a_dataset_of_the_car_is_scored_and_learned_from(tmp_path, capsys):
    mountain_car("car/swings-v0")
    recordings = minari.read(Path("minari:car/swings-v0"))
    assert min(state[0] for r in recordings for state in r.states) == float(np.float32(-1.2)) < -1.2
    assert run(["score", str(SPECS / "mountain_car.stl"), "minari:car/swings-v0", "--format", "json"]) == 0
    scores = json.loads(capsys.readouterr().out)["demonstrations"]
    assert [d["label"] for d in scores] == ["good"] * 4
    words = ["learn", str(SPECS / "mountain_car.stl"), "--bins", "20,20", "--base", "env", "--episodes", "5"]
    assert run([*words, "--demos", "minari:car/swings-v0", "--out", str(tmp_path / "out")]) == 0
    assert capsys.readouterr().out.count("good  minari:car/swings-v0#") == 4
