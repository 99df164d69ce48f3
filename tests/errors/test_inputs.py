import json
from pathlib import Path

import pytest

from stlspec.envs.catalogue import environment_of, make_environment
from stlspec.errors import DataError, UsageError
from stlspec.errors.inputs import CODES
from stlspec.readers.csv import read

DATA = [row for row in CODES if row.kind == "data"]


def test_every_code_has_its_own_number_in_the_range_of_this_table():
    codes = [row.code for row in CODES]
    assert codes == sorted(set(codes))
    assert all("D820" <= code <= "D859" for code in codes)


@pytest.mark.parametrize("row", CODES, ids=lambda row: row.code)
def test_every_code_says_what_it_means_and_shows_it(row):
    assert row.title and row.message and row.explanation and row.bad and row.good and row.help
    assert row.level == "error"


@pytest.mark.parametrize("row", DATA, ids=lambda row: row.code)
def test_the_examples_do_what_they_illustrate(row, tmp_path: Path):
    (tmp_path / "bad.csv").write_text(row.bad)
    (tmp_path / "good.csv").write_text(row.good)
    with pytest.raises(DataError) as error:
        read(tmp_path / "bad.csv")
    assert [d.code for d in error.value.diagnostics] == [row.code]
    assert read(tmp_path / "good.csv")[0].n_samples > 0


def test_the_examples_of_environments_do_what_they_illustrate():
    rows = {row.code: row for row in CODES}
    with pytest.raises(DataError, match="D828"):
        eval(rows["D828"].bad, {"make_environment": make_environment})
    assert eval(rows["D828"].good, {"make_environment": make_environment}) == 1
    bad, good = (json.loads(text)["env"] for text in (rows["D829"].bad, rows["D829"].good))
    with pytest.raises(UsageError, match="D829"):
        environment_of(bad)
    assert environment_of(good).id == "FrozenLake-v1"
