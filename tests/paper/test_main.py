import subprocess
import sys

import pytest

from stlspec.paper import command
from stlspec.paper.__main__ import NAMES, main, parser
from stlspec.paper.experiments import EXPERIMENTS


def test_options_have_defaults():
    found = parser().parse_args([])
    assert (found.quick, found.fresh, found.figures, found.only, found.out) == (False, False, True, [], "paper-report")
    assert 1 <= found.jobs <= 8


@pytest.mark.parametrize("words", [["--jobs", "0"], ["--jobs", "x"], ["--jobs", "257"], ["--what"], ["more"]])
def test_options_that_are_none_end_with_2(words, capsys):
    with pytest.raises(SystemExit) as caught:
        main(words)
    assert caught.value.code == 2
    assert "usage:" in capsys.readouterr().err


def test_a_mistake_ends_with_a_diagnostic_and_2(tmp_path, capsys):
    assert main(["--only", "mars", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.startswith("error[D880]: there is no experiment 'mars'")


def test_a_stop_ends_with_130_and_says_how_to_go_on(monkeypatch, capsys):
    def stop(options):
        raise KeyboardInterrupt

    monkeypatch.setattr("stlspec.paper.command.run", stop)
    assert main([]) == 130
    assert "run it again" in capsys.readouterr().err


def test_help_names_what_can_be_asked_for():
    asked = {experiment.name for experiment in command.chosen(NAMES)}
    assert asked == set(EXPERIMENTS)
    words = parser().format_help().replace("\n", " ").split()
    assert {*NAMES} <= {word.strip(",.") for word in words}


def test_help_loads_nothing_heavy():
    code = (
        "import sys\nfrom stlspec.paper.__main__ import parser\nparser().format_help()\n"
        "print({'numpy', 'gymnasium', 'matplotlib'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
