"""Drawing: pictures as PNG or SVG. The one module of this stage that imports matplotlib.

In: `Picture`s and where to put them. Out: files, each whole or not at all. Long traces are drawn as the band
between the least and the greatest value of each of a few hundred stretches, so that neither a spike is lost
nor a file grows. Figures are made without pyplot, so that no state of the host program stays changed.
"""

import io
import re
import warnings
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from stlspec.compiler.files import write_bytes
from stlspec.compiler.printing import number_text
from stlspec.errors import InputError, UsageError, diagnostic
from stlspec.pictures.contents import (
    Floats,
    Mark,
    Picture,
    RobustnessPanel,
    SignalPanel,
    joined,
    plain,
    sample_edges,
    thinned,
)
from stlspec.semantics.evaluation import Verdict

THINNED_ABOVE = 2000
"""Traces with more samples than this are drawn as bands."""

SUFFIXES = (".png", ".svg")
_INK, _MUTED, _LINE, _GRID = "#1b1f24", "#6b7480", "#2b6cb0", "#e3e6ea"
_GOOD, _BAD, _UNSURE, _WITNESS = "#2e8b57", "#c0392b", "#b7791f", "#e07a1f"
_COLOURS = {Verdict.SATISFIED: _GOOD, Verdict.VIOLATED: _BAD, Verdict.UNDECIDED: _UNSURE}
_LABELS = {"good": _GOOD, "incomplete": _UNSURE, "bad": _BAD}


def check_target(out: Path, n_demonstrations: int) -> None:
    """Refuse, before any work, what cannot be drawn.

    Raises: UsageError D880: matplotlib is missing, or one file is to hold several pictures.
    """
    if find_spec("matplotlib") is None:
        way = "install the extra: pip install 'stlspec[plot]'"
        raise UsageError([diagnostic("D880", what="`--plot` needs matplotlib, which is not installed", help=way)])
    suffix = out.suffix.lower()
    if suffix in SUFFIXES and n_demonstrations != 1 and not out.is_dir():
        what = f"`--plot {out.name}` names one picture, but there are {n_demonstrations} demonstrations"
        raise UsageError([diagnostic("D880", what=what, help="name a folder, such as `--plot pictures`")])
    if suffix in (".pdf", ".jpg", ".jpeg", ".gif", ".webp"):
        what = f"pictures are not written as {suffix}"
        raise UsageError([diagnostic("D880", what=what, help="name a .png or .svg file, or a folder")])


def picture_files(out: Path, names: Sequence[str]) -> list[Path]:
    """Return the file of each demonstration: `out` itself, or in the folder `out` one named after each."""
    if out.suffix.lower() in SUFFIXES and not out.is_dir():
        return [out]
    width = len(str(len(names)))
    plain = [re.sub(r"[^A-Za-z0-9]+", "_", name.rpartition("/")[2]).strip("_")[:40] for name in names]
    return [out / f"{k:0{width}}_{name or 'demonstration'}.png" for k, name in enumerate(plain, start=1)]


def draw_picture(picture: Picture, file: Path) -> None:
    """Draw a picture into a file, whole or not at all; its folder is made where there is none.

    Not in the paper: see `picture_of`.

    Raises: InputError: the file cannot be written.
    """
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        problem = (error.strerror or str(error)).lower()
        way = "name a folder that can be made and written"
        refusal = diagnostic("S092", file=str(file.parent), verb="write", problem=problem, help=way)
        raise InputError([refusal]) from None
    write_bytes(file, picture_bytes(picture, file.suffix.lower().lstrip(".")))


def picture_bytes(picture: Picture, kind: str = "png") -> bytes:
    """Return a picture as the bytes of a PNG or SVG file, without the date."""
    from matplotlib import rc_context

    out = io.BytesIO()
    settings: dict[Any, Any] = {"text.parse_math": False, "svg.hashsalt": "stlspec", "axes.unicode_minus": True}
    with rc_context(settings), warnings.catch_warnings():
        # A name may be written in a script that the font does not have.
        warnings.simplefilter("ignore")
        figure = _figure(picture)
        figure.savefig(out, format=kind, dpi=130, metadata={"Date": None} if kind == "svg" else None)
    return out.getvalue()


def _figure(picture: Picture) -> Any:
    from matplotlib.figure import Figure

    panels: list[SignalPanel | RobustnessPanel] = [*picture.signals, *picture.requirements]
    heights = [
        0.8 if isinstance(p, SignalPanel) and p.boolean else 1.35 if isinstance(p, SignalPanel) else 1.15
        for p in panels
    ] or [1.0]
    figure = Figure(figsize=(9, sum(heights) + 1.35), layout="constrained")
    axes = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    figure.suptitle(picture.title, x=0.012, ha="left", color=_INK, fontsize=13, fontweight="bold")
    for axis, panel in zip(axes, panels, strict=False):
        if isinstance(panel, SignalPanel):
            _draw_signal(axis, panel, picture.times)
        else:
            _draw_robustness(axis, panel, picture.times)
    _finish(figure, axes, picture)
    return figure


def _finish(figure: Any, axes: Any, picture: Picture) -> None:
    for axis in axes:
        axis.spines[["top", "right"]].set_visible(False)
        axis.spines[["left", "bottom"]].set_color("#b9c0c8")
        axis.tick_params(colors=_MUTED, labelsize=8)
        axis.grid(axis="x", color=_GRID, linewidth=0.6)
        axis.set_axisbelow(True)
    if len(picture.times):
        edges = sample_edges(picture.times)
        axes[-1].set_xlim(float(edges[0]), float(edges[-1]))
    if picture.unit == "step":
        axes[-1].xaxis.get_major_locator().set_params(integer=True)
    axes[-1].set_xlabel("sample" if picture.unit == "step" else f"time ({picture.unit})", color=_MUTED, fontsize=9)
    more = f" · {picture.left_out} more not drawn" if picture.left_out else ""
    top = 1 - 0.09 / figure.get_figheight()
    colour = _LABELS.get(picture.label or "", _MUTED)
    figure.text(0.988, top, picture.subtitle + more, ha="right", va="top", color=colour, fontsize=10.5)
    handles = _legend(picture)
    if handles:
        figure.legend(
            handles=handles, loc="outside lower right", ncols=len(handles), frameon=False, fontsize=8, labelcolor=_INK
        )


def _legend(picture: Picture) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    if any(p.shaded for p in picture.signals):
        handles.append(Patch(color=_BAD, alpha=0.14, linewidth=0, label="violating"))
    if any(p.marks for p in picture.signals):
        handles.append(Line2D([], [], color=_WITNESS, marker="o", linestyle="", markersize=6, label="decides"))
    if any(p.bounds for p in picture.signals):
        handles.append(Line2D([], [], color=_MUTED, linestyle="--", linewidth=1, label="bound"))
    return handles


def _draw_signal(axis: Any, panel: SignalPanel, times: Floats) -> None:
    unit = f" [{panel.unit}]" if panel.unit else ""
    axis.set_title(f"{panel.name}{unit}", loc="left", color=_INK, fontsize=9, pad=4)
    for name in dict.fromkeys(name for name, _ in panel.shaded):
        # One layer for each requirement: darker means that more of them are violated.
        for first, last in joined([span for owner, span in panel.shaded if owner == name]):
            axis.axvspan(first, last, color=_BAD, alpha=0.14, linewidth=0, zorder=0)
    if panel.boolean:
        _draw_curve(axis, times, panel.values, _LINE, steps=True, fill=True)
        axis.set_ylim(-0.15, 1.25)
        axis.set_yticks([0, 1], ["false", "true"])
        top = 1.0
    else:
        top = _draw_curve(axis, times, panel.values, _LINE)
        for bound in panel.bounds:
            axis.axhline(bound, color=_MUTED, linestyle="--", linewidth=0.9, zorder=1)
    _draw_marks(axis, panel.marks, top)


def _draw_marks(axis: Any, marks: Sequence[Mark], top: float) -> None:
    """Mark the witnesses, those of one sample once, named by their requirements."""
    from matplotlib.patheffects import withStroke

    places: dict[tuple[float, float], list[str]] = {}
    for mark in marks:
        places.setdefault((mark.time, float(np.clip(mark.value, -top, top))), []).append(mark.requirement)
    low, high = axis.get_ylim()
    left, right = axis.get_xlim()
    for (time, value), names in places.items():
        axis.plot([time], [value], "o", color=_WITNESS, markersize=6.5, markeredgecolor="white", zorder=5)
        above, after = value < (low + high) / 2, time > (left + right) / 2
        text = plain(", ".join(names))
        axis.annotate(
            text, (time, value), xytext=(-5 if after else 5, 5 if above else -5), textcoords="offset points",
            ha="right" if after else "left", va="bottom" if above else "top", fontsize=7.5, color=_INK, zorder=6,
path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )  # fmt: skip


def _draw_robustness(axis: Any, panel: RobustnessPanel, times: Floats) -> None:
    colour = _COLOURS[panel.mark.verdict]
    number = number_text(float(f"{panel.mark.value:.4g}")).replace("inf", "∞")
    vacuous = " (vacuous)" if panel.vacuous else ""
    title = f"{panel.name}: {panel.mark.verdict.value}, robustness {number}{vacuous}"
    axis.set_title(title, loc="left", color=colour, fontsize=9, fontweight="bold", pad=4)
    axis.set_title(panel.strength, loc="right", color=_MUTED, fontsize=8, pad=4)
    top = _draw_curve(axis, times, panel.values, colour)
    axis.axhline(0, color=_INK, linewidth=0.9, zorder=2)
    value = float(np.clip(panel.mark.value, -top, top))
    axis.plot(
        [panel.mark.time], [value], "D", color=colour, markersize=5.5, markeredgecolor="white", zorder=5, clip_on=False
    )


def _draw_curve(
    axis: Any,
    times: Floats,
    values: Floats,
    colour: str,
    *,
    steps: bool = False,
    fill: bool = False,
) -> float:
    """Draw values over time; return the height at which infinities are drawn."""
    top, ticks = _range(values)
    drawn = np.clip(values, -top, top)
    if len(times) > THINNED_ABOVE:
        middle, low, high = thinned(times, drawn)
        axis.fill_between(middle, low, high, color=colour, alpha=0.45, linewidth=0, step="mid", zorder=3)
        axis.plot(middle, (low + high) / 2, color=colour, linewidth=0.8, zorder=3)
        if fill:
            axis.fill_between(middle, 0, (low + high) / 2, color=colour, alpha=0.18, linewidth=0, zorder=2)
    else:
        marker = {"marker": "o", "markersize": 3.2} if len(times) <= 60 and not steps else {}
        style = "steps-mid" if steps else "default"
        axis.plot(times, drawn, color=colour, linewidth=1.4, drawstyle=style, zorder=3, **marker)
        if fill:
            axis.fill_between(times, 0, drawn, step="mid", color=colour, alpha=0.18, linewidth=0, zorder=2)
    if ticks:
        kept = sorted({0.0, *(t for t in axis.get_yticks() if abs(t) < top * 0.9)})
        places = [*kept, *ticks]
        axis.set_yticks(
            places, [*(number_text(float(f"{t:.6g}")) for t in kept), *("∞" if t > 0 else "-∞" for t in ticks)]
        )
    axis.margins(y=0.12)
    return top


def _range(values: Floats) -> tuple[float, list[float]]:
    """Return the height at which infinities are drawn, and which of the two there are."""
    finite = values[np.isfinite(values)]
    if len(finite) == len(values):
        return np.inf, []
    largest = float(np.abs(finite).max()) if len(finite) else 0.0
    top = 1.3 * largest if largest else 1.0
    return top, [sign * top for sign in (-1.0, 1.0) if (values == sign * np.inf).any()]
