"""The directory of a run: never half a run, never somebody else's directory."""

import json

import pytest

from stlspec.errors import UsageError
from stlspec.learning import storage
from stlspec.learning.storage import claim, discard, dumps, load_checkpoint, publish, save_checkpoint

RESULT = {"schema": "stlspec.learn/1", "n": 1, "files": {"result": "result.json", "old": "old.txt"}}
RUN = {"result.json": lambda place: place.write_text(json.dumps(RESULT))}


def checkpoint(tmp_path, name="a"):
    return tmp_path / "out.partial" / f"segment-{name}.json"


def code(caught):
    return caught.value.diagnostics[0].code


def test_a_run_appears_at_once_and_leaves_nothing_beside_it(tmp_path):
    out = claim(tmp_path / "deep" / "out")
    assert not out.exists()
    publish(out, RUN)
    assert [p.name for p in out.iterdir()] == ["result.json"]
    assert [p.name for p in out.parent.iterdir()] == ["out"]


def test_an_earlier_run_is_replaced_as_a_whole(tmp_path):
    publish(claim(tmp_path / "out"), {**RUN, "old.txt": lambda place: place.write_text("")})
    publish(claim(tmp_path / "out"), RUN)
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["result.json"]


def test_a_run_to_which_the_user_added_files_is_not_replaced(tmp_path):
    publish(claim(tmp_path / "out"), RUN)
    (tmp_path / "out" / "notes.txt").write_text("mine")
    with pytest.raises(UsageError) as caught:
        claim(tmp_path / "out")
    assert code(caught) == "D872"
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"


def test_an_empty_directory_is_taken(tmp_path):
    (tmp_path / "out").mkdir()
    publish(claim(tmp_path / "out"), RUN)
    assert (tmp_path / "out" / "result.json").exists()


@pytest.mark.parametrize("content", ['{"schema": "other/1"}', "[]", "{", ""])
def test_any_other_directory_is_refused_before_work(tmp_path, content):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "result.json").write_text(content)
    with pytest.raises(UsageError) as caught:
        claim(tmp_path / "out")
    assert code(caught) == "D872"
    assert (tmp_path / "out" / "result.json").read_text() == content


def test_a_file_in_the_way_is_refused(tmp_path):
    for name in ("out", "other.partial", "plain"):
        (tmp_path / name).write_text("")
    for name in ("out", "other", "plain/out", "x" * 300):
        with pytest.raises(UsageError) as caught:
            claim(tmp_path / name)
        assert code(caught) == "D872"
    with pytest.raises(UsageError):
        claim("/")


def test_what_appears_while_a_run_lasts_is_not_overwritten(tmp_path):
    out = claim(tmp_path / "out")
    out.mkdir()
    (out / "mine.txt").write_text("keep")
    with pytest.raises(UsageError) as caught:
        publish(out, RUN)
    assert code(caught) == "D872"
    assert (out / "mine.txt").read_text() == "keep"


def test_a_failing_writer_leaves_the_earlier_run(tmp_path):
    out = claim(tmp_path / "out")
    publish(out, RUN)

    def fail(place):
        place.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(UsageError) as caught:
        publish(out, {"result.json": fail})
    assert "No space left" in str(caught.value)
    assert json.loads((out / "result.json").read_text())["n"] == 1


def test_a_run_killed_between_the_renames_gives_the_earlier_one_back(tmp_path):
    out = claim(tmp_path / "out")
    publish(out, RUN)
    (tmp_path / "out.partial").mkdir()
    out.rename(tmp_path / "out.partial" / "old")
    claim(tmp_path / "out")
    assert (out / "result.json").exists()


def test_a_link_is_followed(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    publish(claim(tmp_path / "link"), RUN)
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real" / "result.json").exists()


def test_a_checkpoint_comes_back_for_the_same_run_only(tmp_path):
    out = claim(tmp_path / "out")
    assert load_checkpoint(out, "a") is None
    save_checkpoint(out, "a", {"x": 1})
    assert load_checkpoint(out, "a")["x"] == 1
    assert load_checkpoint(out, "b") is None
    discard(out)
    assert not (tmp_path / "out.partial").exists()


@pytest.mark.parametrize("content", ["", "{", "[]", '{"schema": "stlspec.checkpoint/1"}', "[" * 100_000])
def test_a_damaged_checkpoint_is_ignored(tmp_path, content):
    out = claim(tmp_path / "out")
    save_checkpoint(out, "a", {})
    checkpoint(tmp_path).write_text(content)
    assert load_checkpoint(out, "a") is None


def test_foreign_files_beside_a_checkpoint_stay(tmp_path):
    out = claim(tmp_path / "out")
    save_checkpoint(out, "a", {})
    (tmp_path / "out.partial" / "mine.txt").write_text("")
    publish(out, RUN)
    assert [p.name for p in (tmp_path / "out.partial").iterdir()] == ["mine.txt"]


def test_numbers_that_json_cannot_hold_are_a_programming_error():
    with pytest.raises(ValueError, match="JSON"):
        dumps(float("inf"))


def test_endless_files_are_read_up_to_a_limit(tmp_path, monkeypatch):
    monkeypatch.setattr(storage, "_LARGEST_RESULT", 1000)
    monkeypatch.setattr(storage, "_LARGEST_CHECKPOINT", 1000)
    out = claim(tmp_path / "out")
    save_checkpoint(out, "a", {})
    checkpoint(tmp_path).unlink()
    checkpoint(tmp_path).symlink_to("/dev/zero")
    assert load_checkpoint(out, "a") is None
    out.mkdir()
    (out / "result.json").symlink_to("/dev/zero")
    with pytest.raises(UsageError) as caught:
        claim(out)
    assert code(caught) == "D872"
