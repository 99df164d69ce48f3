"""Options shared by commands are read as they are meant."""

import pytest

from stlspec.cli.main import run
from stlspec.cli.options import expand_many, read_params
from stlspec.errors import UsageError


@pytest.mark.parametrize("words", ["score s.stl -", "monitor s.stl", "fmt -", "lsp"])
def test_closed_stdin_is_said(words, tmp_path, monkeypatch, capsys):
    if words == "lsp":
        pytest.importorskip("pygls")
    (tmp_path / "s.stl").write_text("signal x\nhard a: always (x > 0)\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.stdin", None)
    assert run(words.split()) == 2
    out, err = capsys.readouterr()
    assert "error[D880]: stdin is closed" in err
    assert out == ""


@pytest.mark.parametrize(
    ("words", "expanded"),
    [
        ("--demos a b --out d", "--demos a --demos b --out d"),
        ("--demos a --demos b", "--demos a --demos b"),
        ("s --demos a b", "s --demos a --demos b"),
        ("--demos", "--demos"),
        ("--demos --out d", "--demos --out d"),
        ("--out d x", "--out d x"),
        ("--demos a -p T=1 b", "--demos a -p T=1 b"),
    ],
)
def test_demos_takes_every_path_up_to_the_next_option(words: str, expanded: str) -> None:
    assert expand_many(words.split()) == expanded.split()


def test_the_last_value_of_a_param_counts() -> None:
    assert read_params(["T=1", "T = 2", "x="]) == {"T": "2", "x": ""}
    assert read_params(None) == {}


@pytest.mark.parametrize("text", ["T", "=3", ""])
def test_a_param_without_name_or_value_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="D880"):
        read_params([text])
