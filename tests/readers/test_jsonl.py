from pathlib import Path

import pytest

from stlspec.errors import DataError
from stlspec.readers.jsonl import read


@pytest.fixture
def load(tmp_path: Path):
    def load(text: str):
        (tmp_path / "d.jsonl").write_text(text, encoding="utf-8", newline="")
        return read(tmp_path / "d.jsonl")

    return load


def test_every_line_is_a_demonstration(load):
    found = load('{"states": [0]}\r\n\n{"states": [1], "name": "a\u2028b"}\n')
    assert [(f.states, f.episode, f.name) for f in found] == [((0,), "0", None), ((1,), "1", "a\u2028b")]


def test_a_single_line_needs_no_number(load):
    assert load('{"states": [0]}')[0].episode is None


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("", "D833", "one demonstration object a line"),
        (" \n\n", "D803", "all lines are blank"),
        ('{"states": [0]}\n\n{"states": [0}\n', "D836", "line 3, column"),
        ('{"states": [0]}\n[1]\n', "D837", "line 2 is a list"),
    ],
)
def test_a_file_that_cannot_be_used_is_one_diagnostic(load, text, code, words, tmp_path):
    with pytest.raises(DataError) as error:
        load(text)
    (found,) = error.value.diagnostics
    assert (found.code, found.file) == (code, str(tmp_path / "d.jsonl"))
    assert words in str(error.value)


@pytest.mark.parametrize("text", ['{\n "states": [0]\n}\n', '[\n {"states": [0]},\n {"states": [1]}\n]\n'])
def test_one_document_over_several_lines_is_told_its_name(load, text):
    with pytest.raises(DataError) as error:
        load(text)
    (found,) = error.value.diagnostics
    assert (found.code, found.help) == ("D836", "name it `d.json`") and "one JSON document" in found.message


def test_a_line_with_a_key_twice_is_no_other_format(load):
    with pytest.raises(DataError, match="comes twice"):
        load('{"states": [0], "states": [1]}')
