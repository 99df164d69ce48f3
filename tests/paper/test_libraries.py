"""Environments of their own: made whole or not at all, found again, and a clear word where there is no network."""

import os
import sys

import pytest

from stlspec.errors import UsageError
from stlspec.paper import libraries
from stlspec.paper.libraries import NotInstalledError, find, install


@pytest.fixture(autouse=True)
def alone(monkeypatch):
    """No package index can be reached, and what pip would read of this machine's settings does not count."""
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")


def package(folder):
    folder.mkdir()
    (folder / "pyproject.toml").write_text("[project]\nname='x'\nversion='1'\n")
    return folder


def test_an_environment_is_made_once_and_found_again(tmp_path, monkeypatch):
    asked = []
    monkeypatch.setattr(libraries, "_pip", lambda python, packages, seconds: asked.append(packages))
    target = tmp_path / "cache" / "one"
    assert find(target, ("x==1",)) is None
    python = install(target, ("x==1",))
    assert python.exists()
    assert install(target, ("x==1",)) == python == find(target, ("x==1",))
    assert asked == [("x==1",)]
    assert find(target, ("x==2",)) is None
    install(target, ("x==2",))
    assert asked == [("x==1",), ("x==2",)]
    assert [path.name for path in target.parent.iterdir()] == ["one"]


def test_what_a_killed_installation_left_is_swept_away_when_nobody_can_be_at_work_on_it(tmp_path, monkeypatch):
    monkeypatch.setattr(libraries, "_pip", lambda python, packages, seconds: None)
    killed, at_work = tmp_path / ".one.12", tmp_path / ".one.13"
    for folder in (killed, at_work):
        (folder / "bin").mkdir(parents=True)
    os.utime(killed, (0, 0))
    install(tmp_path / "one", ("x==1",))
    assert sorted(path.name for path in tmp_path.iterdir()) == [".one.13", "one"]


def test_without_a_network_nothing_is_left_and_the_reason_is_told(tmp_path):
    with pytest.raises(NotInstalledError, match="No matching distribution found for imitation"):
        install(tmp_path / "one", ("imitation==1.0.1",), 120)
    assert list(tmp_path.iterdir()) == []


def test_an_installation_that_takes_too_long_is_given_up(tmp_path):
    with pytest.raises(NotInstalledError, match=r"pip took longer than 0\.01 s"):
        install(tmp_path / "one", ("imitation==1.0.1",), 0.01)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_no_traceback(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(NotInstalledError, match="file': File exists"):
        install(tmp_path / "file" / "one", ("x==1",))


def test_a_damaged_mark_is_no_environment(tmp_path):
    (tmp_path / "packages.txt").write_bytes(b"\xff\xfe")
    assert find(tmp_path, ("x==1",)) is None
    (tmp_path / "packages.txt").write_text(sys.version + "\nx==1")
    assert find(tmp_path, ("x==1",)) is None  # no interpreter beside it


def test_the_command_says_where_or_why_not(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(libraries, "_pip", lambda *_: None)
    assert libraries.main() == 0
    out, err = capsys.readouterr()
    assert out.strip() == str(tmp_path / "stlspec" / "mce-irl" / "bin" / "python")
    assert "about 2 GB" in err
    assert libraries.main() == 0
    assert capsys.readouterr().err == ""

    def refuse(*_):
        raise NotInstalledError("no network")

    monkeypatch.setattr(libraries, "MCE_IRL", ("imitation==9",))
    monkeypatch.setattr(libraries, "_pip", refuse)
    with pytest.raises(UsageError, match="cannot be installed: no network"):
        libraries.main()
