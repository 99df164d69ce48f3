"""A sitting: steps, refusals, undo, saving, scores; nothing that was asked for in vain changes anything."""

import json
from pathlib import Path

import pytest

import stlspec
from stlspec.demos import load_demonstrations
from stlspec.errors import DataError, InputError

LEFT, DOWN, RIGHT, UP = range(4)


def ask(session, do: str, **more) -> dict:
    view = session.act({"do": do, "revision": session.revision, **more})
    json.dumps(view, allow_nan=False)
    return view


def walk(session, *actions: int) -> dict:
    for action in actions:
        view = ask(session, "act", action=action)
    return view


def test_a_sitting_from_steps_to_ranks(sit, tmp_path: Path) -> None:
    session = sit()
    about = session.about()
    assert (about["kind"], about["map"], about["title"]) == ("map", ["..G", ".#.", "S.."], "A <b>small</b> spec")
    assert [a["name"] for a in about["actions"]] == ["left", "down", "right", "up"]
    view = ask(session, "go", row=2, column=1)
    assert (view["refused"], view["state"], view["samples"]) == ("", [2, 1], 2)
    assert view["signals"] == {"d_obs": 1.0, "d_goal": 3.0}
    # By hand: no ranges, so avoid can fall to -inf, reach can rise to inf; now -2 = 1 - 3.
    assert view["requirements"]["reach"] == {"low": -2.0, "high": "inf", "current": -2.0, "verdict": "undecided"}
    assert view["requirements"]["avoid"]["high"] == 0.0
    view = walk(session, RIGHT, UP, UP)
    assert view["requirements"]["reach"]["verdict"] == "satisfied"
    view = ask(session, "save", name="around")
    assert view["said"] == "Saved 'around', 5 samples."
    assert (view["samples"], view["name"], view["path"]) == (1, "demo 2", [[2, 0]])
    ask(session, "go", row=1, column=0)
    ask(session, "go", row=1, column=1)
    view = ask(session, "save", name="into it")
    rows = {row["name"]: row for row in view["ranking"]}
    assert [(n, r["label"], r["rank"]) for n, r in rows.items()] == [("around", "good", 2), ("into it", "bad", 1)]
    assert "avoid fails at sample 2: d_obs = 0, needs >= 1" in rows["into it"]["reasons"]
    bundle = stlspec.compile(SPEC_OF(session))
    loaded = load_demonstrations([tmp_path / "demos.jsonl"])
    again = stlspec.score(bundle, loaded)
    assert [d.reward for d in again.demonstrations] == [rows[d.name]["reward"] for d in loaded]
    assert loaded[0].recording.actions == (RIGHT, RIGHT, UP, UP)


def SPEC_OF(session) -> str:  # noqa: N802
    return session._bundle.sources[0][1]


@pytest.mark.parametrize(
    ("request_", "reason"),
    [
        ({"do": "go", "row": 0, "column": 2}, "not next to"),
        ({"do": "go", "row": 2, "column": 0}, "standing there"),
        ({"do": "go", "row": 99, "column": 0}, "no cell"),
        ({"do": "go", "row": "0", "column": 2}, "nothing this page can do"),
        ({"do": "act", "action": 4}, "no action 4"),
        ({"do": "act", "action": -1}, "no action -1"),
        ({"do": "act", "action": True}, "nothing this page can do"),
        ({"do": "act", "action": 1.5}, "nothing this page can do"),
        ({"do": "undo"}, "nothing to undo"),
        ({"do": "save", "name": "x"}, "Nothing has happened yet"),
        ({"do": "remove", "name": "x"}, "not recorded in this sitting"),
        ({"do": "explode"}, "nothing this page can do"),
        ({}, "nothing this page can do"),
    ],
)
def test_what_cannot_be_done_is_refused_with_the_reason_and_changes_nothing(sit, request_: dict, reason: str) -> None:
    session = sit()
    before = session.view()
    view = session.act({**request_, "revision": session.revision})
    assert reason in view["refused"]
    assert session.view() == before


def test_a_second_tab_does_not_step_blindly(sit) -> None:
    session = sit()
    stale = session.revision
    ask(session, "act", action=RIGHT)
    for revision in (stale, None, "0", stale + 7):
        view = session.act({"do": "act", "action": RIGHT, "revision": revision})
        assert "Another tab" in view["refused"]
        assert view["state"] == [2, 1]


@pytest.mark.parametrize("name", ["", "   ", "x" * 81, "two\nlines", "\x1b[31m"])
def test_a_name_is_short_and_on_one_line(sit, name: str) -> None:
    session = sit()
    walk(session, RIGHT)
    assert "A name has" in ask(session, "save", name=name)["refused"]


def test_names_are_unique_also_among_those_of_the_file(sit) -> None:
    first = sit()
    walk(first, RIGHT)
    ask(first, "save", name="demo 1")
    session = sit()
    assert (session.about()["existing"], session.view()["name"]) == (1, "demo 2")
    walk(session, RIGHT)
    assert "already" in ask(session, "save", name="demo 1")["refused"]
    view = ask(session, "save", name=" <script> ")
    assert [(row["name"], row["mine"]) for row in view["ranking"]] == [("demo 1", False), ("<script>", True)]


def test_undo_goes_back_to_the_start_and_the_monitor_with_it(sit) -> None:
    session = sit()
    views = [session.view()] + [walk(session, action) for action in (RIGHT, RIGHT, UP)]
    for earlier in reversed(views[:-1]):
        view = ask(session, "undo")
        for key in ("state", "samples", "path", "requirements", "signals"):
            assert view[key] == earlier[key]
    walk(session, UP)
    assert session.view()["state"] == [1, 0]


def test_staying_at_the_border_is_a_step_and_is_said(sit) -> None:
    session = sit()
    view = walk(session, LEFT)
    assert (view["state"], view["samples"]) == ([2, 0], 2)
    assert "stayed" in view["said"]
    assert ask(session, "restart")["samples"] == 1


def test_after_the_end_nothing_can_follow_but_undo(lamp) -> None:
    session = lamp()
    view = walk(session, 1, 1, 1)
    assert view["said"] == "The environment ended the episode here."
    assert "undo the last step" in ask(session, "act", action=1)["refused"]
    view = ask(session, "undo")
    assert (view["ended"], view["state"]) == ("", [2.0, 0.5])
    assert ask(session, "act", action=0)["state"] == [2.0, 0.5]
    assert session.frame() is not None


def test_an_environment_that_fails_or_forgets_is_told_and_what_was_done_can_be_saved(lamp) -> None:
    view = walk(lamp(fault="step"), 1)
    assert "the fuse blew" in view["refused"]
    session = lamp(fault="forgetful")
    walk(session, 1)
    assert "does not repeat itself" in ask(session, "undo")["refused"]
    assert "lost its way" in session.view()["ended"]
    assert ask(session, "save", name="kept")["refused"] == ""


def test_removing_rewrites_the_file_without_it(sit, tmp_path: Path) -> None:
    session = sit(spec=None)
    for name in ("a", "b"):
        walk(session, RIGHT)
        ask(session, "save", name=name)
    view = ask(session, "remove", name="a")
    assert [d["name"] for d in view["saved"]] == ["b"]
    assert [d.name for d in load_demonstrations([tmp_path / "demos.jsonl"])] == ["b"]


def test_closing_saves_what_is_unfinished_and_says_so(sit, tmp_path: Path) -> None:
    session = sit()
    walk(session, RIGHT)
    ask(session, "save", name="a")
    walk(session, RIGHT, UP)
    account = session.close()
    assert account == f"saved 2 demonstrations in {tmp_path / 'demos.jsonl'}: 'a', 'demo 2' ('demo 2' was unfinished)"
    assert [d.n_samples for d in load_demonstrations([tmp_path / "demos.jsonl"])] == [2, 3]
    assert sit(file="other.json").close() == "nothing was recorded"
    assert not (tmp_path / "other.json").exists()


def test_what_cannot_be_saved_at_the_end_is_kept_elsewhere(sit, tmp_path: Path) -> None:
    session = sit()
    walk(session, RIGHT)
    (tmp_path / "demos.jsonl").write_text("someone else\n")
    assert "changed" in ask(session, "save", name="a")["refused"]
    with pytest.raises(DataError) as caught:
        session.close()
    words = caught.value.diagnostics[0].help
    kept = Path(words.split("kept in ")[1].split(";")[0])
    assert [d.n_samples for d in load_demonstrations([kept])] == [2]
    kept.unlink()
    assert (tmp_path / "demos.jsonl").read_text() == "someone else\n"


def test_a_file_of_other_things_is_scored_without_them(sit, tmp_path: Path) -> None:
    (tmp_path / "demos.jsonl").write_text('{"name": "other", "signals": {"x": [1, 2]}}\n')
    session = sit()
    walk(session, RIGHT)
    assert [row["name"] for row in ask(session, "save", name="a")["ranking"]] == ["a"]
    assert [d.name for d in load_demonstrations([tmp_path / "demos.jsonl"])] == ["other", "a"]


def test_a_spec_that_does_not_fit_is_refused_at_once(sit) -> None:
    with pytest.raises(InputError):
        sit(spec="signal wind\nhard h: always (wind > 1)\n")
