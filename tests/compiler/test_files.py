"""Files that hold a spec or a bundle, and files that hold neither."""

import os
import struct
import sys
from pathlib import Path

import pytest

from stlspec.compiler import bundle_file, files
from stlspec.compiler.compiling import compile_source
from stlspec.compiler.files import (
    looks_like_bundle,
    read_bundle,
    read_bytes,
    read_source,
    read_spec,
    read_used,
    write_bytes,
)
from stlspec.errors import BundleError, InputError, SpecError, UsageError
from stlspec.source import SourceText

SPEC = "signal d\nhard safe: always (d > 1)\n"
ASCII_MESH = b"solid cube\n  facet normal 0 0 1\n    outer loop\n"
EMPTY_MESH = b"  SOLID cube\nendsolid cube\n"
BINARY_MESH = b"binary".ljust(80, b"\0") + struct.pack("<I", 2) + b"\0" * 100


def code_of(kind, action, *arguments):
    """The one code of the error that an action raises."""
    with pytest.raises(kind) as caught:
        action(*arguments)
    assert type(caught.value) is kind
    (problem,) = caught.value.diagnostics
    assert problem.file is not None
    return problem.code


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (ASCII_MESH, "S090"),
        (EMPTY_MESH, "S090"),
        (BINARY_MESH, "S090"),
        (b"signal d\xff", "S091"),
        (SPEC.encode("utf-16"), "S091"),
        (b"signal d\0\n", "S091"),
        (b"\0" * 10, "S091"),
    ],
)
def test_what_is_no_text_of_a_spec_is_an_input_error(tmp_path, data, code):
    path = tmp_path / "x.stl"
    path.write_bytes(data)
    assert code_of(InputError, read_source, path) == code
    assert code_of(InputError, read_spec, path) == code


@pytest.mark.parametrize("data", [b"", b"\n \n", b"# nothing\n", b"\xef\xbb\xbf"])
def test_an_empty_spec_is_a_spec_with_an_error(tmp_path, data):
    path = tmp_path / "x.stl"
    path.write_bytes(data)
    assert code_of(SpecError, read_spec, path) == "S016"


def test_a_missing_file_a_folder_and_a_bad_path_are_input_errors(tmp_path):
    for path in (tmp_path / "none.stl", tmp_path, "a\0b", tmp_path / ("x" * 5000)):
        assert code_of(InputError, read_source, path) == "S092"


@pytest.mark.skipif(sys.platform == "win32" or os.geteuid() == 0, reason="permissions do not bind here")
def test_a_file_without_permission_is_an_input_error(tmp_path):
    path = tmp_path / "x.stl"
    path.write_text(SPEC)
    path.chmod(0)
    assert code_of(InputError, read_source, path) == "S092"


def test_a_file_too_large_is_refused_with_its_size(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "LARGEST_SPEC", 20)
    path = tmp_path / "x.stl"
    path.write_text(SPEC)
    assert code_of(InputError, read_spec, path) == "S093"
    with pytest.raises(InputError) as caught:
        read_bytes(path, 10)
    assert f"{len(SPEC)} bytes" in caught.value.diagnostics[0].message


def test_a_spec_is_read_with_its_path_as_name_whatever_its_line_ends(tmp_path):
    path = tmp_path / "x.stl"
    path.write_bytes(b"\xef\xbb\xbfsignal d\r\nhard safe: always (d > 1)\r")
    source = read_source(path)
    assert (source.name, source.text) == (str(path), "signal d\r\nhard safe: always (d > 1)\n")


def test_a_spec_that_speaks_of_solids_is_no_mesh(tmp_path):
    path = tmp_path / "x.stl"
    path.write_text("# solid facet endsolid\n" + SPEC)
    assert read_spec(path).requirements[0].name == "safe"


def test_a_bundle_is_loaded_wherever_a_spec_is_taken(tmp_path):
    bundle = compile_source(SourceText.of("x.stl", SPEC))
    path = tmp_path / "x.stlb"
    write_bytes(path, bundle_file.dump(bundle))
    assert read_spec(path) == read_bundle(path) == bundle
    assert code_of(UsageError, read_spec, path, {"T": 1}) == "B705"
    path.write_bytes(b"{}")
    assert code_of(BundleError, read_spec, path) == "B701"


def test_a_bundle_is_known_by_its_extension_or_its_first_character():
    assert looks_like_bundle("x.stlb", b"anything")
    assert looks_like_bundle("x.json", b'  {"schema"')
    assert not looks_like_bundle("x.stl", b"signal d")


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    path = tmp_path / "x.stlb"
    write_bytes(path, b"one")
    write_bytes(path, b"two")
    assert path.read_bytes() == b"two"
    assert [p.name for p in tmp_path.iterdir()] == ["x.stlb"]
    for wrong in (tmp_path / "none" / "x", tmp_path):
        assert code_of(InputError, write_bytes, wrong, b"three") == "S092"
    assert [p.name for p in tmp_path.iterdir()] == ["x.stlb"]


@pytest.mark.skipif(sys.platform == "win32", reason="modes are of POSIX")
def test_a_written_file_has_the_usual_permissions(tmp_path):
    umask = os.umask(0)
    os.umask(umask)
    write_bytes(tmp_path / "x", b"one")
    assert (tmp_path / "x").stat().st_mode & 0o777 == 0o666 & ~umask


def test_a_link_is_written_through_and_a_device_is_not_replaced(tmp_path: Path) -> None:
    real, link = tmp_path / "real", tmp_path / "link"
    real.write_bytes(b"old")
    link.symlink_to(real)
    files.write_bytes(link, b"new")
    assert (link.is_symlink(), real.read_bytes()) == (True, b"new")
    files.write_bytes("/dev/null", b"gone")
    assert not Path("/dev/null").is_file()


def test_a_spec_file_uses_files_beside_it_and_its_bundle_reads_none(tmp_path, monkeypatch):
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "signals.stl").write_text("signal d\nparam r = 1\n")
    (tmp_path / "spec.stl").write_text('use "lib/signals.stl"\nhard safe: always (d > r)\n')
    (tmp_path / "one.stl").write_text("signal d\nparam r = 1\nhard safe: always (d > r)\n")
    split = read_spec(tmp_path / "spec.stl", {"r": 2})
    assert bundle_file.meaning_sha256(split) == bundle_file.meaning_sha256(read_spec(tmp_path / "one.stl", {"r": 2}))
    monkeypatch.chdir(tmp_path)
    for way in ("spec.stl", "./spec.stl", "lib/../spec.stl", tmp_path / "spec.stl"):
        assert bundle_file.dump(read_spec(way, {"r": 2})) == bundle_file.dump(split)
    assert [name for name, _ in bundle_file.load(bundle_file.dump(split)).sources] == ["spec.stl", "lib/signals.stl"]
    (tmp_path / "lib" / "signals.stl").write_text("signal d\nparam r = 1  # another text\n")
    changed = read_spec(tmp_path / "spec.stl", {"r": 2})
    assert bundle_file.meaning_sha256(changed) == bundle_file.meaning_sha256(split)
    assert bundle_file.source_sha256(changed) != bundle_file.source_sha256(split)
    data = bundle_file.dump(split)
    (tmp_path / "lib" / "signals.stl").unlink()
    assert bundle_file.load(data).requirements[0].name == "safe"


def test_a_used_file_is_a_regular_file_with_the_text_of_a_spec(tmp_path):
    bundle = tmp_path / "b.stlb"
    bundle.write_bytes(bundle_file.dump(compile_source(SourceText.of("s", SPEC))))
    assert code_of(InputError, read_used, str(bundle)) == "B706"
    assert code_of(InputError, read_used, str(tmp_path)) == "S092"
    assert code_of(InputError, read_used, "a" * 5000) == "S092"
    os.mkfifo(tmp_path / "pipe")
    assert code_of(InputError, read_used, str(tmp_path / "pipe")) == "S092"
    (tmp_path / "mesh.stl").write_bytes(ASCII_MESH)
    assert code_of(InputError, read_used, str(tmp_path / "mesh.stl")) == "S090"
