"""Minari datasets as recordings, and back. The datasets are made here; nothing is fetched."""

import math
from pathlib import Path

import numpy as np
import pytest

from stlspec.errors import DataError
from stlspec.readers import minari
from stlspec.readers.model import Recording

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
