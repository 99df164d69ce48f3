"""The command check: what is selected, what it exits with, and what it prints for programs."""

import json
import subprocess
import sys

import pytest

from stlspec.cli.main import run

TEXT = "signal x in [0, 10]\nsignal y\nhard a: always (x < 12)\n"


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "a.stl"
    path.write_text(TEXT)
    return path


def test_warnings_are_selected_on_the_command_line(spec, capsys):
    assert run(["check", str(spec)]) == 0
    assert "2 warnings in 1 file" in capsys.readouterr().out
    assert run(["check", str(spec), "--ignore", "L603,L615"]) == 0
    assert "nothing to report" in capsys.readouterr().out
    assert run(["check", str(spec), "--select", "L615"]) == 0
    assert "1 warning in 1 file" in capsys.readouterr().out
    assert run(["check", str(spec), "--deny", "warning"]) == 1
    assert "2 errors in 1 file" in capsys.readouterr().out


def test_settings_of_the_project_hold(spec, capsys):
    settings = spec.with_name("pyproject.toml")
    settings.write_text('[tool.stlspec]\nignore = ["L6"]\n')
    assert run(["check", str(spec)]) == 0
    assert "nothing to report" in capsys.readouterr().out
    settings.write_text('[tool.stlspec]\nignore = ["E501"]\n')
    assert run(["check", str(spec), "--format", "json"]) == 2
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "stlspec.error/1" and document["diagnostics"][0]["code"] == "S094"


def test_sarif_and_github_have_the_exit_code_of_the_text(spec, capsys):
    assert run(["check", str(spec), "--format", "sarif", "--deny", "warning"]) == 1
    log = json.loads(capsys.readouterr().out)
    assert [r["level"] for r in log["runs"][0]["results"]] == ["error", "error"]
    assert run(["check", str(spec), "--format", "github"]) == 0
    assert [line[:9] for line in capsys.readouterr().out.splitlines()] == ["::warning", "::warning"]


def test_a_failing_run_is_a_sarif_log_too(tmp_path, capsys):
    assert run(["check", str(tmp_path / "missing.stl"), "--format", "sarif"]) == 2
    (result,) = json.loads(capsys.readouterr().out)["runs"][0]["results"]
    assert result["ruleId"] == "S092"


def test_demos_take_every_path_up_to_the_next_option(spec, tmp_path, capsys):
    spec.write_text("signal x\nparam T\nhard a: always[0, T] (x > 0)\n")
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("x\n1\n2\n")
    demos = ["--demos", str(tmp_path / "a.csv"), str(tmp_path / "b.csv")]
    assert run(["check", str(spec), *demos, "-p", "T=5"]) == 0
    assert "further than 2 of 2 demonstrations" in capsys.readouterr().out
    assert run(["check", str(spec), *demos]) == 2
    assert "N106" in capsys.readouterr().out


def test_a_signal_that_demonstrations_lack_is_an_error_beside_the_others(spec, tmp_path, capsys):
    spec.write_text("signal alt\nhard a: always (alt > 0)\nhard b: alt > 1\n")
    (tmp_path / "a.csv").write_text("altitude\n1\n2\n")
    assert run(["check", str(spec), "--demos", str(tmp_path / "a.csv"), "--format", "json"]) == 1
    codes = [found["code"] for found in json.loads(capsys.readouterr().out)["diagnostics"]]
    assert sorted(codes) == ["D804", "L620"]


@pytest.mark.parametrize("output", ["text", "json", "sarif", "github"])
def test_no_format_loads_anything_heavy(spec, output):
    code = (
        "import sys\nfrom stlspec.cli.main import run\n"
        f"run(['check', {str(spec)!r}, '--format', {output!r}])\n"
        "assert not {'numpy', 'networkx', 'gymnasium', 'matplotlib'} & sys.modules.keys()"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
