"""Specs are found wherever they lie in a folder, and a folder that is too large is said to be."""

import os

import pytest

from stlspec.errors import InputError
from stlspec.tools.lsp import folders
from stlspec.tools.lsp.folders import specs_under


def test_specs_are_found_at_any_depth_once(tmp_path):
    for name in ("b.stl", "a.stlspec", "c.txt", "deep/er/d.stl", ".git/e.stl", "x/node_modules/f.stl"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    found = specs_under([str(tmp_path), str(tmp_path / "deep")])
    assert [path.removeprefix(f"{tmp_path}/") for path in found] == ["a.stlspec", "b.stl", "deep/er/d.stl"]
    assert len(specs_under([str(tmp_path)], deep=False)) == 2


def test_a_folder_that_is_not_there_holds_nothing():
    assert specs_under(["/no/such/folder"]) == ()


@pytest.mark.parametrize("limit", ["MOST_ENTRIES", "MOST_SPECS"])
def test_a_folder_with_too_many_files_is_refused(tmp_path, monkeypatch, limit):
    monkeypatch.setattr(folders, limit, 3)
    for i in range(4):
        (tmp_path / f"{i}.stl").write_text("")
    with pytest.raises(InputError, match="too many files"):
        specs_under([str(tmp_path)])


def test_meshes_and_what_is_no_file_are_passed_over(tmp_path):
    (tmp_path / "a.stl").write_bytes(b"\0" * 84 + b"rest")
    (tmp_path / "b.stl").write_text("solid part\n  facet normal 0 0 1\n")
    (tmp_path / "c.stl").symlink_to(tmp_path / "nowhere")
    os.mkfifo(tmp_path / "d.stl")
    (tmp_path / "e.stl").write_text("# solid ground\nsignal x\n")
    assert specs_under([str(tmp_path)]) == (str(tmp_path / "e.stl"),)
