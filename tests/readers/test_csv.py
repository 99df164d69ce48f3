import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.errors import DataError
from stlspec.readers.csv import read


@pytest.fixture
def load(tmp_path: Path):
    def load(text: str | bytes):
        file = tmp_path / "d.csv"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read(file)

    return load


def test_a_header_names_the_columns(load):
    (found,) = load("time, x ,ok\n0,1.5,true\n1,inf,FALSE\n")
    assert found.time.tolist() == [0, 1]
    assert found.columns["x"].tolist() == [1.5, math.inf] and found.columns["x"].dtype == np.float64
    assert found.columns["ok"].tolist() == [True, False] and found.columns["ok"].dtype == np.bool_
    assert (found.name, found.states, found.actions, found.env, found.episode) == (None,) * 5


@pytest.mark.parametrize("text", ["x,y\r\n1,2\r\n", "\ufeffx,y\n1,2", "x,y\n\n1,2\n\n\n", '"x","y"\n"1","2"\n'])
def test_line_ends_blank_lines_and_quotes_do_not_matter(load, text):
    (found,) = load(text)
    assert {k: v.tolist() for k, v in found.columns.items()} == {"x": [1], "y": [2]}


@given(values=st.lists(st.floats(), min_size=1))
def test_numbers_keep_every_bit(values, tmp_path_factory):
    file = tmp_path_factory.mktemp("csv") / "d.csv"
    file.write_text("x\n" + "".join(f"{v!r}\n" for v in values))
    np.testing.assert_array_equal(read(file)[0].columns["x"], values)


@given(
    rows=st.lists(
        st.tuples(*[st.sampled_from(["1", " 2.5", "inf", "-nan", "", "true", "x", '"3"', "1_0"])] * 2), min_size=1
    )
)
def test_reading_all_at_once_changes_nothing(rows, tmp_path_factory):
    file = tmp_path_factory.mktemp("csv") / "d.csv"
    body = "".join(f"{a},{b}\n" for a, b in rows)
    file.write_text("x,y\n" + body)
    fast = read(file)[0].columns
    # A column of actions keeps a file from being converted at once.
    file.write_text("x,y,action\n" + "".join(f"{a},{b},{k or ''}\n" for k, (a, b) in enumerate(rows)))
    slow = read(file)[0].columns
    assert {k: repr(v) for k, v in fast.items()} == {k: repr(v) for k, v in slow.items()}


def test_an_empty_cell_is_a_hole(load):
    (found,) = load("x,y\n1,2\n,3\n")
    assert math.isnan(found.columns["x"][1]) and found.columns["x"].dtype == np.float64


def test_words_stay_words_for_the_trace_to_refuse(load):
    (found,) = load("x\n1\nfast\n")
    assert found.columns["x"].tolist() == [1.0, "fast"]


def test_an_underscore_makes_no_number(load):
    (found,) = load("x\n1_0\n")
    assert found.columns["x"].tolist() == ["1_0"]


def test_an_underscore_in_a_name_does_no_harm(load):
    (found,) = load("d_obs\n2\n")
    assert found.columns["d_obs"].tolist() == [2] and found.columns["d_obs"].dtype == np.float64


def test_other_line_separators_of_unicode_end_no_row(load):
    (found,) = load("x,note\n1,a\u2028b\x0bc\n")
    assert found.columns["note"].tolist() == ["a\u2028b\x0bc"]


def test_episodes_come_in_the_order_in_which_they_begin(load):
    found = load("episode,x\n7,1\n3,2\n7,3\n")
    assert [(f.episode, f.columns["x"].tolist()) for f in found] == [("7", [1, 3]), ("3", [2])]


def test_a_single_episode_needs_no_number(load):
    (found,) = load("episode,x\n7,1\n7,3\n")
    assert found.episode is None and "episode" not in found.columns


def test_the_action_of_a_row_led_to_it(load):
    (found,) = load("x,action\n1,\n2,3\n3,0.5\n4,left\n")
    assert found.actions == (3, 0.5, "left") and type(found.actions[0]) is int
    assert "action" not in found.columns


def test_every_episode_begins_without_an_action(load):
    found = load("episode,x,action\n0,1,\n0,1,2\n1,1,\n1,1,3\n")
    assert [f.actions for f in found] == [(2,), (3,)]


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("", "D833", "header"),
        ("\n\n", "D833", "header"),
        ("x,y\n", "D803", "header and nothing else"),
        ("x,y\n1,2\n1,2,3\n", "D834", "line 3 has 3 columns, but the header has 2"),
        ("x,y\n1,2\n\n1\n", "D834", "line 4 has 1 column, but"),
        ('x,y\n"a\nb",2\n1\n', "D834", "line 4"),
        ("x;y\n1;2,5\n", "D835", "separated by semicolons"),
        ("x;y\n1;2\n", "D835", "separated by semicolons"),
        ("x\ty\n1\t2\n", "D835", "separated by tabs"),
        ("x,y,x\n1,2,3\n", "D835", "column 'x' twice"),
        ("x, x\n1,2\n", "D835", "column 'x' twice"),
        (",x\n0,2\n", "D835", "column 1 of the header has no name"),
        ("0,1\n1,2\n", "D835", "numbers, not names"),
        ('x\n"1\n2\n', "D836", "line 3"),
        ('x\n"1"2\n', "D836", "line 2"),
        ("x\n" + "a" * 200_000 + "\n", "D836", "field larger than field limit"),
        (b"x\n\xff\n", "D832", "line 2"),
        (b"\x89PNG\r\n\x1a\n\0\0", "D832", "not UTF-8"),
        ("x,action\n1,2\n2,3\n", "D840", "first row of an episode has the action '2'"),
        ("x,action\n1,\n2,3\n3,\n", "D840", "sample 2 of an episode has no action"),
    ],
)
def test_a_file_that_cannot_be_used_is_one_diagnostic(load, text, code, words, tmp_path):
    with pytest.raises(DataError) as error:
        load(text)
    (found,) = error.value.diagnostics
    assert found.code == code
    assert words in str(error.value)
    assert found.file == str(tmp_path / "d.csv")


@given(text=st.text(max_size=60))
def test_any_text_is_read_or_refused(text, tmp_path_factory):
    file = tmp_path_factory.mktemp("csv") / "d.csv"
    file.write_text(text, encoding="utf-8", newline="")
    try:
        for recording in read(file):
            assert recording.n_samples > 0
    except DataError as error:
        assert all(d.file == str(file) for d in error.diagnostics)


def test_a_wide_header_is_checked_quickly(load):
    names = [f"s{k}" for k in range(50_000)]
    (found,) = load(",".join(names) + "\n" + ",".join("1" * 50_000) + "\n")
    assert len(found.columns) == 50_000


@pytest.mark.parametrize("rest", ["1", "true", "fast"])
def test_whole_time_stamps_keep_every_nanosecond(load, rest):
    (recording,) = load(f"x,time\n{rest},1700000000123456789\n{rest},1700000000123456790\n")
    assert recording.time.dtype == np.int64
    assert recording.time.tolist() == [1700000000123456789, 1700000000123456790]


@pytest.mark.parametrize("stamp", ["1.5", "1e18", "9" * 30])
@pytest.mark.parametrize("rest", ["1", "true"])
def test_other_time_stamps_are_floats(load, stamp, rest):
    (recording,) = load(f"time,x\n0,{rest}\n{stamp},{rest}\n")
    assert recording.time.tolist() == [0, float(stamp)]
