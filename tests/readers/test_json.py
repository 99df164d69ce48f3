from pathlib import Path

import pytest

from stlspec.errors import DataError
from stlspec.readers.json import read


@pytest.fixture
def load(tmp_path: Path):
    def load(text: str):
        (tmp_path / "d.json").write_text(text, encoding="utf-8")
        return read(tmp_path / "d.json")

    return load


def test_a_file_holds_one_demonstration(load):
    (found,) = load('\ufeff{"signals": {"x": [1, 2]}}')
    assert found.columns["x"].tolist() == [1, 2] and found.episode is None


def test_a_list_holds_several_numbered_from_zero(load):
    found = load('[{"states": [0]}, {"states": [1], "name": "b"}]')
    assert [(f.states, f.episode, f.name) for f in found] == [((0,), "0", None), ((1,), "1", "b")]


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("", "D833", "a demonstration object"),
        ("[]", "D803", "the list is empty"),
        ("[1]", "D837", "demonstration 0 is '1'"),
        ('[{"states": [0]}, {"states": 3}]', "D837", "'states' of demonstration 1"),
        ('{"states": [0', "D836", "cut off"),
    ],
)
def test_a_file_that_cannot_be_used_is_one_diagnostic(load, text, code, words, tmp_path):
    with pytest.raises(DataError) as error:
        load(text)
    (found,) = error.value.diagnostics
    assert (found.code, found.file) == (code, str(tmp_path / "d.json"))
    assert words in str(error.value)


def test_one_document_a_line_is_told_its_name(tmp_path):
    (tmp_path / "d.json").write_text('{"states": [0]}\n{"states": [1]}\n')
    with pytest.raises(DataError) as error:
        read(tmp_path / "d.json")
    (found,) = error.value.diagnostics
    assert (found.code, found.help) == ("D836", "name it `d.jsonl`") and "each line" in found.message
