"""Pictures: the files are pictures, and the text says the same."""

import sys

import pytest

from stlspec.learning import plots
from stlspec.learning.plots import Scene, draw_curve, draw_reward, reward_text
from stlspec.learning.shaping import GOAL, LIMIT, RUNS, TERMINAL, VIOLATION

GRID = Scene("a title", (0.25, 0.0, -0.5, 1.0), (RUNS, VIOLATION, VIOLATION, GOAL), 0, (0, 3), 2)
ROW = Scene("a title", (0.5, -0.5, 0.0), (RUNS, RUNS, TERMINAL), 0, (0, 1), None)


def test_text_shows_values_marks_and_the_path():
    lines = reward_text(GRID).splitlines()
    assert lines[0] == "a title"
    assert lines[2:4] == ["[S  25] #   0", " # -50 [G 100]"]
    assert "[S  50][  -50]" in reward_text(ROW)


@pytest.mark.parametrize("scene", [GRID, ROW, Scene("", (0.0,) * 400, (RUNS,) * 400, 0, (0,), 20)])
def test_a_reward_picture_is_written(tmp_path, scene):
    pytest.importorskip("matplotlib")
    draw_reward(scene, tmp_path / "r.png")
    assert (tmp_path / "r.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("episodes", [1, 2, 7, 500])
@pytest.mark.parametrize("success", [None, 1])
def test_a_curve_is_written_for_any_number_of_episodes(tmp_path, episodes, success):
    pytest.importorskip("matplotlib")
    endings = [(GOAL, LIMIT, VIOLATION, TERMINAL)[k % 4] for k in range(episodes)]
    draw_curve(range(episodes), endings, success, "a title", tmp_path / "c.png")
    assert (tmp_path / "c.png").read_bytes().startswith(b"\x89PNG")


def test_no_global_state_of_matplotlib_is_touched(tmp_path):
    pytest.importorskip("matplotlib")
    before = "matplotlib.pyplot" in sys.modules
    draw_reward(GRID, tmp_path / "r.png")
    assert ("matplotlib.pyplot" in sys.modules) == before


def test_whether_matplotlib_is_there_is_found_out_without_importing_it(monkeypatch):
    monkeypatch.setattr(plots, "find_spec", lambda name: None)
    assert not plots.available()
