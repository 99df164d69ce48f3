"""fmt: files written whole or not at all, with what they had of mode, marks and line ends."""

import io
import json
import sys

import pytest

from stlspec.cli.main import run

UGLY, NEAT = "signal x\nhard a: G x>1 # c\n", "signal x\nhard a:\n    always (x > 1)  # c\n"


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "x.stl"
    path.write_text(UGLY)
    return path


def test_a_file_is_written_once_and_then_left(spec, capsys):
    spec.chmod(0o640)
    assert run(["fmt", str(spec)]) == 0
    assert spec.read_text() == NEAT
    assert spec.stat().st_mode & 0o777 == 0o640
    assert "1 file reformatted" in capsys.readouterr().out
    stamp = spec.stat().st_mtime_ns
    assert run(["fmt", str(spec)]) == 0
    assert spec.stat().st_mtime_ns == stamp


def test_check_and_diff_write_nothing(spec, capsys):
    assert run(["fmt", "--check", str(spec)]) == 1
    assert run(["fmt", "--diff", str(spec)]) == 0
    out = capsys.readouterr().out
    assert "+    always (x > 1)  # c\n" in out
    assert run(["fmt", "--diff", "--check", str(spec)]) == 1
    assert spec.read_text() == UGLY
    spec.write_text(NEAT)
    assert run(["fmt", "--check", "--diff", str(spec)]) == 0


@pytest.mark.parametrize(("before", "after"), [(b"\xef\xbb\xbf", b"\xef\xbb\xbf"), (b"", b"")])
def test_marks_and_line_ends_stay(spec, before, after):
    spec.write_bytes(before + UGLY.replace("\n", "\r\n").encode())
    assert run(["fmt", str(spec)]) == 0
    assert spec.read_bytes() == after + NEAT.replace("\n", "\r\n").encode()


def test_a_file_with_errors_is_left_alone_and_stops_no_other(spec, tmp_path, capsys):
    broken = tmp_path / "broken.stl"
    broken.write_text("hard a: (x > 1\n")
    assert run(["fmt", str(broken), str(spec)]) == 1
    assert "S004" in capsys.readouterr().err
    assert (broken.read_text(), spec.read_text()) == ("hard a: (x > 1\n", NEAT)
    assert run(["fmt", str(broken), str(tmp_path / "missing.stl")]) == 2


def stdin(monkeypatch, data):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))


def test_stdin_comes_out_on_stdout(monkeypatch, capsys):
    stdin(monkeypatch, UGLY.encode())
    assert run(["fmt", "-"]) == 0
    assert capsys.readouterr().out == NEAT
    stdin(monkeypatch, b"hard a: (")
    assert run(["fmt", "-"]) == 1
    assert capsys.readouterr().out == ""


def test_stdin_stands_alone_and_is_bounded(monkeypatch, capsys, spec):
    assert run(["fmt", "-", str(spec)]) == 2
    stdin(monkeypatch, b"# " + b"x" * (16 * 2**20))
    assert run(["fmt", "-"]) == 2
    assert "S093" in capsys.readouterr().err


def test_json_is_one_document(spec, capsys):
    assert run(["fmt", "--check", "--format", "json", str(spec)]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document == {"schema": "stlspec.fmt/1", "files": [{"file": str(spec), "changed": True, "diagnostics": []}]}


def test_names_of_used_files_are_names(spec, tmp_path):
    (tmp_path / "common.stl").write_text("signal G\nsignal t\n")
    spec.write_text('use "common.stl"\nhard a: G>t\n')
    assert run(["fmt", str(spec)]) == 0
    assert spec.read_text() == 'use "common.stl"\nhard a:\n    G > t\n'
    spec.write_text('use "lost.stl"\nhard a: G>t\n')
    assert run(["fmt", str(spec)]) == 1
    assert spec.read_text() == 'use "lost.stl"\nhard a: G>t\n'


def test_bundles_are_refused(tmp_path, spec, capsys):
    bundle = tmp_path / "x.stlb"
    assert run(["compile", str(spec), "-o", str(bundle)]) == 0
    assert run(["fmt", str(bundle)]) == 2
    assert "compiled bundle" in capsys.readouterr().err


def test_a_patch_says_where_the_last_line_has_no_end(spec, capsys):
    spec.write_text(NEAT.removesuffix("\n"))
    assert run(["fmt", "--diff", str(spec)]) == 0
    assert "\\ No newline at end of file" in capsys.readouterr().out
