"""The benchmark of many files makes what it says, and its comparisons are of real runs."""

import pyarrow.parquet as pq

from tests.benchmarks.many import SPEC, family, make_files, resident, scored


def test_files_have_the_columns_and_differ(tmp_path):
    make_files(tmp_path, 3, 20, 5)
    tables = [pq.read_table(path) for path in sorted(tmp_path.iterdir())]
    assert [t.shape for t in tables] == [(20, 5)] * 3
    assert not tables[0].equals(tables[1])


def test_a_run_is_measured(tmp_path):
    (tmp_path / "s.stl").write_text(SPEC)
    (tmp_path / "data").mkdir()
    make_files(tmp_path / "data", 3, 20, 5)
    seconds, peak = scored(tmp_path, "r.jsonl")
    assert seconds > 0 and peak > 2**20
    assert (tmp_path / "r.jsonl").read_text().count("\n") == 3


def test_a_process_that_has_gone_takes_no_memory():
    assert resident(2**22) == 0 and family(2**22) == [2**22]
