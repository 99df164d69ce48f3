"""Rows as they come, and the same bytes after an interruption at any moment."""

import json

import pytest

from stlspec.errors import InputError, UsageError
from stlspec.many.journal import Journal


def me(files):
    return f"me {files}"


LINES = [[f'{{"file": {number}, "row": {row}}}' for row in range(number % 3)] for number in range(200)]


def written(out, identity=me):
    with Journal(out, identity) as journal:
        for lines in LINES[journal.files :]:
            journal.add(lines, failed=not lines)
        journal.finish()
    return out.read_bytes(), journal.files, journal.counts


def test_the_result_is_the_lines_in_their_order(tmp_path):
    out = tmp_path / "deep" / "scores.jsonl"
    data, files, counts = written(out)
    assert data.decode().splitlines() == [line for lines in LINES for line in lines]
    assert (files, counts) == (200, [199, 67])
    assert [p.name for p in out.parent.iterdir()] == ["scores.jsonl"]


@pytest.mark.parametrize("stop", [0, 1, 63, 64, 65, 199])
@pytest.mark.parametrize("torn", ["", '{"file": 9', "x\n" * 500])
def test_a_run_cut_off_anywhere_ends_in_the_same_bytes(tmp_path, stop, torn):
    whole = written(tmp_path / "whole.jsonl")
    out = tmp_path / "cut.jsonl"
    journal = Journal(out, me)
    for lines in LINES[:stop]:
        journal.add(lines, failed=not lines)
    # A kill leaves what the system has; the mark may be older, and the last line torn.
    journal._file.close()
    with journal.partial.open("a") as file:
        file.write(torn)
    assert not out.exists()
    assert written(out) == whole


def test_other_work_is_not_thrown_away(tmp_path):
    out = tmp_path / "scores.jsonl"
    with pytest.raises(KeyboardInterrupt), Journal(out, me) as journal:
        journal.add(["{}"], failed=False)
        raise KeyboardInterrupt
    before = journal.partial.read_bytes()
    with pytest.raises(UsageError) as error:
        Journal(out, lambda files: f"you {files}")
    assert error.value.diagnostics[0].code == "D849"
    assert journal.partial.read_bytes() == before


@pytest.mark.parametrize(
    "mark",
    ["", "[]", "{}", '{"schema": "stlspec.scores/1", "identity": "me", "files": -1, "bytes": 0, "counts": [0, 0]}'],
)
def test_a_damaged_mark_is_refused(tmp_path, mark):
    out = tmp_path / "scores.jsonl"
    (tmp_path / "scores.jsonl.resume").write_text(mark)
    with pytest.raises(UsageError):
        Journal(out, me)


def test_a_result_that_is_there_stays_until_the_new_one_is_whole(tmp_path):
    out = tmp_path / "scores.jsonl"
    out.write_text("old\n")
    with Journal(out, me) as journal:
        journal.add(["{}"], failed=False)
        assert out.read_text() == "old\n"
        journal.finish()
    assert out.read_text() == "{}\n"


def test_a_format_that_is_none_and_a_folder_that_cannot_be_are_refused(tmp_path):
    with pytest.raises(UsageError):
        Journal(tmp_path / "scores.xlsx", me)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError):
        Journal(tmp_path / "file" / "scores.jsonl", me)


def test_parquet_is_made_of_the_same_rows(tmp_path):
    import pyarrow.parquet as pq

    row = {
        "file": "a.csv",
        "name": "a.csv",
        "label": None,
        "reward": 0.5,
        "requirements": {
            "up": {"robustness": "-inf", "bounded": 0, "verdict": "violated", "vacuous": True, "witness": None},
            "far": {
                "robustness": 2,
                "bounded": 1.0,
                "verdict": "satisfied",
                "vacuous": False,
                "witness": {"sample": 3, "time": 0.3},
            },
        },
    }
    out = tmp_path / "scores.parquet"
    with Journal(out, me) as journal:
        journal.add([json.dumps(row)] * 3, failed=False)
        journal.finish()
    table = pq.read_table(out)
    assert table.num_rows == 3
    first = table.to_pylist()[0]
    assert (first["up.robustness"], first["up.witness_sample"]) == (float("-inf"), None)
    assert (first["far.robustness"], first["far.witness_sample"], first["far.witness_time"]) == (2.0, 3, 0.3)
    assert [p.name for p in tmp_path.iterdir()] == ["scores.parquet"]


def test_a_run_that_settled_nothing_leaves_nothing(tmp_path):
    out = tmp_path / "scores.jsonl"
    with pytest.raises(KeyboardInterrupt), Journal(out, me):
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


def test_files_that_are_not_settled_yet_may_be_others(tmp_path):
    """Who takes a broken file out of the list goes on where it stood."""
    out = tmp_path / "scores.jsonl"
    first, second = ["a", "b", "broken", "c"], ["a", "b", "c"]
    with pytest.raises(KeyboardInterrupt), Journal(out, lambda n: str(first[:n])) as journal:
        journal.add(['"a"'], failed=False)
        journal.add(['"b"'], failed=False)
        raise KeyboardInterrupt
    with Journal(out, lambda n: str(second[:n])) as journal:
        assert journal.files == 2
        journal.add(['"c"'], failed=False)
        journal.finish()
    assert out.read_text() == '"a"\n"b"\n"c"\n'


def test_no_row_at_all_is_a_table_without_rows(tmp_path):
    import pyarrow.parquet as pq

    out = tmp_path / "scores.parquet"
    with Journal(out, me) as journal:
        journal.add([], failed=True)
        journal.finish()
    assert pq.read_table(out).num_rows == 0
    assert [p.name for p in tmp_path.iterdir()] == ["scores.parquet"]


def test_the_extra_is_asked_for_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(UsageError, match="not installed"):
        Journal(tmp_path / "scores.parquet", me)
    assert list(tmp_path.iterdir()) == []
