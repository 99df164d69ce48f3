"""Parquet files as recordings: only the wanted columns, whole stamps with their unit, holes as NaN."""

import datetime
import math

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from stlspec.errors import DataError
from stlspec.readers import parquet
from stlspec.readers.registry import read_recordings


def file(tmp_path, **columns):
    path = tmp_path / "log.parquet"
    pq.write_table(pa.table(columns), path, row_group_size=2)
    return path


def code(call, *arguments):
    with pytest.raises(DataError) as error:
        call(*arguments)
    return error.value.diagnostics[0].code


def test_columns_are_signals(tmp_path):
    (found,) = read_recordings(file(tmp_path, time=[0.0, 0.5, 1.5], x=[1, 2, 3], on=[True, False, True]))
    assert found.time.tolist() == [0, 0.5, 1.5]
    assert found.columns["x"].tolist() == [1, 2, 3]
    assert found.columns["x"].dtype == np.float64
    assert found.columns["on"].dtype == np.bool_
    assert found.time_unit is None


def test_only_the_wanted_columns_are_read(tmp_path, monkeypatch):
    path = file(tmp_path, time=[0, 1], **{f"x{i}": [i, i] for i in range(50)})
    asked = []
    plain = pq.ParquetFile.read
    monkeypatch.setattr(
        pq.ParquetFile, "read", lambda self, columns: asked.append(columns) or plain(self, columns=columns)
    )
    (found,) = read_recordings(path, columns={"x7", "absent"})
    assert asked == [["time", "x7"]]
    assert list(found.columns) == ["x7"]
    assert len(found.others) == 49


def test_a_spec_without_signals_still_learns_the_number_of_samples(tmp_path):
    (found,) = parquet.read(file(tmp_path, x=[1, 2, 3]), columns=[])
    assert found.n_samples == 3


def test_holes_are_nan_and_kinds_of_numbers_do_not_matter(tmp_path):
    (found,) = parquet.read(
        file(
            tmp_path,
            x=pa.array([1, None, 3], pa.int32()),
            y=pa.array([None, 0.5, 1], pa.float32()),
            on=[True, None, False],
            nothing=pa.nulls(3),
            big=pa.array([2**63, 1, 0], pa.uint64()),
            exact=pa.array([1, 2, 3]).cast(pa.decimal128(30, 2)),
        )
    )
    shown = {name: [None if v != v else v for v in column.tolist()] for name, column in found.columns.items()}
    assert shown == {
        "x": [1, None, 3],
        "y": [None, 0.5, 1],
        "on": [True, None, False],
        "nothing": [None] * 3,
        "big": [2.0**63, 1, 0],
        "exact": [1, 2, 3],
    }


def test_stamps_of_a_time_type_stay_whole_and_bring_their_unit(tmp_path):
    begin = datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC)
    stamps = pa.array([begin, begin + datetime.timedelta(microseconds=3)], pa.timestamp("ns", "UTC"))
    (found,) = parquet.read(file(tmp_path, time=stamps, x=[1, 2]))
    assert found.time_unit == "ns"
    assert np.diff(found.time).tolist() == [3000]
    whole = pa.array([2**60, 2**60 + 1])
    assert parquet.read(file(tmp_path, time=whole, x=[1, 2]))[0].time.tolist() == [2**60, 2**60 + 1]


def test_a_missing_stamp_is_refused(tmp_path):
    assert code(parquet.read, file(tmp_path, time=[0.0, None], x=[1, 2])) == "D812"


def test_rows_belong_to_episodes_with_states_and_actions(tmp_path):
    path = file(
        tmp_path,
        episode=pa.array(["b", "a", "b", "a"]).dictionary_encode(),
        states=[[0, 0], [1, 1], [0, 1], [1, 2]],
        action=[None, None, 2, 1],
    )
    first, second = parquet.read(path, columns=[])
    assert (first.episode, first.states, first.actions) == ("b", ([0, 0], [0, 1]), (2,))
    assert (second.episode, second.states, second.actions) == ("a", ([1, 1], [1, 2]), (1,))


@pytest.mark.parametrize("action", [[1, 2], [None, None]])
def test_the_first_row_alone_has_no_action(tmp_path, action):
    assert code(parquet.read, file(tmp_path, x=[1, 2], action=action)) == "D840"


def test_what_is_no_signal_is_refused_only_if_it_is_wanted(tmp_path):
    path = file(tmp_path, x=[1, 2], where=[[1.0], [2.0]])
    assert code(parquet.read, path) == "D837"
    assert parquet.read(path, columns={"x"})[0].columns["x"].tolist() == [1, 2]


def test_words_are_left_for_the_evaluation_to_refuse(tmp_path):
    (found,) = parquet.read(file(tmp_path, x=["fast", None]))
    assert found.columns["x"].tolist()[0] == "fast"
    assert math.isnan(found.columns["x"].tolist()[1])


@pytest.mark.parametrize("content", [b"", b"PAR1", b"PAR1" * 100, b"\0" * 64])
def test_a_broken_file_is_one_diagnostic(tmp_path, content):
    path = tmp_path / "broken.parquet"
    path.write_bytes(content)
    assert code(read_recordings, path) in ("D833", "D836")


def test_every_cut_of_a_file_is_refused(tmp_path):
    whole = file(tmp_path, x=[1.0, 2.0], time=[0, 1]).read_bytes()
    path = tmp_path / "cut.parquet"
    for end in range(1, len(whole), 37):
        path.write_bytes(whole[:end])
        assert code(parquet.read, path) == "D836"


def test_no_rows_and_no_file_are_refused(tmp_path):
    assert code(parquet.read, file(tmp_path, x=pa.array([], pa.float64()))) == "D803"
    assert code(parquet.read, tmp_path / "missing.parquet") == "D830"
    assert code(parquet.read, tmp_path) == "D830"


def test_a_column_that_comes_twice_is_refused(tmp_path):
    path = tmp_path / "twice.parquet"
    pq.write_table(pa.Table.from_arrays([pa.array([1]), pa.array([2])], names=["x", "x"]), path)
    assert code(parquet.read, path) == "D835"


def test_the_size_is_bounded_before_anything_is_read(tmp_path, monkeypatch):
    monkeypatch.setattr(parquet, "_NUMBERS_AT_MOST", 5)
    path = file(tmp_path, x=[1, 2, 3], y=[1, 2, 3])
    assert code(parquet.read, path) == "D838"
    assert parquet.read(path, columns={"x"})[0].n_samples == 3


def test_without_the_extra_the_way_out_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(DataError, match="not installed") as error:
        parquet.read(tmp_path / "log.parquet")
    assert "stlspec[parquet]" in error.value.diagnostics[0].help
