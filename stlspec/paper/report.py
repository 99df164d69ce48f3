"""The report: what was claimed, what was found, and on which machine, as one Markdown document.

In: records of experiments and the names of figures. Out: text. Sections of experiments that were not run are left
out; verdicts come from `claims`.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from stlspec.compiler.printing import counted
from stlspec.paper import tables
from stlspec.paper.claims import CLAIMS, Results, Verdict, judge, rows_of
from stlspec.paper.experiments import PLAIN, STANDARD, rows_from_json
from stlspec.paper.handmade import BY_DISTANCE
from stlspec.paper.journal import Record
from stlspec.paper.spread import duration
from stlspec.paper.worth import NOTHING

TITLE = "Learning from Demonstrations using Signal Temporal Logic, reproduced"

INTRODUCTION = """\
Puranic, Deshmukh and Nikolaidis, *Learning from Demonstrations using Signal Temporal Logic*, CoRL 2020. The authors
published no code, no maps and no demonstrations; this report runs their experiments by `python -m stlspec.paper` on
maps and demonstrations drawn with fixed seeds. Verdicts are decided by the rules that stand beside them, in code.
"""

DIFFERENCES = """\
- The printed third requirement, `F[0,T](t <= T_goal)`, is true of every trace; here it is
  `eventually[0, T_goal] (d_goal < 1)` with T_goal by breadth-first search, so that success means a shortest path.
- "LfD+STL" is the reward of the spec (+1 at the goal, -1 for a violation, -0.01 a step) with the inferred reward as
  a potential, which leaves the best policies unchanged; Algorithm 2 as printed is measured apart.
- A step that was seen to violate a hard requirement is not taken again (the mask). The paper has none, so
  both methods are measured with and without it: "standard" is Q-learning without demonstrations and without mask.
- alpha 0.1, gamma 0.99, epsilon 0.4 and 3000 to 10000 episodes are the paper's; Mountain Car has 1000 steps an episode.
- Steps to success count training steps up to the first check of the greedy policy (every 25 episodes) from which on
  all checks succeed. Quartiles are over seeds; on grids every seed has another map.
"""

NOTES = {
    "two-goals": "Both orders of the goals are trained in full before the better one is chosen, so the steps up to "
    "success are mostly those of training the other order: they say nothing about the demonstrations.",
    "hand-crafted": "Sparse: +1 at the goal, -1 for a violation, -0.01 a step. By distance: besides, up to -0.1 a "
    "step, the farther from the goal it ends. The paper does not say which hand-crafted reward it compares with.",
    "car": "Plain has the reward of the spec and no demonstrations, standard the environment's own -1 a step: what "
    "lies between shaped and plain is due to the demonstrations, what lies between plain and standard to the reward.",
    "lakes": "The paper's figures 4a and 4b show steps in each episode, without numbers in the text, so no ratio to "
    "its figures can be given. An episode that ends in a hole is short: steps per episode alone would flatter a "
    "method that falls into holes, which is why steps up to success are compared.",
}
"""What is to be known to read a table."""

NOT_EXAMINED = """\
That MCE-IRL cannot learn the reward of several goals, or of scattered obstacles, that rewards are easier to interpret,
and that several demonstrators may follow their own preferences: nothing is measured here that would decide it.
"""

FIGURES = (
    ("Rewards and ground truth", ("truth-",)),
    ("Demonstrations, rewards and policies", ("map-", "car-reward")),
    ("Unseen maps", ("unseen-",)),
    ("Exploration", ("exploration-", "steps-")),
)
"""Headings of figures, and how the names of their files begin."""


def write(records: Mapping[str, Record], figures: Sequence[str] = (), folder: str = "figures") -> str:
    """Write the report.

    Args:    records: by name of the experiment. figures: names of files in `folder`, beside the report.
    Returns: Markdown.
    """
    results = {name: record.result for name, record in records.items()}
    parts = [f"# {TITLE}", INTRODUCTION.rstrip(), _measured(records), _claims(results)]
    parts += [f"## {heading}\n\n{text}" for heading, text in sections(results)]
    parts += [f"## {heading}\n\n{_images(names, folder)}" for heading, names in _sorted(figures)]
    parts.append(f"## Claims that are not examined\n\n{NOT_EXAMINED.rstrip()}")
    parts.append(f"## What is done differently\n\n{DIFFERENCES.rstrip()}")
    return "\n\n".join(parts) + "\n"


def _measured(records: Mapping[str, Record]) -> str:
    """Say how much was measured, how long it took, and on what."""
    if not records:
        return "Nothing was measured."
    last = list(records.values())[-1]
    budget, seconds = last.budget, sum(record.seconds for record in records.values())
    loads = [load for record in records.values() for load in record.load]
    kept = ", ".join(f"{key} {value}" for key, value in last.machine.items())
    cars = ", ".join(f"{count} with {bins}" for bins, count in budget["car_seeds"])
    return "\n".join([
        f"- Budget: {budget['name']}: {budget['seeds']} seeds; on Mountain Car {cars} bins, "
        f"{budget['car_episodes']} episodes each.",
        f"- Time: {duration(seconds)} in all, for {counted(len(records), 'experiment')}.",
        f"- Machine: {kept}.",
        f"- Processes that wanted a processor while measuring: {min(loads)} to {max(loads)}.",
    ])  # fmt: skip


def verdicts(results: Results) -> str:
    """Write the claims with their verdicts, as a table."""
    return tables.table(["claim", "verdict"], [[c.says, str(judge(c, results).verdict)] for c in CLAIMS])


def _claims(results: Results) -> str:
    found = {claim: judge(claim, results) for claim in CLAIMS}
    counts = {v: sum(f.verdict is v for f in found.values()) for v in Verdict}
    summary = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    lines = ["## Claims of the paper", "", f"{len(found)} claims: {summary}.", "", verdicts(results), ""]
    for claim, finding in found.items():
        lines += [
            f"- **{claim.says}** {finding.verdict.capitalize()}.",
            f"  - measured: {finding.evidence}",
            f"  - reproduced means: {claim.rule}",
        ]
    return "\n".join(lines)


def sections(results: Results) -> list[tuple[str, str]]:
    """Return headings and tables of what was measured."""
    found = []
    if any(name.startswith("table-1-") for name in results):
        found.append(("Table 1: time to infer the reward", f"{tables.table_1(results)}\n\n{_table_1_notes(results)}"))
        if any(result.get("truth") for result in results.values()):
            text = f"{tables.accuracy(results)}\n\nPearson's correlation with the paper's ground truth, all states."
            text += f"\n\n{tables.few(results['irl-demos'])}" if "irl-demos" in results else ""
            found.append(("How near the rewards come to the ground truth", text))
    for name, heading, against in (
        ("grids", "Single-goal grids", STANDARD),
        ("two-goals", "Two goals", PLAIN),
        ("lakes", "FrozenLake: exploration", STANDARD),
        ("hand-crafted", "Hand-crafted rewards, with the same mask", BY_DISTANCE),
        ("transfer", "FrozenLake: unseen maps", PLAIN),
        ("ablation", "With some of the demonstrations", "none"),
    ):
        if name in results:
            text = tables.learning(rows_of(results, name), against)
            found.append((heading, f"{text}\n\n{NOTES[name]}" if name in NOTES else text))
    if "rewards" in results:
        found.append(("What the reward of MCE-IRL is good for", _rewards(results["rewards"])))
    if "letter" in results:
        found.append(("Algorithm 2 as printed", tables.letter(rows_of(results, "letter"))))
    cars = {group: by for name in results if name.startswith("car-") for group, by in rows_of(results, name).items()}
    return [*found, ("Mountain Car", f"{tables.car(cars)}\n\n{NOTES['car']}")] if cars else found


def _rewards(result: Mapping[str, Any]) -> str:
    lines = [f"- {name}: {note}." for name, note in result["notes"].items()]
    parts = ["How MCE-IRL was trained:", "\n".join(lines)]
    if result["asked"]:
        parts += [
            "What the best policy for a reward alone does: planned with the known transitions of each map, the goal "
            "absorbing, judged by the spec.",
            tables.asked_for(result["asked"]),
            "What a reward does for the learner, shaped by it, with the same bad demonstrations for the mask. A reward "
            "that says nothing shapes too: hope makes the learner try what it has not tried.",
            tables.learning(rows_from_json(result["rows"]), NOTHING),
            "What MCE-IRL does better: it needs no spec, takes chance into account, and has a value for every state. "
            "What it does not know is what must not happen: no expert showed it.",
        ]
    return "\n\n".join(parts)


def _table_1_notes(results: Results) -> str:
    measured = {n.removeprefix("table-1-"): r for n, r in results.items() if n.startswith("table-1-")}
    cold = ", ".join(f"{name} {tables.seconds(r['ours'].get('cold'))}" for name, r in measured.items())
    lines = [
        "Times of the STL reward are those of the inference alone; a fresh process that reads spec, map and "
        f"demonstrations and infers the reward takes: {cold}. The paper does not say what its times include.",
    ]
    lines.append("\n".join(f"- MCE-IRL on {name}: {_irl_note(r['irl'])}." for name, r in measured.items()))
    if any(r["irl"]["extrapolated"] for r in measured.values()):
        lines.append("\\* a few gradient steps were timed and extrapolated to the whole budget.")
    return "\n\n".join(lines)


def _irl_note(irl: Mapping[str, Any]) -> str:
    if irl["skipped"]:
        return f"not measured: {irl['skipped']}"
    return f"{irl['note']}; budget {irl['iterations']} gradient steps, horizon {irl['horizon']}"


def _sorted(figures: Sequence[str]) -> Iterable[tuple[str, list[str]]]:
    for heading, beginnings in FIGURES:
        names = [name for name in figures if name.startswith(beginnings)]
        if names:
            yield heading, names


def _images(names: Sequence[str], folder: str) -> str:
    return "\n\n".join(f"![{name.removesuffix('.png')}]({folder}/{name})" for name in names)
