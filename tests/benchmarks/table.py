"""Sections of figures as text and as JSON.

In: sections, each with rows of figures and goals. Out: text for a person, a document for a program.
"""

from dataclasses import dataclass, field

from tests.benchmarks.contest import Figure


@dataclass(frozen=True)
class Row:
    """One contestant. ratio: how many times longer it takes than the first row of its section, if comparable."""

    label: str
    figure: Figure
    unit: str = "M samples/s"
    ratio: float | None = None
    note: str = ""


@dataclass(frozen=True)
class Goal:
    """A number and the bound it should keep; value None: it could not be measured.

    least, most: what the rounds allow; a bound between them is neither kept nor broken for certain.
    """

    text: str
    value: float | None
    bound: float
    at_least: bool = True
    least: float | None = None
    most: float | None = None

    @property
    def met(self):
        if self.value is None:
            return None
        return self.value >= self.bound if self.at_least else self.value <= self.bound

    @property
    def close(self):
        """Whether the bound lies within the spread of the rounds."""
        return self.least is not None and self.most is not None and self.least < self.bound < self.most


@dataclass
class Section:
    """Rows that belong together, with the goals that they decide."""

    title: str
    rows: list = field(default_factory=list)
    goals: list = field(default_factory=list)
    notes: list = field(default_factory=list)

    def contest(self, figures, unit="M samples/s", notes=None):
        """Add a row for each figure, with ratios to the first."""
        first = next(iter(figures.values())).median
        for label, figure in figures.items():
            ratio = figure.median / first if first and figure.median else None
            self.rows.append(Row(label, figure, unit, ratio, (notes or {}).get(label, "")))


_SCALES = {"us": 1e6, "ms": 1e3, "s": 1.0}


def number(value, unit):
    """Return seconds a sample as `unit` has it."""
    return 1e-6 / value if unit == "M samples/s" else value * _SCALES.get(unit, 1.0)


def text_of(section):
    """Return a section as lines of text."""
    lines = [section.title]
    width = max((len(row.label) for row in section.rows), default=0)
    for row in section.rows:
        figure = row.figure
        if figure.median is None:
            lines.append(f"  {row.label:<{width}}  -            {figure.error}")
            continue
        spread = sorted((number(figure.least, row.unit), number(figure.most, row.unit)))
        ratio = f"{row.ratio:>9.3g}x" if row.ratio is not None else " " * 10
        shown = f"{number(figure.median, row.unit):>9.4g} {row.unit}"
        note = f"  {row.note}" if row.note else ""
        lines.append(f"  {row.label:<{width}}  {shown:<22}{ratio}   {spread[0]:.3g} to {spread[1]:.3g}{note}")
    for goal in section.goals:
        sign = ">=" if goal.at_least else "<="
        word = {True: "met", False: "MISSED", None: "not measured"}[goal.met]
        value = "-" if goal.value is None else f"{goal.value:.3g}"
        doubt = f", but the rounds allow {goal.least:.3g} to {goal.most:.3g}" if goal.close else ""
        lines.append(f"  goal: {goal.text} {sign} {goal.bound:g}: {value}  {word}{doubt}")
    return "\n".join([*lines, *(f"  {note}" for note in section.notes)])


def document_of(sections, machine):
    """Return all sections as one JSON document."""
    return {
        "schema": "stlspec.benchmarks/1",
        "machine": machine,
        "sections": [
            {
                "title": section.title,
                "rows": [
                    {
                        "label": row.label,
                        "unit": row.unit if row.figure.median is not None else None,
                        "median": _in_unit(row.figure.median, row.unit),
                        "least": _in_unit(row.figure.least, row.unit),
                        "most": _in_unit(row.figure.most, row.unit),
                        "ratio": row.ratio,
                        "values": list(row.figure.values),
                        "note": row.note or None,
                        "error": row.figure.error or None,
                    }
                    for row in section.rows
                ],
                "goals": [
                    {
                        "goal": goal.text,
                        "value": goal.value,
                        "bound": goal.bound,
                        "at_least": goal.at_least,
                        "met": goal.met,
                        "least": goal.least,
                        "most": goal.most,
                    }
                    for goal in section.goals
                ],
                "notes": section.notes,
            }
            for section in sections
        ],
    }


def _in_unit(value, unit):
    return None if value is None else number(value, unit)
