"""Recording in a real browser: clicks, an illegal click, undo, two tabs, keys, saving, the end."""

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from stlspec.demos import load_demonstrations
from tests.browser.conftest import CONTRAST

pytestmark = pytest.mark.browser
SPECS = Path(__file__).parents[2] / "specs"
LAKE = [str(SPECS / "frozenlake_8x8.stl"), "--env", "FrozenLake-v1", "--env-arg", "map_name=8x8",
        "--env-arg", "is_slippery=false"]  # fmt: skip
GRID = ["--env", "stlspec/GridWorld-v0", "--map", str(SPECS / "maps" / "grid_5x5.txt")]


@pytest.fixture
def record(tmp_path: Path) -> Iterator[Callable[..., tuple[subprocess.Popen[str], str]]]:
    """Start recorders that save in out.jsonl."""
    started: list[subprocess.Popen[str]] = []

    def begin(*words: str) -> tuple[subprocess.Popen[str], str]:
        command = [sys.executable, "-m", "stlspec", "record", *words, "-o", "out.jsonl"]
        process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        started.append(process)
        return process, re.search(r"http://\S+", process.stderr.readline()).group(0)

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def click(page: Any, row: int, column: int) -> None:
    page.locator(f'[data-row="{row}"][data-column="{column}"]').click()


def steps(page: Any, count: int) -> None:
    words = "at the start" if count == 0 else f"{count} step" + ("s" if count > 1 else "")
    page.wait_for_function("words => document.getElementById('count').textContent === words", arg=words)


def test_a_sitting_with_the_mouse(record: Any, visit: Callable[..., Any], tmp_path: Path) -> None:
    process, url = record(*LAKE)
    page = visit(url)
    steps(page, 0)
    assert page.get_by_role("heading", level=1).inner_text() == "Cross the lake, around the holes"
    click(page, 0, 1)
    steps(page, 1)
    click(page, 1, 1)
    steps(page, 2)
    click(page, 5, 5)
    page.get_by_role("alert").get_by_text("Row 5, column 5 is not next to row 1, column 1").wait_for()
    steps(page, 2)
    page.get_by_role("button", name="Undo").click()
    steps(page, 1)
    assert page.get_by_role("alert").inner_text() == ""
    card = page.locator(".card", has_text="avoid")
    assert "undecided" in card.inner_text()
    # From row 0, column 1 into the hole at row 2, column 3, by way of row 2.
    for row, column in ((1, 1), (2, 1), (2, 2), (2, 3)):
        click(page, row, column)
        page.wait_for_function("at => document.querySelector('svg title').textContent.endsWith(at)",
                               arg=f"row {row}, column {column}")  # fmt: skip
    assert "violated" in card.inner_text()
    assert page.get_by_text("The environment ended the episode here").is_visible()
    click(page, 2, 2)
    page.get_by_role("alert").get_by_text("undo the last step, start over, or save").wait_for()
    page.get_by_label("Name").fill("into a <b>hole</b>")
    page.get_by_role("button", name="Save").click()
    row = page.get_by_role("row", name="into a <b>hole</b>")
    row.wait_for()
    assert "bad" in row.inner_text()
    assert "avoid fails at sample 5: d_obs = 0, needs >= 1" in row.inner_text()
    steps(page, 0)
    (saved,) = load_demonstrations([tmp_path / "out.jsonl"])
    assert saved.name == "into a <b>hole</b>"
    assert saved.recording.states == ([0, 0], [0, 1], [1, 1], [2, 1], [2, 2], [2, 3])
    page.get_by_role("button", name="Finish").click()
    page.get_by_text("The recording is over").wait_for()
    out, _ = process.communicate(timeout=10)
    assert (process.returncode, out.startswith("saved 1 demonstration")) == (0, True)


def test_ctrl_c_in_the_terminal_is_told_on_the_page(record: Any, visit: Callable[..., Any], tmp_path: Path) -> None:
    process, url = record(*GRID)
    page = visit(url, outlived=True)
    steps(page, 0)
    page.keyboard.press("ArrowUp")
    steps(page, 1)
    page.wait_for_function("() => source.readyState === EventSource.OPEN")
    process.send_signal(signal.SIGINT)
    page.get_by_text("The unfinished one was saved too.").wait_for()
    assert process.wait(10) == 130
    (saved,) = load_demonstrations([tmp_path / "out.jsonl"])
    assert saved.n_samples == 2


def test_a_sitting_with_the_keyboard_alone(record: Any, visit: Callable[..., Any], tmp_path: Path) -> None:
    process, url = record(*GRID)
    page = visit(url)
    steps(page, 0)
    for count, key in enumerate(("ArrowUp", "ArrowUp", "2"), 1):
        page.keyboard.press(key)
        steps(page, count)
    page.keyboard.press("Backspace")
    steps(page, 2)
    page.get_by_role("button", name="right").press("Enter")
    steps(page, 3)
    page.get_by_label("Name").press("Enter")
    page.get_by_role("row", name="demo 1").wait_for()
    assert page.evaluate("document.activeElement.id") == "board"
    page.on("dialog", lambda dialog: dialog.accept())
    page.get_by_role("button", name="Remove demo 1").press("Enter")
    page.get_by_text("Nothing yet.").wait_for()
    page.get_by_role("button", name="Finish").press("Enter")
    assert process.wait(10) == 0
    assert (tmp_path / "out.jsonl").read_text() == ""


def test_a_double_click_is_one_step_and_two_tabs_agree(record: Any, visit: Callable[..., Any]) -> None:
    _, url = record(*GRID)
    first, second = visit(url), visit(url, "dark")
    steps(second, 0)
    first.locator('[data-row="3"][data-column="0"]').dblclick()
    steps(first, 1)
    steps(second, 1)
    assert first.get_by_role("alert").inner_text() == ""
    click(second, 2, 0)
    steps(first, 2)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_is_readable_in_both_colour_schemes(scheme: str, record: Any, visit: Callable[..., Any]) -> None:
    _, url = record(*LAKE)
    page = visit(url, scheme)
    steps(page, 0)
    page.keyboard.press("ArrowRight")
    steps(page, 1)
    page.get_by_role("button", name="Save").click()
    page.get_by_role("row", name="demo 1").wait_for()
    click(page, 7, 7)
    page.get_by_role("alert").get_by_text("not next to").wait_for()
    assert page.evaluate(CONTRAST) == []
    page.set_viewport_size({"width": 360, "height": 700})
    assert page.evaluate("document.documentElement.scrollWidth") <= 360


def test_frames_and_keys_of_another_environment(record: Any, visit: Callable[..., Any], tmp_path: Path) -> None:
    if find_spec("pygame") is None and not os.environ.get("STLSPEC_BROWSER"):
        pytest.skip("rendering frames needs the extra record")
    process, url = record(str(SPECS / "mountain_car.stl"), "--env", "MountainCar-v0")
    page = visit(url)
    steps(page, 0)
    page.wait_for_function("() => document.querySelector('#board img').naturalWidth > 100")
    before = page.locator("#board img").get_attribute("src")
    for count, key in enumerate(("ArrowLeft", "ArrowRight", " "), 1):
        page.keyboard.press(key)
        steps(page, count)
    assert page.locator("#board img").get_attribute("src") != before
    page.close()
    # The page was closed: what was done is saved, and the recorder ends.
    out, _ = process.communicate(timeout=40)
    assert process.returncode == 0
    assert "'demo 1' was unfinished" in out
    assert json.loads((tmp_path / "out.jsonl").read_text())["actions"] == [0, 2, 1]


def test_a_huge_map_can_be_walked(record: Any, visit: Callable[..., Any], tmp_path: Path) -> None:
    rows = ["." * 1000 for _ in range(999)] + ["S" + "." * 998 + "G"]
    (tmp_path / "huge.txt").write_text("\n".join(rows) + "\n")
    _, url = record("--env", "stlspec/GridWorld-v0", "--map", str(tmp_path / "huge.txt"))
    page = visit(url)
    steps(page, 0)
    click(page, 998, 0)
    steps(page, 1)
    assert page.locator("[data-row]").count() < 4000


ATTACK = """async (url) => {
  // What a page of another site can try, even if it knew the token.
  const tries = [
    fetch(url + "view"),
    fetch(url + "act", { method: "POST", headers: { "Content-Type": "application/json" }, body: STEP }),
    fetch(url + "act", { method: "POST", mode: "no-cors", headers: { "Content-Type": "text/plain" }, body: STEP }),
    fetch(url + "finish", { method: "POST", mode: "no-cors", body: "{}" }),
  ];
  const answers = await Promise.allSettled(tries);
  return answers.map((a) => (a.status === "rejected" ? "rejected" : a.value.type + " " + a.value.status));
}""".replace("STEP", json.dumps(json.dumps({"do": "act", "action": 3, "revision": 0})))


def test_a_page_of_another_site_can_neither_read_nor_press(record: Any, visit: Any, browser: Any) -> None:
    process, url = record(*GRID)
    page = visit(url)
    steps(page, 0)
    foreign = browser.new_page()
    foreign.route("http://evil.example/", lambda route: route.fulfill(body="<p>evil</p>", content_type="text/html"))
    foreign.goto("http://evil.example/")
    answers = foreign.evaluate(ATTACK, url)
    assert answers[:2] == ["rejected", "rejected"]
    assert set(answers[2:]) <= {"opaque 0", "rejected"}, "sent blindly, if at all"
    foreign.goto(url.replace("127.0.0.1", "localhost"))
    assert foreign.get_by_role("heading", level=1).count() == 1, "the other name of this machine is as good"
    foreign.close()
    assert process.poll() is None
    page.keyboard.press("ArrowUp")
    steps(page, 1)
