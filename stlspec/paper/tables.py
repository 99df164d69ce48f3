"""The tables of the report: Table 1 with both methods, and what the learning experiments gave.

In: results of experiments. Out: Markdown, which a terminal shows as well. A cell of something that was not measured
says so.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from stlspec.paper.cases import PUBLISHED, TABLE_1, case_of
from stlspec.paper.runs import Row, Rows
from stlspec.paper.spread import ratios, short, spread

NOT_MEASURED = "not measured"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Write a Markdown table, columns as wide as their widest cell; all but the first to the right."""
    widths = [max(3, *map(len, column)) for column in zip(head, *rows, strict=True)]

    def line(cells: Sequence[str]) -> str:
        first, *others = cells
        padded = [first.ljust(widths[0]), *(c.rjust(w) for c, w in zip(others, widths[1:], strict=True))]
        return f"| {' | '.join(padded)} |"

    ruler = ["-" * widths[0], *("-" * (w - 1) + ":" for w in widths[1:])]
    return "\n".join([line(head), line(ruler), *map(line, rows)])


def seconds(value: float | None) -> str:
    """Write a time."""
    if value is None:
        return NOT_MEASURED
    return f"{1e3 * value:.3g} ms" if value < 1 else f"{short(value)} s"


def table_1(results: Mapping[str, Mapping[str, Any]]) -> str:
    """Write Table 1: for both methods demonstrations and time, as the paper has them and as measured.

    Paper: Table 1. The last two columns say how many times longer MCE-IRL takes; both were timed in one run.
    """
    head = [
        "", "method", "demos: paper", "here", "time: paper", "measured", "measured / paper", "times slower: paper",
        "measured",
    ]  # fmt: skip
    rows = [row for name in TABLE_1 for row in _table_1_rows(name, results.get(f"table-1-{name}") or {})]
    return table(head, rows)


def _table_1_rows(name: str, result: Mapping[str, Any]) -> list[list[str]]:
    printed, bound = PUBLISHED[name], ">" if PUBLISHED[name].at_least else ""
    ours, irl = result.get("ours") or {}, result.get("irl") or {}
    mine, theirs = ours.get("seconds"), irl.get("seconds")
    mark = " *" if irl.get("extrapolated") else ""
    return [
        [
            case_of(name).title, "STL reward", printed.demos, _count(ours.get("demonstrations")),
            seconds(printed.seconds), seconds(mine), _ratio(mine, printed.seconds), "", "",
        ],
        [
            "", "MCE-IRL", printed.irl_demos, _count(irl.get("demonstrations") or None),
            bound + seconds(printed.irl_seconds),
            seconds(theirs) + mark, _ratio(theirs, printed.irl_seconds),
            bound + _ratio(printed.irl_seconds, printed.seconds), _ratio(theirs, mine),
        ],
    ]  # fmt: skip


def _count(value: int | None) -> str:
    return "-" if value is None else str(value)


def _ratio(above: float | None, below: float | None) -> str:
    return "-" if above is None or below is None else short(above / below)


def learning(rows: Rows, against: str) -> str:
    """Write what learning took, by group and method, with quartiles over the seeds.

    Args: against: the method that the others are compared with, seed by seed.
    """
    head = [
        "",
        "method",
        "runs",
        "all met",
        "hard met",
        "steps to success",
        f"times fewer than {against}",
        "violations",
    ]
    lines = []
    for group, by in rows.items():
        for method, found in by.items():
            base = by.get(against)
            lines.append([
                group, method, str(len(found)), _share(found, lambda r: r.success), _share(found, lambda r: r.hard),
                str(spread(r.to_success for r in found)), _against(base, found) if method != against else "",
                str(spread(r.violations for r in found)),
            ])  # fmt: skip
    return table(head, lines)


def _share(rows: Sequence[Row], of: Callable[[Row], bool]) -> str:
    return f"{sum(map(of, rows))}/{len(rows)}"


def _against(base: Sequence[Row] | None, rows: Sequence[Row]) -> str:
    if base is None:
        return ""
    found = ratios([r.to_success for r in base], [r.to_success for r in rows])
    return str(spread(found)) if found else "-"


def car(rows: Rows) -> str:
    """Write what learning on Mountain Car took.

    Paper: figure 4c, average steps of exploration.
    """
    head = ["", "method", "runs", "steps per episode", "least", "most", "flag reached by the policy", "training"]
    lines = []
    for group, by in rows.items():
        for method, found in by.items():
            steps = [row.mean_steps for row in found]
            reached = spread(row.probability for row in found)
            lines.append([
                group, method, str(len(found)), str(spread(steps)), short(min(steps)), short(max(steps)),
                f"{reached.median:.1%}", seconds(spread(row.seconds for row in found).median),
            ])  # fmt: skip
    return table(head, lines)


def letter(rows: Rows) -> str:
    """Write what became of Algorithm 2 as printed."""
    head = ["", "runs", "all met", "hard met", "circles for reward", "violations"]
    lines = [
        [
            group, str(len(found)), _share(found, lambda r: r.success), _share(found, lambda r: r.hard),
            _share(found, lambda r: r.farming), str(spread(r.violations for r in found)),
        ]
        for group, by in rows.items()
        for found in by.values()
    ]  # fmt: skip
    return table(head, lines)


def accuracy(results: Mapping[str, Mapping[str, Any]]) -> str:
    """Write how near rewards come to the ground truth of the paper, as a correlation over all states.

    Paper: figure 5.
    """
    head = ["", "STL reward", "states with a value", "MCE-IRL"]
    lines = []
    for name in TABLE_1:
        result = results.get(f"table-1-{name}") or {}
        if result.get("truth"):
            ours, irl = result["ours"], result.get("irl") or {}
            known = f"{ours['valued']} of {ours['states']}"
            lines.append(
                [case_of(name).title, _signed(ours.get("correlation")), known, _signed(irl.get("correlation"))]
            )
    return table(head, lines)


def few(result: Mapping[str, Any]) -> str:
    """Write what MCE-IRL makes of more and more demonstrations."""
    pairs = zip(result["counts"], result["rows"], strict=True)
    rows = [[str(count), _signed(row.get("correlation")), seconds(row.get("seconds"))] for count, row in pairs]
    return table(["MCE-IRL, demonstrations", "correlation", "time"], rows)


def _signed(value: float | None) -> str:
    return NOT_MEASURED if value is None else f"{value:+.2f}"


def asked_for(asked: Mapping[str, Mapping[str, Mapping[str, Any]]]) -> str:
    """Write what the policies do that are best for a reward alone, see `worth.asked_for`."""
    head = ["", "reward", "demonstrated map", "unseen maps", "hard met", "goal reached", "all met"]
    lines = [
        [
            case_of(name).title, method, "all met" if found["home"]["all"] else "not all met", str(found["maps"]),
            *(str(found[key]) for key in ("hard", "reached", "all")),
        ]
        for name, by in asked.items()
        for method, found in by.items()
    ]  # fmt: skip
    return table(head, lines)
