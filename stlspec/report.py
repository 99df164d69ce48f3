"""Results for people: tables, reasons, the account after learning; and for spreadsheets, CSV.

In: rankings, reward maps, outcomes. Out: text on a stream. rich draws the tables and the progress bar; nothing
else imports it. The text is plain where the stream is no terminal, and wide enough that nothing is cut off.
"""

import csv
import io
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar
from rich.table import Table
from rich.text import Text

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import number
from stlspec.compiler.printing import counted
from stlspec.envs.model import Environment
from stlspec.formulas import FormulaResult
from stlspec.learning import Outcome
from stlspec.learning.account import sources, taught, way_on_map
from stlspec.learning.lessons import Source
from stlspec.learning.satisfaction import Satisfaction
from stlspec.rewards import RewardMap
from stlspec.scores import DemonstrationScore, Ranking, moment

Progress = Callable[[int, int, int], None]
_WIDTH_OF_FILES = 10_000
_STYLES = {"good": "green", "incomplete": "yellow", "bad": "red", "satisfied": "green", "violated": "red"}
_MARKS = {"satisfied": "✓", "violated": "✗", "undecided": "?"}


def console_for(stream: TextIO) -> Console:
    """Return a console for `stream`: of the terminal's width, or wide and plain for files and pipes."""
    if stream.isatty():
        return Console(file=stream, highlight=False, soft_wrap=False)
    return Console(file=stream, highlight=False, width=_WIDTH_OF_FILES, no_color=True)


def _print_table(table: Table, console: Console) -> None:
    """Print a table; in files and pipes without the blanks that fill up its last column."""
    if console.is_terminal:
        console.print(table)
        return
    with console.capture() as captured:
        console.print(table)
    console.file.write("".join(f"{line.rstrip()}\n" for line in captured.get().splitlines()))


def shown_number(value: float | None) -> str:
    """Write a number for a table: four significant digits, infinities as ∞."""
    if value is None:
        return "–"
    if abs(value) == float("inf"):
        return "∞" if value > 0 else "-∞"
    return f"{value:.4g}"


def json_bytes(document: Mapping[str, Any]) -> bytes:
    """Return a document as the bytes of a JSON file."""
    return (json.dumps(document, ensure_ascii=False, allow_nan=False, indent=1) + "\n").encode()


def print_ranking(ranking: Ranking, stream: TextIO) -> None:
    """Print the ranking as a table, best first, and under it why and when demonstrations fail."""
    console = console_for(stream)
    whole = ranking.at is None
    table = Table(box=None, pad_edge=False, header_style="bold")
    if whole:
        table.add_column("rank", justify="right")
    table.add_column("demonstration", overflow="fold")
    if whole:
        table.add_column("label")
        table.add_column("reward", justify="right")
    for name, strength, weight, _raw in ranking.requirements:
        table.add_column(f"{name}\n[dim]{strength} {weight:.3f}[/]", justify="right")
    for row in _best_first(ranking.demonstrations):
        cells: list[str | Text] = [_cell(row, name) for name, *_ in ranking.requirements]
        if whole:
            label = row.label or "undecided"
            head: list[str | Text] = [
                str(row.rank or "–"),
                Text(row.name),
                Text(label, _STYLES.get(label, "")),
                shown_number(row.reward),
            ]
        else:
            head = [Text(row.name)]
        table.add_row(*head, *cells)
    _print_table(table, console)
    _print_reasons(ranking, console)


def _best_first(rows: Sequence[DemonstrationScore]) -> list[DemonstrationScore]:
    return sorted(rows, key=lambda row: -(row.rank or 0))


def _cell(row: DemonstrationScore, name: str) -> Text:
    result = row.requirements[name].result
    mark = _MARKS[result.verdict.value]
    vacuous = " ∅" if result.vacuous else ""
    value = shown_number(result.robustness)
    if result.low is not None and result.low != result.high:
        value = f"[{shown_number(result.low)}, {shown_number(result.high)}]"
    text = f"{mark} {value}{vacuous}"
    return Text(text, _STYLES.get(result.verdict.value, ""))


def _print_reasons(ranking: Ranking, console: Console) -> None:
    lines = []
    vacuous = False
    for row in _best_first(ranking.demonstrations):
        for score in row.requirements.values():
            if score.reason:
                lines.append(f"{row.name}: {score.reason}")
            vacuous = vacuous or score.result.vacuous
    if lines:
        console.print()
        for line in lines:
            console.print(Text(line))
    if vacuous:
        console.print(Text("\n∅ decided by no sample, since none lies in the window; it counts 0 in the reward"))


def ranking_csv(ranking: Ranking) -> str:
    """Return the scores as CSV, one row for each demonstration and requirement."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(
        [
            "demonstration",
            "label",
            "reward",
            "rank",
            "requirement",
            "robustness",
            "bounded",
            "verdict",
            "vacuous",
            "witness_sample",
            "witness_time",
        ]
    )
    for row in ranking.demonstrations:
        whole = [row.label, row.reward, row.rank] if ranking.at is None else [None, None, None]
        for name, score in row.requirements.items():
            result, witness = score.result, score.result.witness
            place = [witness.sample, witness.time] if witness else [None, None]
            vacuous = str(result.vacuous).lower()
            values = [number(result.robustness), score.bounded, result.verdict.value, vacuous]
            writer.writerow([row.name, *whole, name, *values, *place])
    return out.getvalue()


def print_reward(reward: RewardMap, file: str, stream: TextIO) -> None:
    """Print where a reward map went, and what it holds."""
    values = reward.values
    console = console_for(stream)
    if not values:
        console.print(Text(f"{file}: 0 in every state"))
        return
    best = max(zip(values, reward.states, strict=True), key=lambda pair: pair[0])
    worst = min(values)
    console.print(
        Text(
            f"{file}: {counted(len(values), 'state')} with a reward, "
            f"from {shown_number(worst)} to {shown_number(best[0])}"
            f" (at {best[1]}), all others 0"
        )
    )


def formula_document(formula: str, results: Sequence[FormulaResult]) -> dict[str, Any]:
    """Return the `stlspec.eval/1` document."""
    rows = []
    for row in results:
        witness = row.result.witness
        rows.append(
            {
                "name": row.name,
                "robustness": number(row.result.robustness),
                "verdict": row.result.verdict.value,
                "vacuous": row.result.vacuous,
                "witness": {"sample": witness.sample, "time": witness.time} if witness else None,
            }
        )
    return {"schema": "stlspec.eval/1", "formula": formula, "results": rows}


def print_formula(results: Sequence[FormulaResult], stream: TextIO) -> None:
    """Print the value of a formula on each trace, and the sample that decides it."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("trace", "verdict", "robustness", "decided by"):
        table.add_column(heading, justify="right" if heading == "robustness" else "left", overflow="fold")
    for row in results:
        result, witness = row.result, row.result.witness
        where = f"{moment(result)}: {witness.reason}" if witness else result.reason
        verdict = Text(result.verdict.value, _STYLES.get(result.verdict.value, ""))
        table.add_row(Text(row.name), verdict, shown_number(result.robustness), Text(where))
    _print_table(table, console_for(stream))


@contextmanager
def progress(stream: TextIO) -> Iterator[Progress]:
    """Show episodes and steps as a bar on `stream`; silent where it is no terminal."""
    console = Console(file=stream)
    columns = (
        TextColumn("training"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("episodes, {task.fields[steps]:,} steps"),
        TimeRemainingColumn(),
    )
    with Bar(*columns, console=console, transient=True, disable=not stream.isatty()) as bar:
        task = bar.add_task("training", total=None, steps=0)

        def show(episode: int, episodes: int, env_steps: int) -> None:
            bar.update(task, completed=episode, total=episodes, steps=env_steps)

        yield show


@contextmanager
def files_progress(stream: TextIO, total: int) -> Iterator[Callable[[int, str], None]]:
    """Show files as a bar on `stream`, with rate and time left; silent where it is no terminal."""
    console = Console(file=stream)
    columns = (
        TextColumn("scoring"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("files, {task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    with Bar(*columns, console=console, transient=True, disable=not stream.isatty()) as bar:
        task = bar.add_task("scoring", total=total, rate="")

        def show(done: int, rate: str) -> None:
            bar.update(task, completed=done, rate=rate)

        yield show


def print_outcome(outcome: Outcome, bundle: BundleData, environment: Environment, out: Path, stream: TextIO) -> None:
    """Print what was learnt: requirements with margins, the path on the map, the training, the files."""
    console = console_for(stream)
    console.print(Text(_success(outcome), "bold green" if outcome.success else "bold yellow"))
    _print_table(_margins(outcome, bundle), console)
    drawing = way_on_map(environment, outcome.states)
    if drawing:
        console.print(Text("\n" + _heading_of_path(outcome)))
        console.print(Text("\n".join(drawing)))
    for block in (taught(outcome), _training_lines(outcome)):
        if block:
            console.print(Text("\n" + "\n".join(block)))
    for note in outcome.notes:
        console.print(Text(note))
    console.print(Text(f"\nFiles in {out}{os.sep}: {', '.join(sorted(outcome.files.values()))}"))


def _success(outcome: Outcome) -> str:
    """Say whether the policy meets the spec, so that one that never does is not taken for a success."""
    chance = outcome.satisfaction
    if chance is None:
        return f"The policy {'meets' if outcome.success else 'does not meet'} every requirement."
    said = [f"All requirements hold with probability {interval_of(chance)}."]
    never = [name for name, alone in chance.alone.items() if alone == 0.0]
    if never:
        where = "" if chance.n is None else f" in {chance.n} runs"
        said.append(f"{' and '.join(never)} never hold{'s' if len(never) == 1 else ''}{where}.")
    if not chance.meets_hard:
        odds = probability_text(chance.hard)
        said.append(
            f"The hard ones hold no more often than not (probability {odds}), so the policy does not meet them."
        )
    return " ".join(said)


def _margins(outcome: Outcome, bundle: BundleData) -> Table:
    """Return a row for each requirement: by how much it holds, or how likely it does where moves are by chance."""
    chance = outcome.satisfaction
    table = Table(box=None, pad_edge=False, show_header=False)
    for requirement in bundle.requirements:
        if chance is not None:
            alone = chance.alone[requirement.name]
            verdict = "satisfied" if alone == 1.0 else "violated" if alone == 0.0 else ""
            mark = Text(f"  {_MARKS.get(verdict, '~')} {requirement.name}", _STYLES.get(verdict, ""))
            often = f"with probability {probability_text(alone)}"
            if chance.n is not None:
                often = f"in {round(alone * chance.n):,} of {chance.n:,} runs"
            table.add_row(mark, requirement.strength, f"holds {often}")
            continue
        result = outcome.evaluation[requirement.name]
        verdict = result.verdict.value
        mark = Text(f"  {_MARKS[verdict]} {requirement.name}", _STYLES.get(verdict, ""))
        held = "holds" if verdict == "satisfied" else "fails"
        margin = f"{held} with robustness {shown_number(result.robustness)}"
        why = f"decided at {moment(result)}: {result.witness.reason}" if result.witness else ""
        table.add_row(mark, requirement.strength, margin, Text(why, "dim"))
    return table


def _heading_of_path(outcome: Outcome) -> str:
    """Say which goals the drawn path leads to, and which it does not reach."""
    reached, missed = outcome.goal_order[: len(outcome.stops)], outcome.goal_order[len(outcome.stops) :]
    goals = f" to {', then '.join(reached)}" if reached else ""
    goals += f" (samples {', '.join(map(str, outcome.stops))})" if len(outcome.stops) > 1 else ""
    lost = f" {' and '.join(missed)} {'is' if len(missed) == 1 else 'are'} not reached" if missed else ""
    return f"Its path{goals}, {counted(len(outcome.actions), 'step')}:{lost}"


def print_source(source: Source, stream: TextIO) -> None:
    """Print where the reward of a state comes from."""
    console_for(stream).print(Text("\n".join(sources(source))))


def probability_text(value: float) -> str:
    """Write a probability with three decimals, or as many as it takes to tell it from 0 and 1 where it is neither."""
    if value in (0.0, 1.0):
        return f"{value:.0f}"
    return next((text for text in (f"{value:.{k}f}" for k in range(3, 16)) if 0 < float(text) < 1), f"{value:.1e}")


def interval_of(found: Satisfaction) -> str:
    """Return a probability as text: the number where it is exact, else with its interval."""
    text = probability_text(found.value)
    if found.n is None:
        return text
    low, high = map(probability_text, (found.low, found.high))
    return f"{text} (95 % interval {low} to {high}, {found.n:,} runs)"


def _training_lines(outcome: Outcome) -> list[str]:
    training = outcome.training
    segments = max(outcome.log.segments, default=1)
    several = f" over {segments} segments, each trained once" if segments > 1 else ""
    lines = [
        f"{counted(training.episodes, 'episode')}{several}, {counted(training.env_steps, 'step')}, "
        f"{training.seconds:{'.1f' if training.seconds >= 0.1 else '.2g'}} s; "
        f"{counted(training.hard_violations, 'hard violation')}, {counted(training.masked, 'step')} masked"
        + (f" ({training.prefilled} of them known from bad demonstrations)" if training.prefilled else "")
    ]
    if training.env_steps_to_success is not None:
        lines.append(
            f"every check succeeds from episode {training.episodes_to_success:,} on "
            f"({training.env_steps_to_success:,} steps)"
        )
    return lines
