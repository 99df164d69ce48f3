"""Values over time as SVG: a curve with bounds, shaded spans and the samples that decide.

In: a `Chart`. Out: an SVG of bounded size, however long the trace: more samples than the chart has room for are
drawn as the band between the least and the greatest value of each stretch, so that no spike is lost. Infinities
are drawn a little beyond the largest finite value.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stlspec.markup.elements import Markup, element, join, number, short
from stlspec.markup.figures import figure, label

Floats = NDArray[np.float64]
Span = tuple[float, float]

WIDTH, HEIGHT = 500.0, 128.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 54.0, 12.0, 24.0, 20.0
_STRETCHES = 240
_MOST_MARKS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """One panel: values (n_samples,) at times (n_samples,), and what there is to see in them.

    role: "" for a signal, or the verdict of a requirement. bounds: heights of dashed lines. zero: draw the line at
    0. boolean: 0 and 1 stand for false and true. shaded: spans of time. marks: (time, value, name). unit: of the
    times, shown after the last one.
    """

    title: str
    description: str
    times: Floats
    values: Floats
    role: str = ""
    boolean: bool = False
    zero: bool = False
    bounds: tuple[float, ...] = ()
    shaded: tuple[Span, ...] = ()
    marks: tuple[tuple[float, float, str], ...] = ()
    unit: str = ""


@dataclass(frozen=True, slots=True)
class _Scale:
    """Maps time and value to pixels; values beyond `top` are drawn at it.

    low, high: a quarter of the values at the borders, since the difference of two large numbers may be infinite.
    """

    first: float
    last: float
    low: float
    high: float
    top: float

    def x(self, time: float) -> float:
        return _LEFT + (WIDTH - _LEFT - _RIGHT) * (time - self.first) / (self.last - self.first)

    def y(self, value: float) -> float:
        value = min(max(value, -self.top), self.top)
        return _TOP + (HEIGHT - _TOP - _BOTTOM) * ((self.high - value / 4) / (self.high - self.low))


def chart_svg(chart: Chart) -> Markup:
    """Draw a chart. Not in the paper: its figures show rewards. Returns: an SVG element, some 15 kB at most."""
    scale = _scale(chart)
    role = f" stl-{chart.role}" if chart.role else ""
    parts = [
        label(0, 14, short(chart.title, 72), "stl-name"),
        *_shades(chart.shaded, scale),
        _axes(chart, scale),
        *_levels(chart, scale),
        _curve(chart, scale, role),
        *_marks(chart.marks, scale),
    ]
    return figure(WIDTH, HEIGHT, chart.title, chart.description, *parts)


def robustness_svg(
    name: str,
    times: Floats,
    values: Floats,
    verdict: str,
    at: float,
    reported: float,
    unit: str = "",
    vacuous: bool = False,
) -> Markup:
    """Draw the robustness of a requirement at every sample.

    Paper: Definition 5, quantitative semantics, over time.

    Args: times, values: (n_samples,). at, reported: the time and the value that are reported.
    """
    title = f"{name}: {verdict}, robustness {number(reported)}" + (", vacuous" if vacuous else "")
    low, high = number(float(values.min())), number(float(values.max()))
    words = f"robustness over time, from {low} to {high}, reported at {number(at)}"
    marks = ((at, reported, number(reported)),)
    return chart_svg(Chart(title, words, times, values, role=verdict, zero=True, marks=marks, unit=unit))


def _scale(chart: Chart) -> _Scale:
    times = chart.times
    finite = chart.values[np.isfinite(chart.values)]
    levels = [*chart.bounds, *([0.0] if chart.zero else []), *([0.0, 1.0] if chart.boolean else [])]
    known = np.concatenate((finite, np.array(levels, dtype=np.float64)))
    low, high = (float(known.min()), float(known.max())) if len(known) else (-1.0, 1.0)
    top = np.inf
    if len(finite) < len(chart.values):
        top = min(1.3 * max(abs(low), abs(high)), 1.7e308) or 1.0
        low = -top if (chart.values == -np.inf).any() else low
        high = top if (chart.values == np.inf).any() else high
    low, high = low / 4, high / 4
    room = max((high - low) * 0.16, abs(high) * 1e-9, 1e-300) if high > low else max(abs(high), 0.25) / 2
    half = float(times[-1] - times[0]) / max(len(times) - 1, 1) / 2 if len(times) > 1 else 0.5
    return _Scale(float(times[0]) - half, float(times[-1]) + half, low - room, high + room, top)


def _axes(chart: Chart, scale: _Scale) -> Markup:
    base = HEIGHT - _BOTTOM
    frame = element("path", d=f"M{_LEFT} {_TOP}V{base}H{WIDTH - _RIGHT}", class_="stl-rule")
    unit = f" {chart.unit}" if chart.unit else ""
    first, last = number(float(chart.times[0])), number(float(chart.times[-1])) + unit
    ticks = [label(scale.x(float(chart.times[0])), HEIGHT - 5, first, "stl-small", "start")]
    if len(chart.times) > 1:
        ticks.append(label(scale.x(float(chart.times[-1])), HEIGHT - 5, last, "stl-small", "end"))
    return join([frame, *ticks, *(_height(v, name, scale) for v, name in _heights(chart, scale))])


def _heights(chart: Chart, scale: _Scale) -> list[tuple[float, str]]:
    if chart.boolean:
        return [(0.0, "false"), (1.0, "true")]
    finite = chart.values[np.isfinite(chart.values)]
    found = {float(v): f"{float(v) + 0.0:.3g}" for v in ((finite.min(), finite.max()) if len(finite) else ())}
    if scale.top < np.inf:
        found |= {s * scale.top: number(s * np.inf) for s in (-1.0, 1.0) if (chart.values == s * np.inf).any()}
    if chart.zero and all(abs(scale.y(v) - scale.y(0.0)) > 11 for v in found):
        found[0.0] = "0"
    return sorted(found.items())


def _height(value: float, name: str, scale: _Scale) -> Markup:
    return label(_LEFT - 8, scale.y(value) + 4, name, "stl-small", "end")


def _levels(chart: Chart, scale: _Scale) -> list[Markup]:
    rows = [(b, "stl-bound") for b in chart.bounds] + ([(0.0, "stl-zero")] if chart.zero else [])
    lines = [
        element("line", x1=_LEFT, x2=WIDTH - _RIGHT, y1=f"{scale.y(v):.1f}", y2=f"{scale.y(v):.1f}", class_=name)
        for v, name in rows
    ]
    return lines + [label(_LEFT + 3, scale.y(b) - 3, number(b), "stl-small stl-halo") for b in chart.bounds]


def _shades(spans: Sequence[Span], scale: _Scale) -> list[Markup]:
    parts = []
    for first, last in spans:
        left, right = scale.x(max(first, scale.first)), scale.x(min(last, scale.last))
        base, width = HEIGHT - _BOTTOM, max(right - left, 1.0)
        box = element("rect", x=f"{left:.1f}", y=_TOP, width=f"{width:.1f}", height=base - _TOP, class_="stl-shade")
        parts += [box, element("path", d=f"M{left:.1f} {_TOP}v{base - _TOP}m{width:.1f} 0V{_TOP}",
                               class_="stl-edge-of-shade", fill="none")]  # fmt: skip
    return parts


def _curve(chart: Chart, scale: _Scale, role: str) -> Markup:
    times, values = chart.times, chart.values
    if len(times) > 2 * _STRETCHES:
        starts = np.unique(np.linspace(0, len(times), _STRETCHES, endpoint=False).astype(np.int64))
        ends = np.append(starts[1:], len(times)) - 1
        middle = [scale.x(float(t)) for t in (times[starts] + times[ends]) / 2]
        above = [scale.y(float(v)) for v in np.maximum.reduceat(values, starts)]
        below = [scale.y(float(v)) for v in np.minimum.reduceat(values, starts)]
        points = [*zip(middle, above, strict=True), *reversed([*zip(middle, below, strict=True)])]
        return element("path", d=_line(points) + "Z", class_=f"stl-band{role}")
    points = [(scale.x(float(t)), scale.y(float(v))) for t, v in zip(times, values, strict=True)]
    if chart.boolean:
        edges = [scale.x(float(t)) for t in (times[1:] + times[:-1]) / 2]
        starts_at, ends_at = [scale.x(scale.first), *edges], [*edges, scale.x(scale.last)]
        heights = [y for _, y in points]
        points = [p for a, b, y in zip(starts_at, ends_at, heights, strict=True) for p in ((a, y), (b, y))]
    dots = [] if len(times) > 60 or chart.boolean else points
    circles = "".join(f"M{x - 2:.1f} {y:.1f}a2 2 0 1 0 4 0a2 2 0 1 0-4 0" for x, y in dots)
    return element("path", d=_line(points) + circles, class_=f"stl-curve{role}")


def _line(points: Sequence[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)


def _marks(marks: Sequence[tuple[float, float, str]], scale: _Scale) -> list[Markup]:
    """Mark deciding samples, those of one place once, each named; diamonds, so that colour is not needed."""
    places: dict[tuple[float, float], list[str]] = {}
    for time, value, name in marks:
        places.setdefault((scale.x(time), scale.y(value)), []).append(name)
    parts = []
    for (x, y), names in list(places.items())[:_MOST_MARKS]:
        after, above = x > WIDTH * 0.6, y > HEIGHT / 2
        at = (x - 8 if after else x + 8), (y - 7 if above else y + 14)
        parts.append(element("path", d=f"M{x:.1f} {y - 6:.1f}l6 6-6 6-6-6z", class_="stl-mark"))
        parts.append(label(*at, short(", ".join(names), 60), "stl-halo", "end" if after else "start"))
    return parts
