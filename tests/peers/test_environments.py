"""Environments are made once, and a failed installation is told in one line."""

import subprocess
from types import SimpleNamespace

import pytest

from tests.peers import environments


@pytest.fixture
def pip(monkeypatch, tmp_path):
    """Replace making environments and pip; count what is asked of them."""
    calls = []

    def create(folder, **_):
        (folder / "bin").mkdir(parents=True)
        (folder / "bin" / "python").touch()

    def run(command, **_):
        calls.append(command)
        return SimpleNamespace(returncode=pip.returncode, stderr="noise\nERROR: no matching version\n")

    pip = SimpleNamespace(calls=calls, returncode=0, work=tmp_path)
    monkeypatch.setattr(environments.venv, "create", create)
    monkeypatch.setattr(environments.subprocess, "run", run)
    return pip


def test_an_environment_is_made_once(pip):
    first = environments.environment("rtamt", pip.work)
    assert environments.environment("rtamt", pip.work) == first
    assert len(pip.calls) == 1
    assert pip.calls[0][-2:] == ["rtamt==0.4.10", "numpy"]


def test_a_failed_installation_is_told_in_one_line_and_tried_again(pip):
    pip.returncode = 1
    with pytest.raises(environments.NotInstalledError, match=r"^ERROR: no matching version$"):
        environments.environment("rtamt", pip.work)
    assert not (pip.work / "rtamt" / "installed.txt").exists()


def test_pip_may_not_hang(pip, monkeypatch):
    def hang(command, **_):
        raise subprocess.TimeoutExpired(command, 900)

    monkeypatch.setattr(environments.subprocess, "run", hang)
    with pytest.raises(environments.NotInstalledError, match="900 s"):
        environments.environment("rtamt", pip.work)


def test_nothing_is_installed_inside_the_repository():
    assert "stlspec-peers" in environments.default_work().parts
    assert not environments.default_work().is_relative_to(environments.Path(__file__).parents[2])
