"""Blocks of a stream hold what a file of the same text holds."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.errors import DataError
from stlspec.readers import stream
from stlspec.readers.csv import read
from stlspec.readers.stream import CsvStream


def blocks(data, wanted=("x",)):
    return list(CsvStream(io.BytesIO(data), "in").blocks(frozenset(wanted)))


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(stream, "BLOCK_BYTES", 7)


@given(rows=st.lists(st.tuples(st.floats(), st.sampled_from(["true", "1", "", " 2 ", '"3"', "inf"])), min_size=1))
def test_columns_are_those_of_the_file(rows, tmp_path_factory):
    text = "x,y\n" + "".join(f"{x!r},{y}\n" for x, y in rows)
    file = tmp_path_factory.mktemp("stream") / "d.csv"
    file.write_text(text)
    (whole,) = read(file)
    found = blocks(text.encode(), ("x", "y"))
    for name in ("x", "y"):
        joined = [value for block in found for value in block.columns[name].tolist()]
        assert [float(v) for v in joined] == pytest.approx(
            [float(v) for v in whole.columns[name].tolist()], nan_ok=True
        )
        assert np.isnan([float(v) for v in joined]).tolist() == np.isnan(whole.columns[name].astype(float)).tolist()


@pytest.mark.parametrize(
    "text", ["x,y\r\n1,2\r\n3,4\r\n", "\ufeffx,y\n1,2\n3,4", "\n\nx,y\n\n1,2\n\n3,4\n\n", '"x",y\n"1",2\n3,"4"\n']
)
@pytest.mark.parametrize("size", [1, 7, 2**20])
def test_line_ends_blank_lines_quotes_and_cuts_do_not_matter(text, size, monkeypatch):
    monkeypatch.setattr(stream, "BLOCK_BYTES", size)
    found = blocks(text.encode(), ("x", "y"))
    assert [v for b in found for v in b.columns["x"].tolist()] == [1, 3]
    assert [v for b in found for v in b.columns["y"].tolist()] == [2, 4]
    assert sum(b.n_samples for b in found) == 2


@pytest.mark.parametrize("size", [3, 2**20])
@pytest.mark.parametrize(("text", "count"), [(b"x\r\n\r\n", 0), (b"x\r\n1\r\n\r\n\r\n", 1), (b"x\r\n\r\n\n2\r\n", 1)])
def test_blank_lines_of_one_column_are_no_samples(text, count, size, monkeypatch):
    """`\\r` alone looks like a value; a block of nothing else must not come out as one without samples."""
    monkeypatch.setattr(stream, "BLOCK_BYTES", size)
    found = [block.n_samples for block in blocks(text)]
    assert sum(found) == count
    assert 0 not in found


def test_whole_stamps_beyond_floats_stay_whole(small):
    stamps = [2**60 + 1, 2**60 + 2, 2**60 + 4]
    found = blocks("".join(["time,x\n", *(f"{t},1\n" for t in stamps)]).encode())
    assert [t for b in found for t in b.time.tolist()] == stamps


def test_a_spec_without_signals_still_counts_samples():
    assert [b.n_samples for b in blocks(b"a,b\n1,2\n3,4\n", ())] == [2]


@pytest.mark.parametrize(
    ("data", "code", "told"),
    [
        (b"", "D833", "empty"),
        (b"\n \n", "D833", "empty"),
        (b"1,2\n3,4\n", "D835", "numbers"),
        (b"x,x\n1,2\n", "D835", "twice"),
        (b'{"x": 1}\n', "D836", "JSON"),
        (b"x,y\n1,2\n\n3,4,5\n", "D834", "line 4 has 3"),
        (b"x,y\n1,2\n3\n", "D834", "line 3 has 1"),
        (b'x,y\n1,2\n"3,4\n', "D836", "line 3"),
        (b"x,y\n1,\xff\n", "D832", "line 2"),
        (b"x,y\n1,2\n\0,3\n", "D832", "line 3"),
        (b"episode,x\na,1\nb,2\n", "D898", "'b' comes after episode 'a'"),
    ],
)
@pytest.mark.parametrize("size", [3, 2**20])
def test_what_cannot_be_used_is_refused_with_its_line(data, code, told, size, monkeypatch):
    monkeypatch.setattr(stream, "BLOCK_BYTES", size)
    with pytest.raises(DataError) as caught:
        blocks(data, ("x", "y"))
    (found,) = caught.value.diagnostics
    assert found.code == code and told in found.message and found.file == "in"


@pytest.mark.parametrize("data", [b"x" * 5000, b"x\n1\n" + b"1" * 5000 + b"\n"])
def test_lines_are_bounded(data, monkeypatch):
    monkeypatch.setattr(stream, "BLOCK_BYTES", 100)
    monkeypatch.setattr(stream, "LINE_AT_MOST", 1000)
    with pytest.raises(DataError, match="longer than 1,000 bytes"):
        blocks(data)


def test_one_episode_is_no_matter(small):
    assert [v for b in blocks(b"episode,x,action\na,1,\n a,2,0\n") for v in b.columns["x"].tolist()] == [1, 2]
