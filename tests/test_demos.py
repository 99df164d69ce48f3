"""Demonstrations as files and memory hold them."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from stlspec.demos import (
    common_environment,
    document_of,
    load_demonstrations,
    make_demonstration,
)
from stlspec.envs.catalogue import make_environment
from stlspec.errors import DataError, InputError
from stlspec.readers.document import recording_of

GRID = make_environment("stlspec/GridWorld-v0", {}, ("S.#", "..G"))


def refused(call, *arguments, **options):
    with pytest.raises(InputError) as error:
        call(*arguments, **options)
    return error.value.diagnostics


def test_a_demonstration_is_called_by_its_own_name_or_its_path_and_episode(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.csv").write_text("x\n1\n")
    Path("b.csv").write_text("episode,x\n3,1\n5,1\n")
    Path("c.json").write_text('[{"states": [1]}, {"states": [2], "name": "mine"}]')
    Path("d.jsonl").write_text('{"states": [1]}\n')
    found = load_demonstrations(["a.csv", Path("b.csv"), "c.json", "d.jsonl"])
    assert [d.name for d in found] == ["a.csv", "b.csv#3", "b.csv#5", "c.json#0", "mine", "d.jsonl"]
    assert [d.file for d in found] == ["a.csv", "b.csv", "b.csv", "c.json", "c.json", "d.jsonl"]
    assert {d.n_samples for d in found} == {1}


def test_the_problems_of_all_files_come_at_once(tmp_path):
    (tmp_path / "a.csv").write_text("x\n1,2\n")
    (tmp_path / "b.csv").write_text("x\n1\n")
    problems = refused(load_demonstrations, [tmp_path / "a.csv", tmp_path / "b.csv", tmp_path / "c.csv"])
    assert [(d.code, d.file) for d in problems] == [
        ("D834", str(tmp_path / "a.csv")),
        ("D830", str(tmp_path / "c.csv")),
    ]


def test_a_demonstration_survives_being_written():
    original = make_demonstration(
        "run",
        {"x": np.array([1.0, math.inf, math.nan]), "ok": [True, False, True]},
        time=np.array([0, 1, 2]),
        states=[np.array([0, 0]), (0, 1), [1, 1]],
        actions=np.array([2, 1]),
        env=GRID.describe(),
    )
    text = json.dumps(document_of(original), allow_nan=False)
    again = recording_of(json.loads(text), Path("run.json"))
    for name, column in original.recording.columns.items():
        np.testing.assert_array_equal(again.columns[name], column)
    assert again.time.tolist() == [0, 1, 2]
    assert (again.name, again.states, again.actions) == ("run", ([0, 0], [0, 1], [1, 1]), (2, 1))
    assert again.env == GRID.describe()


def test_lengths_are_checked():
    with pytest.raises(DataError, match="D805"):
        make_demonstration("d", {"x": [1, 2]}, states=[0])


def test_whole_stamps_stay_whole():
    stamps = [1_700_000_000_123_456_789, 1_700_000_000_123_456_790]
    for kept in (stamps, np.array(stamps)):
        demonstration = make_demonstration("d", {"x": [1, 2]}, time=kept)
        assert demonstration.recording.time.tolist() == stamps
        assert recording_of(document_of(demonstration), Path("d")).time.tolist() == stamps


def test_demonstrations_that_all_name_one_environment_share_it():
    lake = {"id": "FrozenLake-v1", "args": {"is_slippery": False}}
    first = make_demonstration("a", states=[0, 1], env=lake)
    assert common_environment([first, make_demonstration("b", states=[0], env=dict(lake))]).id == "FrozenLake-v1"
    other = make_demonstration("c", states=[0], env={"id": "FrozenLake-v1", "args": {"map_name": "8x8"}})
    for several in ([], [first, other], [first, make_demonstration("d", states=[0])]):
        assert common_environment(several) is None
