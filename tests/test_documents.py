"""Reading documents back: bounded, and every kind of damage is told in words."""

import json

import pytest

from stlspec.documents import DamageError, read_document, read_state


def test_a_document_comes_back_as_it_was_written(tmp_path):
    place = tmp_path / "d.json"
    place.write_text(json.dumps({"schema": "a/1", "x": [1]}))
    assert read_document(place, "a/1", 100) == {"schema": "a/1", "x": [1]}


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"", "not JSON"),
        (b"\xff", "not JSON"),
        (b"[" * 900, "not JSON"),
        (b"[" * 100_000, "larger than 1000"),
        (b'{"schema": ' + b"9" * 900 + b"}", "schema is not"),
        (b"[]", "schema is not a/1"),
        (b'{"schema": "b/1"}', "schema is not a/1"),
    ],
)
def test_damage_is_told_in_words(tmp_path, content, problem):
    (tmp_path / "d.json").write_bytes(content)
    with pytest.raises(DamageError, match=problem):
        read_document(tmp_path / "d.json", "a/1", 1000)


def test_a_file_that_nests_too_deeply_is_damaged(tmp_path):
    (tmp_path / "d.json").write_bytes(b"[" * 100_000)
    with pytest.raises(DamageError, match="not JSON"):
        read_document(tmp_path / "d.json", "a/1", 2**20)


@pytest.mark.parametrize("name", ["missing.json", ".", "nul\0"])
def test_what_cannot_be_read_is_damaged(tmp_path, name):
    with pytest.raises(DamageError):
        read_document(tmp_path / name, "a/1", 1000)


def test_an_endless_file_is_read_up_to_the_limit_only(tmp_path):
    """A device says that it has 0 bytes, so a size asked for beforehand is worth nothing."""
    place = tmp_path / "endless"
    place.symlink_to("/dev/zero")
    with pytest.raises(DamageError, match="larger"):
        read_document(place, "a/1", 1000)


@pytest.mark.parametrize(("value", "state"), [(0, 0), (7, 7), ([0, 3], (0, 3))])
def test_states_are_numbers_or_cells(value, state):
    assert read_state(value) == state


@pytest.mark.parametrize("value", [-1, True, 1.0, "a", None, [0], [0, -1], [0, True], [0, 1, 2]])
def test_anything_else_is_no_state(value):
    with pytest.raises(DamageError):
        read_state(value)
