"""What a file held stays byte for byte; what is added can be read back; a refusal changes nothing."""

import json
import os
from pathlib import Path

import pytest

from stlspec.demos import document_of, load_demonstrations, make_demonstration
from stlspec.errors import DataError, InputError, UsageError
from stlspec.tools.record.storage import DemoFile, appended_lines, appended_list

NEW = document_of(make_demonstration("new ü", states=[[0, 0], [0, 1]], actions=[2]))
OLD = '{"name":"old","signals":{"x":[1e999, 1.50, 0.1]}}'


def names(path: Path) -> list[str]:
    return [d.name for d in load_demonstrations([path])]


@pytest.mark.parametrize(
    ("file", "before"),
    [
        ("a.jsonl", None),
        ("a.jsonl", ""),
        ("a.jsonl", OLD),
        ("a.jsonl", OLD + "\r\n"),
        ("a.json", None),
        ("a.json", "  \n"),
        ("a.json", OLD),
        ("a.json", f" [ {OLD} ]\n"),
        ("a.json", "\ufeff" + OLD),
    ],
)
def test_demonstrations_are_put_behind_what_was_there(tmp_path: Path, file: str, before: str | None) -> None:
    path = tmp_path / file
    if before is not None:
        path.write_text(before, encoding="utf-8")
    held = DemoFile(path)
    old = ["old"] if before and before.strip() else []
    held.save([NEW])
    assert names(path) == [*old, "new ü"]
    held.save([NEW, {**NEW, "name": "second"}])
    assert names(path) == [*old, "new ü", "second"]
    held.save([])
    assert not old or names(path) == old
    if old:
        assert OLD in path.read_text(encoding="utf-8")
    assert [p.name for p in tmp_path.iterdir()] == [file]


def test_a_file_that_someone_else_changed_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.jsonl"
    held = DemoFile(path)
    path.write_text(OLD + "\n")
    with pytest.raises(DataError, match="D886"):
        held.save([NEW])
    assert path.read_text() == OLD + "\n"
    rescued = held.rescue([NEW])
    assert names(rescued) == ["new ü"]
    rescued.unlink()
    path.unlink()
    second = DemoFile(path)
    second.save([NEW])
    path.unlink()
    with pytest.raises(DataError, match="changed"):
        second.save([NEW])


@pytest.mark.parametrize("file", ["a.csv", "a", "no/such/folder.jsonl", "folder.jsonl"])
def test_a_place_of_no_use_is_refused_at_once(tmp_path: Path, file: str) -> None:
    (tmp_path / "folder.jsonl").mkdir()
    with pytest.raises(UsageError, match="D886"):
        DemoFile(tmp_path / file)


@pytest.mark.skipif(os.geteuid() == 0, reason="permissions do not bind the superuser")
def test_a_folder_that_cannot_be_written_is_refused_at_once(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(UsageError, match="permission"):
        DemoFile(tmp_path / "a.jsonl")


@pytest.mark.parametrize("content", ["not json", '{"name": "x"}', '{"states": [[0,0]], "schema": "other"}', "[1, 2"])
def test_a_file_of_something_else_is_refused_and_kept(tmp_path: Path, content: str) -> None:
    path = tmp_path / "a.jsonl"
    path.write_text(content)
    with pytest.raises(InputError):
        DemoFile(path)
    assert path.read_text() == content


def test_numbers_that_are_none_are_never_written() -> None:
    for put in (appended_lines, appended_list):
        with pytest.raises(ValueError, match="Out of range"):
            put(b"", [{"states": [float("nan")]}])
    assert json.loads(appended_list(b"[]", [NEW])) == [NEW]
