"""Tables as HTML: of rows in general, and of scores.

In: rows of plain values. Out: a table with a caption and scoped headings, so that a screen reader can say where it
is. Verdicts have a sign and a word, never a colour alone.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from stlspec.markup.elements import Markup, element, join, number, short

SIGNS = {"satisfied": "✓", "violated": "✗", "undecided": "?"}
_WORDS = {"satisfied": "holds", "violated": "fails", "undecided": "undecided"}


class ScoreRow(NamedTuple):
    """A demonstration in the table: its cells are (verdict, robustness as text) of each requirement.

    href: where its name leads, if anywhere.
    """

    rank: int | None
    name: str
    label: str | None
    reward: float | None
    cells: Sequence[tuple[str, str]]
    href: str | None = None


def table(caption: str, headings: Sequence[object], rows: Iterable[Sequence[Markup]]) -> Markup:
    """Write a table: each row begins with its heading and consists of cells as `cell` makes them."""
    heads = [h if isinstance(h, Markup) and h.startswith("<th") else heading(h) for h in headings]
    head = element("tr", *heads)
    body = join(element("tr", *row) for row in rows)
    return element(
        "table", element("caption", caption), element("thead", head), element("tbody", body), class_="stl-table"
    )


def heading(content: object, kind: str | None = None) -> Markup:
    """Write the heading of a column."""
    return element("th", content, scope="col", class_=f"stl-{kind}" if kind else None)


def cell(*content: object, kind: str | None = None) -> Markup:
    """Write a cell; kind "number" aligns it to the right."""
    return element("td", *content, class_=f"stl-{kind}" if kind else None)


def verdict_text(verdict: str, value: str = "") -> Markup:
    """Write a verdict as a sign, a word for those who cannot see it, and a value."""
    sign = element("span", SIGNS[verdict], aria_hidden="true")
    word = element("span", f"{_WORDS[verdict]} ", class_="stl-sr")
    return element("span", sign, " ", word if value else _WORDS[verdict], value, class_=f"verdict {verdict}")


def score_table(caption: str, requirements: Sequence[tuple[str, str, float, int]], rows: Iterable[ScoreRow]) -> Markup:
    """Write the ranking, in the order of the rows.

    Paper: Algorithm 1, lines 3 to 7 and 12: label, r_d, rank.

    Args: requirements: name, strength, weight, raw weight of each.
    """
    named = [
        join([short(name, 40), element("br"), element("small", f"{strength} {weight:.3f}")])
        for name, strength, weight, _ in requirements
    ]
    return table(
        caption,
        [heading("Rank", "number"), "Demonstration", "Label", heading("Reward", "number"), *named],
        map(_score_cells, rows),
    )


def _score_cells(row: ScoreRow) -> list[Markup]:
    name = short(row.name)
    linked = element("a", name, href=row.href) if row.href else name
    label = row.label or "undecided"
    return [
        cell(row.rank if row.rank is not None else "–", kind="number"),
        element("th", linked, scope="row"),
        cell(element("span", label, class_=f"label {label}")),
        cell(number(row.reward), kind="number"),
        *(cell(verdict_text(verdict, value)) for verdict, value in row.cells),
    ]
