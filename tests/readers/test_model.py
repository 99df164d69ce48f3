import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.errors import DataError
from stlspec.readers.model import (
    Recording,
    checked,
    column_of,
    episode_rows,
    number_of_word,
    read_bytes,
    read_text,
    repeated,
    time_of,
)

FILE = Path("d.json")


def codes(error: pytest.ExceptionInfo[DataError]) -> list[str]:
    return [d.code for d in error.value.diagnostics]


@pytest.mark.parametrize(
    ("word", "value"),
    [("1", 1.0), (" -2.5 ", -2.5), ("1e3", 1000.0), ("inf", math.inf), ("-inf", -math.inf), ("true", True),
     ("FALSE", False), ("fast", "fast"), ("1_0", "1_0"), ("1,5", "1,5"), ("1e999", math.inf)],
)  # fmt: skip
def test_a_word_is_a_number_a_boolean_or_itself(word, value):
    found = number_of_word(word)
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize("word", ["nan", "NaN", "", "  "])
def test_a_hole_is_nan(word):
    assert math.isnan(number_of_word(word))


@given(st.floats(allow_nan=False))
def test_every_number_survives_its_text(value):
    assert number_of_word(repr(value)) == value


@pytest.mark.parametrize(
    ("values", "kind"),
    [([1, 2.5], "f"), ([True, False], "b"), ([True, 1], "O"), (["a", 1], "O"), ([], "f"), ([10**400, -1], "f")],
)
def test_a_column_is_of_numbers_or_of_booleans_or_left_alone(values, kind):
    column = column_of(values)
    assert column.dtype.kind == kind and column.shape == (len(values),)


def test_a_whole_number_beyond_all_floats_is_infinite():
    assert column_of([10**400, -(10**400), 3]).tolist() == [math.inf, -math.inf, 3]


def test_the_number_of_samples_is_the_length_of_any_part():
    assert Recording().n_samples == 0
    assert Recording(time=np.zeros(2)).n_samples == 2
    assert Recording(columns={"x": np.zeros(3)}).n_samples == 3
    assert Recording(states=((0, 0),)).n_samples == 1


def test_parts_of_unequal_length_are_all_named():
    wrong = Recording(time=np.zeros(3), columns={"x": np.zeros(3), "y": np.zeros(2)}, states=(1,))
    with pytest.raises(DataError) as error:
        checked(wrong, FILE)
    assert codes(error) == ["D805", "D805"]
    assert "'y' has 2 samples, but 'time' has 3" in str(error.value)
    assert "'states' has 1 sample" in str(error.value)


def test_there_is_one_action_less_than_samples():
    right = Recording(states=(0, 1), actions=(2,))
    assert checked(right, FILE) is right
    with pytest.raises(DataError, match="2 actions for 2 samples") as error:
        checked(Recording(states=(0, 1), actions=(2, 2)), FILE)
    assert codes(error) == ["D839"]


@pytest.mark.parametrize("empty", [Recording(), Recording(columns={"x": np.zeros(0)}), Recording(states=())])
def test_a_recording_has_samples(empty):
    with pytest.raises(DataError) as error:
        checked(empty, FILE)
    assert codes(error) == ["D803"]


def test_rows_are_grouped_by_episode_even_when_mixed():
    groups = episode_rows(["b", "a", " b", "a", "c"])
    assert [(label, rows.tolist()) for label, rows in groups] == [("b", [0, 2]), ("a", [1, 3]), ("c", [4])]


def test_the_first_repeated_name_is_found():
    assert repeated(["a", "b", "c", "b", "a"]) == "a"
    assert repeated(["a", "b"]) is None


def test_text_loses_its_byte_order_mark(tmp_path: Path):
    file = tmp_path / "x.csv"
    file.write_bytes(b"\xef\xbb\xbfx\n")
    assert read_text(file, "text") == "x\n"


@pytest.mark.parametrize(
    ("data", "code", "words"),
    [
        (None, "D830", "there is no such file"),
        (b"", "D833", "it should hold a poem"),
        (b"ab\nc\xff", "D832", "byte 4 (line 2) is 0xff"),
        (b"ab\0c", "D832", "byte 2 (line 1) is 0x00"),
    ],
)
def test_a_file_that_is_no_text_is_refused_with_its_place(tmp_path: Path, data, code, words):
    file = tmp_path / "x.csv"
    if data is not None:
        file.write_bytes(data)
    with pytest.raises(DataError) as error:
        read_text(file, "a poem")
    assert codes(error) == [code]
    assert words in str(error.value) and str(file) in str(error.value)
    assert error.value.exit_code == 2


def test_only_regular_files_are_read(tmp_path: Path):
    cases = ((tmp_path, "directory"), (Path("/dev/null"), "no regular file"), (Path("a\0b"), "no such file"))
    for path, words in cases:
        with pytest.raises(DataError, match=words) as error:
            read_bytes(path, "data")
        assert codes(error) == ["D830"]


def test_the_size_is_checked_before_reading(tmp_path: Path):
    file = tmp_path / "x.csv"
    file.write_bytes(b"12345")
    with pytest.raises(DataError, match="5 bytes, at most 4") as error:
        read_bytes(file, "data", 4)
    assert codes(error) == ["D838"]


def test_an_unreadable_file_is_refused(tmp_path: Path, monkeypatch):
    def denied(self):
        raise PermissionError(13, "Permission denied")

    file = tmp_path / "x.csv"
    file.write_bytes(b"x\n1\n")
    monkeypatch.setattr(Path, "read_bytes", denied)
    with pytest.raises(DataError, match="Permission denied") as error:
        read_bytes(file, "data")
    assert codes(error) == ["D830"]


def test_whole_time_stamps_stay_whole_if_they_fit():
    assert time_of([0, 2**63 - 1]).tolist() == [0, 2**63 - 1]
    assert time_of([0, 0.5]).dtype == time_of([0, 2**63]).dtype == np.float64
