"""Pictures: the files are pictures, and the text says the same."""

import sys
import warnings
from dataclasses import replace

import pytest

from stlspec.learning import plots
from stlspec.learning.plots import Scene, draw_curve, draw_legend, draw_map, draw_reward, reward_figure, reward_text
from stlspec.learning.shaping import AVOIDED, GOAL, LIMIT, RUNS, TERMINAL, VIOLATION

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
    endings = [(GOAL, LIMIT, VIOLATION, TERMINAL, AVOIDED)[k % 5] for k in range(episodes)]
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


LONG = "A title that someone wrote as a whole sentence, with $x_1 and $50 and W" + "W" * 300


@pytest.mark.parametrize("scene", [GRID, ROW, Scene("", (0.0,) * 400, (RUNS,) * 400, 0, (0,), 20)])
@pytest.mark.parametrize("title", [LONG, "costs $5", "$\\frac{$", "$" * 40, "", "\u8def\u5f84"])
def test_any_title_is_drawn_as_it_is_and_inside_the_picture(scene, title):
    pytest.importorskip("matplotlib")
    figure = reward_figure(replace(scene, title=title))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a glyph that the font lacks
        figure.draw_without_rendering()
    (text,) = figure.texts
    box = text.get_window_extent()
    assert text.get_text().replace("\n", " ").startswith(title[:20])
    assert not text.get_parse_math()
    if title and title != LONG:
        assert box.x0 >= 0 and box.x1 <= figure.bbox.width
    if title == LONG:
        assert text.get_text().count("\n") == 2


def test_a_run_without_episodes_has_an_empty_curve(tmp_path):
    draw_curve([], [], 0, "a title", tmp_path / "c.png")
    assert (tmp_path / "c.png").stat().st_size > 0


def test_the_title_of_a_curve_is_no_formula(tmp_path):
    pytest.importorskip("matplotlib")
    draw_curve([3, 2], [GOAL, GOAL], 1, "$\\frac{$ \u8def", tmp_path / "c.png")


def test_a_large_map_is_drawn_with_few_objects():
    """20,000 cells in a row, every third an obstacle: one patch or tick each would take minutes."""
    pytest.importorskip("matplotlib")
    count = 20_000
    endings = tuple(VIOLATION if k % 3 == 2 else RUNS for k in range(count))
    for n_columns in (count, 1, 200, None):
        figure = reward_figure(Scene("t", (0.5,) * count, endings, 0, (0, 1), n_columns))
        figure.draw_without_rendering()
        axes = figure.axes[0]
        assert len(axes.patches) + len(axes.lines) + len(axes.images) + len(axes.texts) < 12
        assert len(axes.get_xticks()) + len(axes.get_yticks()) < 60


def test_a_small_map_keeps_a_tick_for_each_cell():
    pytest.importorskip("matplotlib")
    axes = reward_figure(GRID).axes[0]
    assert list(axes.get_xticks()) == [0, 1]
    assert len(axes.patches) == 2  # the obstacles


@pytest.mark.parametrize(("path", "named"), [((0,), False), ((0, 3), True)])
def test_the_legend_names_a_learned_path_where_there_is_one(path, named):
    pytest.importorskip("matplotlib")
    (legend,) = reward_figure(replace(GRID, path=path)).legends
    assert ("learned path" in [text.get_text() for text in legend.get_texts()]) == named


def test_zones_and_the_order_of_goals_are_written_on_the_map():
    pytest.importorskip("matplotlib")
    figure = reward_figure(replace(GRID, stops=(3, 0), zones=("", "w", "", "d")))
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert [text for text in texts if text in "wd12"] == ["w", "d", "1", "2"]


def test_several_maps_share_a_figure_and_one_legend():
    figures = pytest.importorskip("matplotlib.figure")
    figure = figures.Figure()
    first, second = figure.subplots(1, 2)
    draw_map(first, GRID, 2)
    draw_map(second, GRID, 2, written=False)
    draw_legend(figure, second, path="a way")
    assert len(first.texts) == 3
    assert len(second.texts) == 0
    assert not figure.axes[0].get_legend()
    assert [text.get_text() for text in figure.legends[0].get_texts()][-2:] == ["a way", "violates a hard requirement"]
