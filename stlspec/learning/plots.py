"""Pictures of a run: the reward on the map, and the learning curve. The one module that imports matplotlib.

In: tables over states and the log. Out: PNG files, or text where matplotlib is not installed. Figures are
made without pyplot, so that no global state of the host program changes. What is drawn for each cell on its
own (values, grid lines, ticks) is drawn on small maps only, so that a large one costs no more than an image.
"""

import math
import textwrap
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import IO, Any

import numpy as np

from stlspec.learning.shaping import AVOIDED, GOAL, LIMIT, TERMINAL, VIOLATION

_INK, _MUTED, _PATH, _OBSTACLE = "#1b1f24", "#6b7480", "#e07a1f", "#3a4048"
_OUTCOME_COLOURS = {
    GOAL: "#2e8b57",
    LIMIT: "#9aa3ad",
    TERMINAL: "#7d5ba6",
    AVOIDED: "#e0a458",
    VIOLATION: "#c0392b",
}
_OUTCOME_NAMES = {
    GOAL: "goal",
    VIOLATION: "violation",
    LIMIT: "step limit",
    TERMINAL: "terminal state",
    AVOIDED: "avoided state",
}
_ANNOTATED_UP_TO = 12
_TITLE_POINTS, _TITLE_LINES = 11, 3
_STRETCHED_FROM = 20
"""Maps that are so many times longer than wide fill the picture; square cells would be a hairline."""

Target = Path | IO[bytes]


@dataclass(frozen=True, slots=True)
class Scene:
    """What a picture of the reward shows.

    title: shown above. values: (n_states,), R. endings: (n_states,). start: state. path: the greedy path.
    n_columns: the width of the map; None where states are no cells. stops: where the path reaches one goal after
    the other, if there are several. zones: (n_states,), the letter of the zone of each cell, "" = none; () = none.
    """

    title: str
    values: tuple[float, ...]
    endings: tuple[int, ...]
    start: int
    path: tuple[int, ...]
    n_columns: int | None
    stops: tuple[int, ...] = ()
    zones: tuple[str, ...] = ()


def available() -> bool:
    """Tell whether matplotlib is installed, without importing it."""
    return find_spec("matplotlib") is not None


def reward_text(scene: Scene) -> str:
    """Draw the reward as text: two digits a cell, obstacles ##, start S, goal G, the path in brackets.

    Not in the paper: its figures, where there is no matplotlib.
    """
    on_path = set(scene.path)
    cells = []
    for state, value in enumerate(scene.values):
        mark = {GOAL: "G", VIOLATION: "#"}.get(scene.endings[state], "S" if state == scene.start else " ")
        body = f"{mark}{round(100 * value):4d}"
        cells.append(f"[{body}]" if state in on_path else f" {body} ")
    width = scene.n_columns or 10
    rows = ["".join(cells[i : i + width]).rstrip() for i in range(0, len(cells), width)]
    legend = "100 times the reward; S start, G goal, # violates a hard requirement, [ ] the learned path"
    return "\n".join([scene.title, "", *rows, "", legend]) + "\n"


def draw_reward(scene: Scene, place: Target) -> None:
    """Write a heat-map of the reward, on the map where there is one.

    Paper: figures 3 and 5 to 8, rewards left and the policy right; here in one picture.
    """
    _save(reward_figure(scene), place, 130)


def reward_figure(scene: Scene) -> Any:
    """Make the figure that `draw_reward` writes. Paper: see there. Returns: a matplotlib figure."""
    figure = _figure(scene)
    axes = figure.add_subplot()
    if scene.n_columns is None:
        _draw_bars(axes, scene)
    else:
        _draw_cells(figure, axes, scene, scene.n_columns)
    _write_title(figure, scene.title)
    return figure


def _write_title(figure: Any, title: str) -> None:
    """Write a title that stays inside the figure; its text is the user's, so it is never read as a formula."""
    width = int(figure.get_figwidth() * 72 / (0.65 * _TITLE_POINTS))
    lines = textwrap.wrap(title, width, max_lines=_TITLE_LINES, placeholder=" ...")
    figure.suptitle("\n".join(lines), color=_INK, fontsize=_TITLE_POINTS, parse_math=False)


def _save(figure: Any, place: Target, dpi: int) -> None:
    with warnings.catch_warnings():
        # a character that the font lacks is drawn as a box, which is no news for the user
        warnings.filterwarnings("ignore", message="Glyph", category=UserWarning)
        figure.savefig(place, dpi=dpi, format="png")


def _figure(scene: Scene) -> Any:
    from matplotlib.figure import Figure

    if scene.n_columns is None:
        return Figure(figsize=(7, 3.2), layout="constrained")
    n_rows = len(scene.values) // scene.n_columns
    cell = min(0.75, 9 / max(n_rows, scene.n_columns))
    width, height = max(4.2, cell * scene.n_columns + 1.6), max(3.4, cell * n_rows + 1.4)
    return Figure(figsize=(width, height), layout="constrained")


def _draw_cells(figure: Any, axes: Any, scene: Scene, n_columns: int) -> None:
    image = draw_map(axes, scene, n_columns)
    bar = figure.colorbar(image, ax=axes, shrink=0.85, pad=0.03)
    bar.set_label("reward R(s)", color=_INK)
    bar.outline.set_visible(False)
    draw_legend(figure, axes, path="learned path" if len(scene.path) > 1 else "")


def draw_legend(figure: Any, axes: Any, *, path: str) -> None:
    """Say below a figure what the marks of `draw_map` mean. Not in the paper. Args: path: what it is, "" = none."""
    handles, _ = axes.get_legend_handles_labels()
    handles += _legend_extras(path)
    style = {"loc": "outside lower center", "ncols": 4, "frameon": False, "fontsize": 8, "labelcolor": _INK}
    figure.legend(handles=handles, handletextpad=0.5, columnspacing=1.4, **style)


def draw_map(axes: Any, scene: Scene, n_columns: int, *, written: bool = True) -> Any:
    """Draw the values of a scene on its map, with obstacles, path, start and goals, but no legend.

    Paper: one panel of its figures.

    Args:    axes: of matplotlib. n_columns: the width of the map. written: with the values as numbers.
    Returns: the image of the values, for a colour bar.
    """
    values = np.array(scene.values).reshape(-1, n_columns)
    limit = max(1e-12, float(np.abs(values).max()))
    n_rows = len(values)
    stretched = max(n_rows, n_columns) >= _STRETCHED_FROM * min(n_rows, n_columns)
    aspect = "auto" if stretched else "equal"
    image = axes.imshow(values, cmap="RdBu", vmin=-1.5 * limit, vmax=1.5 * limit, aspect=aspect)
    image.set_clim(-limit, limit)
    obstacles = np.array(scene.endings).reshape(-1, n_columns) == VIOLATION
    if max(n_rows, n_columns) <= _ANNOTATED_UP_TO:
        if written:
            _write_values(axes, values, limit)
        for row, column in np.argwhere(obstacles).tolist():
            _draw_obstacle(axes, row, column)
        _draw_grid(axes, n_rows, n_columns)
        _write_zones(axes, scene.zones, n_columns)
    else:
        _draw_layer(axes, obstacles, aspect)
    rows, columns = np.divmod(np.array(scene.path), n_columns)
    axes.plot(columns, rows, color="white", linewidth=5, solid_capstyle="round", alpha=0.9, zorder=3)
    axes.plot(columns, rows, color=_PATH, linewidth=2.5, solid_capstyle="round", zorder=4)
    _mark_ends(axes, scene, n_columns)
    axes.tick_params(which="both", length=0, colors=_MUTED, labelsize=8)
    axes.set_xlabel("column", color=_MUTED)
    axes.set_ylabel("row", color=_MUTED)
    axes.spines[:].set_visible(False)
    return image


def _draw_grid(axes: Any, n_rows: int, n_columns: int) -> None:
    axes.set_xticks(range(n_columns), minor=False)
    axes.set_yticks(range(n_rows), minor=False)
    axes.set_xticks(np.arange(n_columns + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(n_rows + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="#d5d9de", linewidth=0.8)


def _draw_layer(axes: Any, obstacles: Any, aspect: str) -> None:
    """Draw all obstacles as one image above the values, and ticks at whole numbers only."""
    from matplotlib.colors import ListedColormap
    from matplotlib.ticker import MaxNLocator

    layer = np.ma.masked_where(~obstacles, np.ones(obstacles.shape))
    axes.imshow(layer, cmap=ListedColormap([_OBSTACLE]), aspect=aspect, zorder=2)
    for axis, count in ((axes.xaxis, obstacles.shape[1]), (axes.yaxis, obstacles.shape[0])):
        axis.set_major_locator(MaxNLocator(nbins=min(9, count), integer=True, min_n_ticks=1))


def _write_values(axes: Any, values: Any, limit: float) -> None:
    for (row, column), value in np.ndenumerate(values):
        if value:
            shade = "white" if abs(value) > 0.6 * limit else _INK
            axes.text(column + 0.45, row + 0.36, f"{value:.2f}", ha="right", va="center", fontsize=6, color=shade)


def _write_zones(axes: Any, zones: Sequence[str], n_columns: int) -> None:
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=2.5, foreground="white")]
    for state, letter in enumerate(zones):
        row, column = divmod(state, n_columns)
        if letter:
            axes.text(
                column - 0.42, row - 0.34, letter, ha="left", va="center", fontsize=8, color=_INK, path_effects=halo
            )


def _draw_obstacle(axes: Any, row: int, column: int) -> None:
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle((column - 0.24, row - 0.24), 0.48, 0.48, color=_OBSTACLE, linewidth=0, zorder=2))


def _mark_ends(axes: Any, scene: Scene, n_columns: int) -> None:
    style: dict[str, Any] = {"markeredgecolor": "white", "markeredgewidth": 1.2, "linestyle": "", "zorder": 5}
    row, column = divmod(scene.start, n_columns)
    axes.plot([column], [row], marker="o", markersize=12, color=_INK, label="start", **style)
    goals = [divmod(s, n_columns) for s, ending in enumerate(scene.endings) if ending == GOAL]
    if goals:
        rows, columns = zip(*goals, strict=True)
        axes.plot(columns, rows, marker="*", markersize=18, color="#f2b705", label="goal", **style)
    for number, stop in enumerate(scene.stops, 1):
        row, column = divmod(stop, n_columns)
        style = {"ha": "center", "va": "center", "fontsize": 7, "fontweight": "bold", "color": _INK, "zorder": 6}
        axes.text(column, row + 0.02, str(number), **style)


def _legend_extras(path: str) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    line = [Line2D([], [], color=_PATH, linewidth=2.5, label=path)] if path else []
    return [*line, Patch(color=_OBSTACLE, linewidth=0, label="violates a hard requirement")]


def _draw_bars(axes: Any, scene: Scene) -> None:
    values = np.array(scene.values)
    edges = np.arange(len(values) + 1) - 0.5
    axes.stairs(np.maximum(values, 0), edges, fill=True, color="#2b6cb0")
    axes.stairs(np.minimum(values, 0), edges, fill=True, color="#c0392b")
    axes.set_xlabel("state", color=_MUTED)
    axes.set_ylabel("reward R(s)", color=_MUTED)
    axes.spines[["top", "right"]].set_visible(False)


def draw_curve(
    steps: Sequence[int],
    endings: Sequence[int],
    first_success: int | None,
    title: str,
    place: Target,
) -> None:
    """Write the learning curve: how episodes end, and how many steps they take.

    Paper: figure 4, steps per training episode; the share of outcomes is ours.

    Args:    steps, endings: the log, (n_episodes,). first_success: the episode of the first greedy check from
             which on all succeed. title: shown above. place: the PNG file, or a stream of bytes.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 4.6), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    last = len(steps)
    edges = sorted({0, last, *(np.geomspace(1, last, 60).astype(int).tolist() if last else ())})
    groups = [slice(first, last) for first, last in pairwise(edges)]
    # most is learned in the first episodes, so the axis is logarithmic and the groups grow with it
    middle = [math.sqrt((group.start + 1) * group.stop) for group in groups]
    lengths = [np.asarray(steps[g]) for g in groups]
    top.fill_between(
        middle, [np.quantile(x, 0.1) for x in lengths], [np.quantile(x, 0.9) for x in lengths],
        color="#2b6cb0", alpha=0.18, linewidth=0, label="10 % to 90 %",
    )  # fmt: skip
    top.plot(middle, [np.median(x) for x in lengths], color="#2b6cb0", linewidth=1.8, label="median")
    top.set_ylabel("steps per episode", color=_INK)
    top.set_ylim(bottom=0)
    shares = {
        kind: [float(np.mean(np.asarray(endings[g]) == kind)) for g in groups]
        for kind in _OUTCOME_COLOURS
        if kind in endings
    }
    bottom.stackplot(
        middle,
        list(shares.values()) or [[0.0] * len(middle)],
        colors=[_OUTCOME_COLOURS[kind] for kind in shares] or ["white"],
        labels=[_OUTCOME_NAMES[kind] for kind in shares],
        alpha=0.85,
    )
    bottom.set_ylim(0, 1)
    bottom.set_ylabel("how they end", color=_INK)
    bottom.set_xlabel("episode", color=_INK)
    bottom.set_xscale("log")
    bottom.xaxis.set_major_formatter("{x:.0f}")
    bottom.set_xlim(1, max(2, len(steps)))
    _finish_curve(top, bottom, first_success)
    _write_title(figure, title)
    _save(figure, place, 150)


def _finish_curve(top: Any, bottom: Any, first_success: int | None) -> None:
    for axes in (top, bottom):
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(colors=_MUTED, labelsize=8)
        if first_success is not None:
            axes.axvline(first_success, color=_PATH, linewidth=1.5, linestyle="--")
    if first_success is not None:
        top.plot([], [], color=_PATH, linestyle="--", label=f"success from episode {first_success} on")
    top.legend(frameon=False, fontsize=8, labelcolor=_INK, loc="best")
    if bottom.get_legend_handles_labels()[0]:  # a run may need no episodes
        bottom.legend(framealpha=0.9, edgecolor="white", fontsize=8, labelcolor=_INK, loc="center right")
