"""The figures of the paper as PNG files: rewards and policies on maps, steps of exploration per episode.

In: cases, and results of experiments. Out: files. Maps are drawn by `learning.plots`; the runs whose policies are
shown are made again with seed 0, which gives the same policies as in the experiments.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from io import BytesIO
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from stlspec.compiler.files import write_bytes
from stlspec.learning import learn
from stlspec.learning.plots import Scene, draw_legend, draw_map
from stlspec.learning.shaping import GOAL, RUNS, VIOLATION
from stlspec.paper.cases import NAMES, Case, case_of
from stlspec.paper.claims import Results, rows_of
from stlspec.paper.experiments import OPTIONS, PLAIN, SHAPED, STANDARD, UNMASKED, unseen
from stlspec.paper.maps import GOALS, OBSTACLES
from stlspec.paper.runs import Row, groups
from stlspec.paper.spread import spread
from stlspec.rewards import ranked_states, reward_of

COLOURS = {SHAPED: "#2b6cb0", UNMASKED: "#7d5ba6", PLAIN: "#e0a458", STANDARD: "#c0392b"}
LABELS = {
    SHAPED: "LfD+STL", UNMASKED: "LfD+STL, no mask", PLAIN: "no demonstrations", STANDARD: "standard Q-learning",
}  # fmt: skip
_INK, _MUTED = "#1b1f24", "#6b7480"
_DPI = 130


def figure_of(width: float, height: float) -> Any:
    """Make an empty figure, in inches; without pyplot, which would change the state of the host program."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def save(figure: Any, place: Path) -> None:
    """Write a figure. Raises: InputError: the file cannot be written."""
    stream = BytesIO()
    figure.savefig(stream, dpi=_DPI, format="png")
    write_bytes(place, stream.getvalue())


def scene_of(case: Case, values: Sequence[float], path: Sequence[int], stops: Sequence[int] = ()) -> Scene:
    """Put values and a path on the map of a case. Args: values: (n_states,). path, stops: states."""
    assert case.map is not None
    marks = "".join(case.map)
    endings = tuple(VIOLATION if m in OBSTACLES else GOAL if m in GOALS else RUNS for m in marks)
    return Scene("", tuple(values), endings, marks.index("S"), tuple(path), len(case.map[0]), tuple(stops))


def map_panels(case: Case) -> list[tuple[str, Scene]]:
    """Return a panel for each demonstration, and one for the reward with the learned policy.

    Paper: figures 3, 5, 6 and 8.
    """
    bundle, environment, demonstrations = case.bundle(), case.environment(), case.demonstrations()
    panels = []
    ranked = ranked_states(bundle, demonstrations, environment)
    for found in ranked:
        values = [found.values.get(state, 0.0) for state in range(environment.n_states)]
        panels.append((f"{found.name}: {found.label}, rank {found.rank}", scene_of(case, values, found.states)))
    outcome = learn(bundle, environment, demonstrations, seed=0)
    table = reward_of(bundle, ranked, environment).table(environment)
    stops = [outcome.states[k] for k in outcome.stops] if len(outcome.stops) > 1 else []
    panels.append(("inferred reward, learned policy", scene_of(case, table, outcome.states, stops)))
    return panels


def unseen_panels(name: str) -> list[tuple[str, Scene]]:
    """Return a panel for each unseen map, with the reward of the demonstrated map and the policy learned.

    Paper: figure 8.
    """
    home = case_of(name)
    panels = []
    for number, case in enumerate(unseen(name), 1):
        environment = case.environment()
        options: Mapping[str, Any] = {"seed": 0, "demo_environment": home.environment(), **OPTIONS[SHAPED]}
        outcome = learn(case.bundle(), environment, home.demonstrations(), **options)
        panels.append((f"unseen map {number}", scene_of(case, outcome.reward.table(environment), outcome.states)))
    return panels


def draw_panels(panels: Sequence[tuple[str, Scene]], title: str, place: Path, path: str = "path") -> None:
    """Draw maps side by side."""
    figure = figure_of(0.5 + 2.7 * len(panels), 3.6)
    axes = np.atleast_1d(figure.subplots(1, len(panels)))
    for ax, (label, scene) in zip(axes, panels, strict=True):
        assert scene.n_columns is not None
        draw_map(ax, scene, scene.n_columns, written=False)
        ax.set_title(label, fontsize=9, color=_INK)
        ax.set_xlabel("")
        ax.set_ylabel("")
    draw_legend(figure, axes[-1], path=path)
    figure.suptitle(title, fontsize=11, color=_INK)
    save(figure, place)


def draw_curves(panels: Sequence[tuple[str, Mapping[str, Sequence[Row]]]], title: str, place: Path) -> None:
    """Draw steps per episode while training: medians over seeds, quartiles as bands.

    Paper: figure 4.
    """
    figure = figure_of(0.6 + 3.6 * len(panels), 3.4)
    axes = np.atleast_1d(figure.subplots(1, len(panels)))
    for ax, (label, by) in zip(axes, panels, strict=True):
        for method, rows in by.items():
            curves = np.array([row.curve for row in rows])
            middle = [np.sqrt((first + 1) * end) for first, end in groups(rows[0].episodes)]
            low, median, high = np.quantile(curves, (0.25, 0.5, 0.75), axis=0)
            ax.fill_between(middle, low, high, color=COLOURS[method], alpha=0.18, linewidth=0)
            ax.plot(middle, median, color=COLOURS[method], linewidth=1.6, label=LABELS[method])
        ax.set_xscale("log")
        ax.xaxis.set_major_formatter("{x:.0f}")
        ax.set_ylim(bottom=0)
        _dress(ax, label, "episode")
    axes[0].set_ylabel("steps per episode", color=_INK)
    axes[-1].legend(frameon=False, fontsize=8, labelcolor=_INK)
    figure.suptitle(title, fontsize=11, color=_INK)
    save(figure, place)


def draw_dots(
    by_group: Mapping[str, Mapping[str, Sequence[Row]]], of: Callable[[Row], float | None], label: str, place: Path
) -> None:
    """Draw one dot a run, by group and method, the median as a line; what never happened is later than all dots."""
    from matplotlib.ticker import LogLocator

    figure = figure_of(max(6.6, 1.2 + 2.2 * len(by_group)), 3.6)
    ax = figure.subplots()
    draw = np.random.default_rng(0)
    for place_of_group, by in enumerate(by_group.values()):
        for number, (method, rows) in enumerate(by.items()):
            every = list(map(of, rows))
            values = [v for v in every if v is not None and isfinite(v)]
            x = place_of_group + (number - (len(by) - 1) / 2) * 0.8 / len(by)
            colour, name = COLOURS[method], LABELS[method] if place_of_group == 0 else None
            ax.plot(x + draw.uniform(-0.05, 0.05, len(values)), values, ".", color=colour, alpha=0.55, label=name)
            middle = spread(every).median
            if isfinite(middle):
                ax.plot([x - 0.08, x + 0.08], [middle] * 2, color=colour, linewidth=2.5)
    ax.set_xticks(range(len(by_group)), list(by_group))
    ax.set_yscale("log")
    ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ax.yaxis.set_major_formatter("{x:.0f}")
    ax.yaxis.set_minor_formatter("")
    _dress(ax, "", "")
    ax.set_ylabel(label, color=_INK)
    figure.legend(loc="outside upper center", ncols=4, frameon=False, fontsize=8, labelcolor=_INK)
    save(figure, place)


def draw_car(name: str, place: Path) -> None:
    """Draw the reward inferred on Mountain Car over its bins, and the demonstrations.

    Paper: figure 9.
    """
    case = case_of(name)
    environment = case.environment()
    ranked = ranked_states(case.bundle(), case.demonstrations(), environment)
    table = np.array(reward_of(case.bundle(), ranked, environment).table(environment)).reshape(case.bins)
    figure = figure_of(5.6, 4.2)
    ax = figure.subplots()
    image = ax.imshow(table.T, origin="lower", cmap="Blues", extent=(-1.2, 0.6, -0.07, 0.07), aspect="auto")
    for number, (kind, states) in enumerate(case.demos, 1):
        colour = ("#e07a1f", "#2e8b57", "#7d5ba6")[number % 3]
        ax.plot(
            *zip(*states, strict=True), color=colour, linewidth=1.1, alpha=0.8, label=f"demonstration {number}, {kind}"
        )
    figure.colorbar(image, ax=ax, shrink=0.85).set_label("reward R(s)", color=_INK)
    ax.axvline(0.5, color=_MUTED, linewidth=1, linestyle="--")
    _dress(ax, f"{case.title}: inferred reward", "position (flag at 0.5)")
    ax.set_ylabel("velocity", color=_INK)
    ax.legend(frameon=False, fontsize=8, labelcolor=_INK, loc="lower right")
    save(figure, place)


def draw_truth(name: str, result: Mapping[str, Any], place: Path) -> None:
    """Draw the ground truth beside the rewards of both methods, as far as they are known.

    Paper: figure 5.
    """
    case = case_of(name)
    environment = case.environment()
    ranked = ranked_states(case.bundle(), case.demonstrations(), environment)
    ours = reward_of(case.bundle(), ranked, environment).table(environment)
    panels = [("ground truth", scene_of(case, result["truth"], ()))]
    irl = result.get("irl") or {}
    if irl.get("reward") is not None:
        # an offset means nothing in a reward, and colours start at 0
        least = min(irl["reward"])
        shifted = [value - least for value in irl["reward"]]
        panels.append((f"MCE-IRL, {irl['demonstrations']} demonstrations, shifted", scene_of(case, shifted, ())))
    panels.append((f"STL reward, {len(case.demos)} demonstrations", scene_of(case, ours, ())))
    draw_panels(panels, f"{case.title}: rewards", place, path="")


def _dress(ax: Any, title: str, below: str) -> None:
    ax.set_title(title, fontsize=9, color=_INK)
    ax.set_xlabel(below, color=_INK)
    ax.spines[["top", "right"]].set_visible(False)
    ax.tick_params(colors=_MUTED, labelsize=8)


def draw_all(results: Results, folder: Path, done: Callable[[str], object] = str) -> list[str]:
    """Draw every figure for which there are results.

    Args:    folder: where the files go; it must exist. done: called with the name of each file.
    Returns: the names of the files, in the order of the paper.
    """
    drawn = []
    for name, draw in _wanted(results).items():
        draw(folder / name)
        drawn.append(name)
        done(name)
    return drawn


def _wanted(results: Results) -> dict[str, Callable[[Path], None]]:
    wanted: dict[str, Callable[[Path], None]] = {}
    learned = {"grid": "grids", "two-goal": "two-goals", "lake": "lakes"}
    for name in NAMES:
        case = case_of(name)
        if learned.get(name.rsplit("-", 1)[0]) in results:
            wanted[f"map-{name}.png"] = _panels(partial(map_panels, case), case.title)
    for name in ("grid-5", "grid-7"):
        found = results.get(f"table-1-{name}")
        if found and found.get("truth"):
            wanted[f"truth-{name}.png"] = partial(draw_truth, name, found)
    if "transfer" in results:
        for name in ("lake-4", "lake-8"):
            title = f"{case_of(name).title}: the reward of the stock map on unseen maps"
            wanted[f"unseen-{name}.png"] = _panels(partial(unseen_panels, name), title)
    for name in ("grids", "lakes"):
        if name in results:
            rows = {case_of(group).title: by for group, by in rows_of(results, name).items()}
            wanted[f"steps-{name}.png"] = partial(draw_dots, rows, lambda row: row.to_success, "steps to success")
    return wanted | _curves(results)


def _panels(make: Callable[[], list[tuple[str, Scene]]], title: str) -> Callable[[Path], None]:
    return lambda place: draw_panels(make(), title, place)


def _curves(results: Results) -> dict[str, Callable[[Path], None]]:
    wanted: dict[str, Callable[[Path], None]] = {}
    if "lakes" in results:
        lakes = [(case_of(g).title, _compared(by)) for g, by in rows_of(results, "lakes").items()]
        wanted["exploration-lakes.png"] = lambda place: draw_curves(lakes, "FrozenLake: exploration", place)
    cars = [
        (case_of(group).title, by)
        for name in ("car-50", "car-75", "car-100")
        if name in results
        for group, by in rows_of(results, name).items()
    ]
    if cars:
        wanted["exploration-car.png"] = lambda place: draw_curves(cars, "Mountain Car: exploration", place)
        wanted["car-reward.png"] = lambda place: draw_car("car-50", place)
    return wanted


def _compared(by: Mapping[str, Sequence[Row]]) -> dict[str, Sequence[Row]]:
    """Keep the methods that the paper compares, ours with and without the mask."""
    return {method: by[method] for method in (SHAPED, UNMASKED, STANDARD) if method in by}
