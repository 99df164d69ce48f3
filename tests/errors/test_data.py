"""Every code about data shows data that it refuses, and data that it does not."""

from pathlib import Path

import pytest

from stlspec import api
from stlspec.binding import bind
from stlspec.demos import load_demonstrations
from stlspec.errors import DataError
from stlspec.errors.data import CODES
from stlspec.semantics.evaluation import evaluate

DATA = [row for row in CODES if row.kind == "data"]


def use(text: str, file: Path) -> None:
    """Read a CSV file, and evaluate a spec on it that measures time by stamps."""
    file.write_text(text)
    spec = api.compile("time s\nsignal x\nhard a: always (x > 0)")
    (demonstration,) = load_demonstrations(file)
    bound = bind(spec, demonstration)
    evaluate(spec, bound.signals, bound.time)


@pytest.mark.parametrize("row", DATA, ids=lambda row: row.code)
def test_the_examples_do_what_they_illustrate(row, tmp_path: Path):
    with pytest.raises(DataError) as error:
        use(row.bad, tmp_path / "bad.csv")
    assert [d.code for d in error.value.diagnostics] == [row.code]
    use(row.good, tmp_path / "good.csv")


def test_the_example_of_a_wrong_shape_is_one():
    spec = api.compile("signal x\nhard a: x > 0")
    (row,) = (row for row in CODES if row.code == "D813")
    with pytest.raises(DataError, match="D813"):
        eval(row.bad, {"spec": spec})
    eval(row.good, {"spec": spec})
