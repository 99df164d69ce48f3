import json
from dataclasses import replace

import pytest

from stlspec.errors import InputError
from stlspec.paper import journal


@pytest.fixture
def out(tmp_path):
    (tmp_path / "results").mkdir()
    return tmp_path


def test_what_is_kept_comes_back(out, made):
    record = made.record("grids", {"a": [1, 2.5, None]})
    journal.save(out, record)
    assert journal.load(out, "grids") == record
    assert journal.load(out, "grids", made.tiny.to_json()) == record
    assert [p.name for p in (out / "results").iterdir()] == ["grids.json"]


def test_another_budget_or_version_does_not_count(out, made, monkeypatch):
    journal.save(out, made.record("grids", {}))
    assert journal.load(out, "grids", replace(made.tiny, seeds=3).to_json()) is None
    monkeypatch.setattr(journal, "__version__", "9.9")
    assert journal.load(out, "grids") is None


@pytest.mark.parametrize("text", ["", "{", "[]", '{"schema": "stlspec.paper/1"}', '{"schema": "other"}'])
def test_a_damaged_file_is_as_good_as_none(out, text):
    (out / "results" / "grids.json").write_text(text)
    assert journal.load(out, "grids") is None


def test_a_file_of_another_experiment_does_not_count(out, made):
    journal.save(out, made.record("grids", {}))
    (out / "results" / "grids.json").rename(out / "results" / "lakes.json")
    assert journal.load(out, "lakes") is None


def test_a_field_too_many_is_damage(out, made):
    journal.save(out, made.record("grids", {}))
    place = out / "results" / "grids.json"
    place.write_text(json.dumps(json.loads(place.read_text()) | {"more": 1}))
    assert journal.load(out, "grids") is None


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("seconds", "1"), ("seconds", True), ("seconds", float("nan")), ("load", [1.0]), ("load", ["a", "b"]),
        ("load", 3), ("machine", []), ("result", [1]), ("result", None), ("budget", "quick"),
    ],
)  # fmt: skip
def test_a_field_of_another_kind_is_damage(out, made, field, value):
    journal.save(out, made.record("grids", {}))
    place = out / "results" / "grids.json"
    place.write_text(json.dumps(json.loads(place.read_text()) | {field: value}))
    assert journal.load(out, "grids") is None


def test_numbers_that_are_none_are_refused(out, made):
    with pytest.raises(ValueError, match="JSON"):
        journal.save(out, made.record("grids", {"a": float("nan")}))


def test_a_folder_that_cannot_be_written_is_a_diagnostic(tmp_path, made):
    with pytest.raises(InputError) as caught:
        journal.save(tmp_path / "nowhere", made.record("grids", {}))
    assert caught.value.diagnostics[0].code == "S092"


def test_the_machine_is_described_by_what_figures_depend_on():
    assert {"processors", "python", "stlspec", "numpy", "gymnasium"} <= set(journal.machine())
    assert isinstance(journal.load_of_machine(), float)
