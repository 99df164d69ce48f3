from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest

from stlspec.errors import DataError
from stlspec.readers import registry
from stlspec.readers.model import Recording
from stlspec.readers.registry import read_recordings


def refused(path: Path) -> tuple[str, str]:
    with pytest.raises(DataError) as error:
        read_recordings(path)
    (found,) = error.value.diagnostics
    assert found.file == str(path)
    return found.code, str(error.value)


def test_the_suffix_names_the_reader_whatever_its_case(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(registry, "entry_points", lambda group: pytest.fail("looked up"))
    (tmp_path / "a.CSV").write_text("x\n1\n")
    (tmp_path / "a.json").write_text('{"signals": {"x": [1]}}')
    (tmp_path / "a.jsonl").write_text('{"signals": {"x": [1]}}\n')
    np.savez(tmp_path / "a.npz", x=[1])
    for file in tmp_path.iterdir():
        assert read_recordings(file)[0].columns["x"].tolist() == [1]


@pytest.mark.parametrize(
    ("name", "code", "words"),
    [
        ("a.xlsx", "D831", "known are .csv, .json, .jsonl, .npz"),
        ("a.cvs", "D831", "did you mean .csv?"),
        ("a", "D831", "known are"),
        ("missing.xlsx", "D830", "there is no such file"),
        ("missing.csv", "D830", "there is no such file"),
        ("folder.d", "D830", "it is a directory"),
        ("folder.csv", "D830", "it is a directory"),
    ],
)
def test_a_path_without_a_reader_is_refused(tmp_path: Path, name, code, words):
    path = tmp_path / name
    if name.startswith("folder"):
        path.mkdir()
    elif not name.startswith("missing"):
        path.write_text("x\n1\n")
    found, text = refused(path)
    assert found == code and words in text


def test_other_packages_add_readers(tmp_path: Path, monkeypatch):
    point = EntryPoint("log", "anywhere:read", registry.GROUP)
    monkeypatch.setattr(EntryPoint, "load", lambda self: lambda path: [Recording(name=path.name)])
    monkeypatch.setattr(registry, "entry_points", lambda group: (point,))
    assert read_recordings(tmp_path / "a.log")[0].name == "a.log"


def test_a_broken_plug_in_is_named(tmp_path: Path, monkeypatch):
    point = EntryPoint("log", "no_such_module_here:read", registry.GROUP)
    monkeypatch.setattr(registry, "entry_points", lambda group: (point,))
    found, text = refused(tmp_path / "a.log")
    assert found == "D842" and "no_such_module_here" in text


def test_a_reader_that_knows_columns_is_told_which_ones_are_wanted(monkeypatch):
    asked = []
    monkeypatch.setitem(registry.BUILT_IN, "csv", lambda path, columns=None: asked.append(columns) or [])
    monkeypatch.setitem(registry.BUILT_IN, "npz", lambda path: asked.append("plain") or [])
    registry.read_recordings(Path("a.csv"), {"x"})
    registry.read_recordings(Path("a.csv"))
    registry.read_recordings(Path("a.npz"), {"x"})
    assert asked == [{"x"}, None, "plain"]
