"""Pictures of demonstrations as SVG, for reports and notebooks; nothing beyond the standard library draws.

In: `Picture`s, as `contents` collects them. Out: one chart for each signal and each requirement, named and described
in words for those who cannot see it.
"""

from collections.abc import Sequence

from stlspec.markup.charts import Chart, chart_svg, robustness_svg
from stlspec.markup.elements import Markup, number
from stlspec.pictures.contents import Picture, RobustnessPanel, SignalPanel, joined


def panels(picture: Picture) -> list[Markup]:
    """Draw the signals and the requirements of one demonstration.

    Not in the paper: see `contents.picture_of`.

    Returns: SVG elements, signals first; they need `markup.figures.style()` on their page.
    """
    if not len(picture.times):
        return []
    signals = [chart_svg(_signal(panel, picture)) for panel in picture.signals]
    return [*signals, *(_robustness(panel, picture) for panel in picture.requirements)]


def _signal(panel: SignalPanel, picture: Picture) -> Chart:
    shaded = tuple(joined([span for _, span in panel.shaded]))
    unit = f" [{panel.unit}]" if panel.unit else ""
    words = [f"from {number(float(panel.values.min()))} to {number(float(panel.values.max()))}"]
    if shaded:
        names = ", ".join(dict.fromkeys(name for name, _ in panel.shaded))
        words.append(f"{names} violated {_spans(shaded)}")
    words += [f"{m.requirement} decided at {number(m.time)} by {number(m.value)}" for m in panel.marks]
    return Chart(
        f"{panel.name}{unit}", "; ".join(words), picture.times, panel.values,
        boolean=panel.boolean, bounds=panel.bounds, shaded=shaded,
        marks=tuple((m.time, m.value, m.requirement) for m in panel.marks), unit=_unit(picture),
    )  # fmt: skip


def _spans(spans: Sequence[tuple[float, float]]) -> str:
    shown = [f"from {number(first)} to {number(last)}" for first, last in spans[:5]]
    return ", ".join(shown) + (f" and {len(spans) - 5} times more" if len(spans) > 5 else "")


def _robustness(panel: RobustnessPanel, picture: Picture) -> Markup:
    mark, title = panel.mark, f"{panel.name} ({panel.strength})"
    verdict = mark.verdict.value
    return robustness_svg(
        title, picture.times, panel.values, verdict, mark.time, mark.value, _unit(picture), panel.vacuous
    )


def _unit(picture: Picture) -> str:
    return "" if picture.unit == "step" else picture.unit
