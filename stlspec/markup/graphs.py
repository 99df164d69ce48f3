"""The DAG of requirements as SVG: prerequisites left, dependants right, each with its weight.

In: a bundle. Out: an SVG without the edges that a longer path says already. Hard requirements have a thick square
frame and say so; the bar under a name is as long as its weight.
"""

from collections.abc import Mapping, Sequence

from stlspec.compiler.bundle import BundleData
from stlspec.markup.elements import Markup, element, short
from stlspec.markup.figures import figure, label

MOST_NODES = 60
"""A larger DAG is not drawn: nobody could read it; the table beside it says the same."""

_NODE_WIDTH, _NODE_HEIGHT, _GAP_X, _GAP_Y, _MARGIN = 196.0, 62.0, 72.0, 18.0, 6.0
_Place = tuple[float, float]


def dag_svg(bundle: BundleData) -> Markup | None:
    """Draw the DAG of requirements with raw and softmax weights.

    Paper: equation (1), dag_weights. Returns: an SVG element; None if there are none, or more than `MOST_NODES`.
    """
    if not 0 < len(bundle.requirements) <= MOST_NODES:
        return None
    parents = _reduced({r.name: r.depends_on for r in bundle.requirements})
    places = _places(parents)
    width = max(x for x, _ in places.values()) + _NODE_WIDTH + _MARGIN
    height = max(y for _, y in places.values()) + _NODE_HEIGHT + _MARGIN
    edges = [_edge(places[p], places[name]) for name, above in parents.items() for p in above]
    rows = zip(bundle.requirements, bundle.weights, bundle.raw_weights, strict=True)
    nodes = [_node(r.name, r.strength, w, raw, places[r.name]) for r, w, raw in rows]
    said = [f"{name} depends on {', '.join(above)}" for name, above in parents.items() if above]
    description = "; ".join(said) or "no requirement depends on another"
    return figure(width, height, "The requirements and what they depend on", description, *edges, *nodes)


def _reduced(parents: Mapping[str, Sequence[str]]) -> dict[str, list[str]]:
    """Return the direct prerequisites that no longer path leads to."""
    above: dict[str, set[str]] = {}
    for name in parents:
        found: set[str] = set()
        queue = list(parents[name])
        while queue:
            one = queue.pop()
            if one not in found:
                found.add(one)
                queue += parents[one]
        above[name] = found
    return {
        name: [p for p in dict.fromkeys(direct) if not any(p in above[q] for q in direct)]
        for name, direct in parents.items()
    }


def _places(parents: Mapping[str, Sequence[str]]) -> dict[str, _Place]:
    """Put each requirement right of all it depends on, near them; one without any in the first column."""
    depth: dict[str, int] = {}
    left = list(parents)
    while left:
        ready = [name for name in left if all(p in depth for p in parents[name])]
        depth |= {name: max((depth[p] + 1 for p in parents[name]), default=0) for name in ready}
        left = [name for name in left if name not in depth]
    columns: dict[int, list[str]] = {}
    for name in parents:
        columns.setdefault(depth[name], []).append(name)
    most = max(map(len, columns.values()))
    places: dict[str, _Place] = {}
    for column in sorted(columns):
        names = sorted(columns[column], key=lambda n: sum(places[p][1] for p in parents[n]) / max(len(parents[n]), 1))
        offset = (most - len(names)) * (_NODE_HEIGHT + _GAP_Y) / 2
        for row, name in enumerate(names):
            x = _MARGIN + column * (_NODE_WIDTH + _GAP_X)
            places[name] = x, _MARGIN + offset + row * (_NODE_HEIGHT + _GAP_Y)
    return places


def _node(name: str, strength: str, weight: float, raw: int, place: _Place) -> Markup:
    x, y = place
    hard = strength == "hard"
    frame = element(
        "rect", x=x, y=y, width=_NODE_WIDTH, height=_NODE_HEIGHT, rx=2 if hard else 14,
        class_="stl-node" + (" stl-hard" if hard else ""),
    )  # fmt: skip
    bar = element("rect", x=x + 12, y=y + 49, width=max((_NODE_WIDTH - 24) * weight, 1.0), height=4, class_="stl-bar")
    title = label(x + 12, y + 21, short(name, 24), "stl-name")
    share = label(x + 12, y + 39, f"{strength} · weight {weight:.3f} (raw {raw})", "stl-small")
    return element("g", element("title", f"{strength} {name}"), frame, title, share, bar)


def _edge(start: _Place, end: _Place) -> Markup:
    x1, y1 = start[0] + _NODE_WIDTH, start[1] + _NODE_HEIGHT / 2
    x2, y2 = end[0] - 7, end[1] + _NODE_HEIGHT / 2
    bend = _GAP_X * 0.55
    line = element("path", d=f"M{x1:.0f} {y1:.0f}C{x1 + bend:.0f} {y1:.0f} {x2 - bend:.0f} {y2:.0f} {x2:.0f} {y2:.0f}",
                   class_="stl-edge")  # fmt: skip
    head = element("path", d=f"M{x2 + 7:.0f} {y2:.0f}l-9 -4.5v9z", class_="stl-head")
    return element("g", line, head)
