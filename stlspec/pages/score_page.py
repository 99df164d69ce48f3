"""The report on scores: one HTML file to hand to a colleague.

In: a spec, its ranking, the demonstrations. Out: a page with the DAG of requirements, the ranking, the inferred
reward on the map, and for each demonstration its signals with violations shaded and the sub-formula that decided.
Its size is bounded: of very many demonstrations the best and the worst are shown, and the page says so.
"""

from collections.abc import Iterable, Sequence
from itertools import chain, zip_longest

from stlspec import __version__
from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.compiler.printing import counted
from stlspec.demos import Demonstration
from stlspec.envs.model import Environment
from stlspec.markup.elements import Markup, element, join, short
from stlspec.markup.graphs import dag_svg
from stlspec.markup.tables import cell, heading, score_table, table
from stlspec.pages.demonstration import MOST_EXPLAINED, demonstration_section
from stlspec.pages.frame import document
from stlspec.pages.reward import RewardView, reward_section, reward_view
from stlspec.sampling import OnNan
from stlspec.scores import Ranking

MOST_BYTES = 12_000_000
"""Pictures of demonstrations take no more than this, and the last one begun."""

MOST_REASONS = 2000
"""So many values are explained, some 5 ms each."""

MOST_PICTURED, MOST_ROWS, MOST_CELLS = 100, 2000, 60_000
_UNFOLDED_UP_TO = 4


def score_page(
    bundle: BundleData,
    ranking: Ranking,
    demonstrations: Sequence[Demonstration] = (),
    environment: Environment | None = None,
    *,
    on_nan: OnNan = "refuse",
    resample: int | None = None,
) -> str:
    """Write the report.

    Not in the paper: a report on Algorithm 1.

    Args:    ranking: of `demonstrations`. environment: as for `score`; without one that knows their states, and
             where a label is open, the part on the reward says why there is none. on_nan, resample: as it was made.
    Returns: an HTML document that needs nothing else.
    """
    view = reward_view(bundle, ranking, demonstrations, environment, on_nan, resample)
    order = ranking.best_first()
    sections = _sections(bundle, ranking, order, view)
    linked = {k for k, _ in sections}
    title = bundle.title or bundle.name or "Requirements"
    body = join(
        [
            element("a", "Skip to the contents", href="#contents", class_="skip"),
            _header(bundle, ranking, title),
            element(
                "main",
                _requirements(bundle, ranking),
                _ranking(ranking, order, linked),
                reward_section(view),
                _demonstrations(ranking, [section for _, section in sections]),
                id="contents",
            ),
            element(
                "footer", f"stlspec {__version__} · spec {meaning_sha256(bundle)[:12]} · this file asks no network"
            ),
        ]
    )
    return document(f"{short(title)} · stlspec", body, "score.css", "score.js")


def _header(bundle: BundleData, ranking: Ranking, title: str) -> Markup:
    labels = [d.label or "undecided" for d in ranking.demonstrations]
    counts = [
        element("li", element("span", f"{labels.count(name)} {name}", class_=f"label {name}"))
        for name in ("good", "incomplete", "bad", "undecided")
        if name in labels and ranking.at is None
    ]
    at = "" if ranking.at is None else f", values at sample {ranking.at}"
    said = f"{counted(len(labels), 'demonstration')} against {counted(len(bundle.requirements), 'requirement')}{at}"
    links = [("requirements", "Requirements"), ("ranking", "Ranking"), ("reward", "Reward"), ("why", "Demonstrations")]
    items = [element("li", element("a", name, href=f"#{key}")) for key, name in links]
    return element(
        "header",
        element("h1", short(title)),
        element("p", said, class_="lead"),
        element("ul", *counts, class_="counts") if counts else None,
        element("nav", element("ul", *items), aria_label="Parts of the report"),
    )


def part(key: str, title: str, *contents: object) -> Markup:
    """Write a part of the page under its heading."""
    return element(
        "section", element("h2", title, id=f"{key}-heading"), *contents, id=key, aria_labelledby=f"{key}-heading"
    )


def _requirements(bundle: BundleData, ranking: Ranking) -> Markup:
    graph = dag_svg(bundle)
    caption = "An arrow leads from a requirement to those that depend on it; what others depend on weighs more."
    figure = (
        element("figure", element("div", graph, class_="scroll"), element("figcaption", caption)) if graph else None
    )
    rows = [
        [
            element("th", short(r.name), scope="row"),
            cell(r.strength),
            cell(f"{weight:.3f}", element("small", f" ({raw})"), kind="number"),
            cell(_held(ranking, r.name), kind="number"),
            cell(element("code", short(r.text, 300)), *([element("br"), short(r.doc, 300)] if r.doc else [])),
        ]
        for r, weight, raw in zip(bundle.requirements, bundle.weights, bundle.raw_weights, strict=True)
    ]
    headings = ["Requirement", "Strength", heading("Weight (raw)", "number"), heading("Held by", "number"), "Formula"]
    listed = element("div", table("All requirements, as the spec has them", headings, rows), class_="scroll")
    return part("requirements", "Requirements", figure, listed)


def _held(ranking: Ranking, name: str) -> str:
    verdicts = [d.requirements[name].result.verdict.value for d in ranking.demonstrations]
    return f"{verdicts.count('satisfied')} of {len(verdicts)}"


def ends_of(order: Sequence[int], at_most: int) -> list[int]:
    """Return the first and the last of a list, together at most so many; the first ones get the odd one."""
    if len(order) <= at_most:
        return list(order)
    last = at_most // 2
    return [*order[: at_most - last], *order[len(order) - last :]]


def _ranking(ranking: Ranking, order: Sequence[int], linked: set[int]) -> Markup:
    at_most = min(MOST_ROWS, MOST_CELLS // max(len(ranking.requirements), 1))
    shown = ends_of(order, at_most)
    rows = [ranking.demonstrations[k].row(f"#d{k}" if k in linked else None) for k in shown]
    left = len(order) - len(shown)
    caption = "Best first; rank 1 is the worst, equal ones share it. Under each requirement its weight."
    if left:
        caption += f" Between the best and the worst, {counted(left, 'demonstration')} are left out."
    tools = element(
        "div",
        element("label", "Show only rows with", element("input", type="search", id="filter"), hidden=True),
        element("span", id="found", role="status", class_="muted"),
        class_="tools",
    )
    listed = element("div", score_table(caption, ranking.requirements, rows), class_="scroll")
    return part("ranking", "Ranking", tools if len(rows) > 8 else None, listed)


def _sections(bundle: BundleData, ranking: Ranking, order: Sequence[int], view: RewardView) -> list[tuple[int, Markup]]:
    """Write the parts on demonstrations, worst and best by turns until there are enough; return them best first."""
    each = max(min(len(ranking.requirements), MOST_EXPLAINED), 1)
    chosen = ends_of(order, min(MOST_PICTURED, MOST_REASONS // each))
    half = (len(chosen) + 1) // 2
    turns = chain.from_iterable(zip_longest(reversed(chosen[half:]), chosen[:half]))
    found: dict[int, Markup] = {}
    room = MOST_BYTES
    for k in (k for k in turns if k is not None):
        if room <= 0:
            break
        unfolded = len(order) <= _UNFOLDED_UP_TO
        path = view.paths.get(k) if view.paths else None
        found[k] = demonstration_section(bundle, ranking.demonstrations[k], k, path, unfolded=unfolded)
        room -= len(found[k])
    return [(k, found[k]) for k in order if k in found]


def _demonstrations(ranking: Ranking, sections: Iterable[Markup]) -> Markup:
    listed = list(sections)
    words = "The shaded spans are where a requirement is violated; the diamonds are the samples that decide."
    left = len(ranking.demonstrations) - len(listed)
    if left:
        words += f" Shown are the best and the worst; {counted(left, 'demonstration')} between them are left out."
    unfold = element("button", "Unfold all", type="button", id="all", hidden=True) if len(listed) > 1 else None
    return part("why", "Demonstrations", element("p", words, class_="lead"), unfold, *listed)
