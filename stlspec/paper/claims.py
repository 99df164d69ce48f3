"""The claims of the paper, and for each whether it reproduces, decided by a rule that is written down here.

In: the results of experiments by name. Out: a `Finding` for each claim: reproduced, partly, not, or not measured,
with the figures that decide. No verdict is written by hand: thresholds stand in the claims themselves.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from stlspec.paper.experiments import LETTER, SHAPED, STANDARD, UNMASKED, rows_from_json
from stlspec.paper.handmade import BY_DISTANCE
from stlspec.paper.runs import Row, Rows
from stlspec.paper.spread import Spread, ratios, short, spread

Results = Mapping[str, Mapping[str, Any]]
"""Results of experiments, as JSON, by the name of the experiment."""


class Verdict(StrEnum):
    """What became of a claim; the texts follow "the claim is"."""

    REPRODUCED = "reproduced"
    PARTLY = "partly reproduced"
    NOT = "not reproduced"
    UNKNOWN = "not measured"


@dataclass(frozen=True, slots=True)
class Finding:
    """What was found out about a claim: the verdict, and the figures behind it."""

    verdict: Verdict
    evidence: str


@dataclass(frozen=True, slots=True)
class Claim:
    """One claim.

    name: one word. says: the paper's claim. rule: when it counts as reproduced and as partly reproduced. needs:
    experiments. judge: applies the rule; called only if all that is needed was measured.
    """

    name: str
    says: str
    rule: str
    needs: tuple[str, ...]
    judge: Callable[[Results], Finding]


ALL, MOST, HALF = 1.0, 0.95, 0.5
"""Shares of runs."""


def by_share(share: float, full: float = MOST, part: float = HALF) -> Verdict:
    """Judge a share: reproduced from `full` on, partly from `part` on."""
    return Verdict.REPRODUCED if share >= full else Verdict.PARTLY if share >= part else Verdict.NOT


LEAST = 1.1
"""A median this many times fewer is more than noise."""


def by_ratio(found: Spread) -> Verdict:
    """Judge how many times fewer: by the median at least `LEAST`, and fewer in three quarters of the seeds or not."""
    if found.median < LEAST:
        return Verdict.NOT
    return Verdict.REPRODUCED if found.low > 1 else Verdict.PARTLY


def worst(verdicts: Sequence[Verdict]) -> Verdict:
    """Judge a claim about several groups: reproduced in all, partly if in some, else not."""
    if all(v is Verdict.REPRODUCED for v in verdicts):
        return Verdict.REPRODUCED
    return Verdict.NOT if all(v is Verdict.NOT for v in verdicts) else Verdict.PARTLY


def rows_of(results: Results, name: str) -> Rows:
    """Return the rows of an experiment that learns."""
    return rows_from_json(results[name])


def share(rows: Sequence[Row], of: Callable[[Row], bool]) -> float:
    """Return the share of rows for which something holds."""
    return sum(map(of, rows)) / len(rows)


def _shares(rows: Rows, method: str, of: Callable[[Row], bool]) -> dict[str, float]:
    return {group: share(by[method], of) for group, by in rows.items() if method in by}


def _shown(shares: Mapping[str, float], seeds: int) -> str:
    return "; ".join(f"{group}: {value * seeds:.0f} of {seeds}" for group, value in shares.items())


def _succeeds(experiment: str, method: str) -> Callable[[Results], Finding]:
    def judge(results: Results) -> Finding:
        rows = rows_of(results, experiment)
        shares = _shares(rows, method, lambda row: row.success)
        seeds = max(len(by[method]) for by in rows.values())
        return Finding(worst([by_share(s) for s in shares.values()]), _shown(shares, seeds))

    return judge


def _fewer(experiment: str, of: Callable[[Row], float | None]) -> Callable[[Results], Finding]:
    """Compare LfD+STL with standard Q-learning: what counts is LfD+STL without the mask, which the paper has not."""

    def judge(results: Results) -> Finding:
        verdicts, parts = [], []
        for group, by in rows_of(results, experiment).items():
            bare, masked = (spread(ratios(_all(by[STANDARD], of), _all(by[m], of))) for m in (UNMASKED, SHAPED))
            verdicts.append(by_ratio(bare))
            parts.append(f"{group}: {bare} times fewer (with the mask {masked})")
        return Finding(worst(verdicts), "; ".join(parts))

    return judge


def _explores(results: Results) -> Finding:
    """Compare with standard Q-learning, and with a reward by distance, where both have the mask."""
    standard = _fewer("lakes", _to_success)(results)
    verdicts, parts = [standard.verdict], [f"than standard: {standard.evidence}"]
    for group, by in rows_of(results, "hand-crafted").items():
        if group.startswith("lake"):
            found = spread(ratios(_all(by[BY_DISTANCE], _to_success), _all(by[SHAPED], _to_success)))
            verdicts.append(by_ratio(found))
            parts.append(f"than with a reward by distance, both with the mask, {group}: {found} times fewer")
    return Finding(worst(verdicts), "; ".join(parts))


def _to_success(row: Row) -> int | None:
    return row.to_success


def _all(rows: Sequence[Row], of: Callable[[Row], float | None]) -> list[float | None]:
    return [of(row) for row in rows]


def _faster(results: Results) -> Finding:
    rows = {n.removeprefix("table-1-"): r for n, r in results.items() if n.startswith("table-1-")}
    found = {n: r["irl"]["seconds"] / r["ours"]["seconds"] for n, r in rows.items() if r["irl"]["seconds"] is not None}
    missing = {n: r["irl"]["skipped"] for n, r in rows.items() if n not in found}
    lacking = f"MCE-IRL was not measured on {', '.join(missing)}: {'; '.join(set(missing.values()))}" if missing else ""
    if not found:
        return Finding(Verdict.UNKNOWN, lacking)
    verdict = by_share(sum(r > 1 for r in found.values()) / len(rows), ALL)
    marks = {n: " (extrapolated)" if rows[n]["irl"]["extrapolated"] else "" for n in found}
    parts = [*(f"{n}: {short(r)} times faster{marks[n]}" for n, r in found.items()), lacking]
    return Finding(verdict, "; ".join(filter(None, parts)))


def _grows(results: Results) -> Finding:
    times = results["demonstrations"]["times"]
    each = {int(size): row["seconds"] / row["samples"] for size, row in times.items()}
    small, large = each[min(each)], each[max(each)]
    verdict = Verdict.REPRODUCED if large <= 3 * small else Verdict.PARTLY if large <= 10 * small else Verdict.NOT
    shown = "; ".join(f"{size}x{size}: {short(1e6 * value)} us" for size, value in each.items())
    return Finding(verdict, f"inference for each sample of a demonstration: {shown}")


def _truth(results: Results) -> Finding:
    verdicts, parts = [], []
    for name in ("grid-5", "grid-7"):
        row = results[f"table-1-{name}"]
        ours, irl = row["ours"]["correlation"], row["irl"].get("correlation")
        if irl is None:
            return Finding(
                Verdict.UNKNOWN, f"no reward of MCE-IRL on {name}: {row['irl']['skipped'] or 'not finished'}"
            )
        verdicts.append(Verdict.REPRODUCED if ours > irl else Verdict.NOT)
        few, many = row["ours"]["demonstrations"], row["irl"]["demonstrations"]
        parts.append(f"{name}: {ours:+.2f} with {few} demonstrations, MCE-IRL {irl:+.2f} with {many}")
    return Finding(worst(verdicts), "correlation with the truth " + "; ".join(parts))


def _few(results: Results) -> Finding:
    result = results["irl-demos"]
    found = {count: row.get("correlation") for count, row in zip(result["counts"], result["rows"], strict=True)}
    if None in found.values():
        return Finding(Verdict.UNKNOWN, f"MCE-IRL was not measured: {result['irl']['skipped'] or 'not finished'}")
    below = {count: value < 0.9 * found[max(found)] for count, value in found.items() if count != max(found)}
    verdict = Verdict.REPRODUCED if all(below.values()) else Verdict.PARTLY if below[min(below)] else Verdict.NOT
    return Finding(verdict, "; ".join(f"{count} demonstrations: {value:+.2f}" for count, value in found.items()))


def _signs(results: Results) -> Finding:
    worth = results["demonstrations"]["worth"]
    good = [row for row in worth if row["label"] == "good"]
    bad = [row for row in worth if row["label"] == "bad"]
    strict = sum(row["strict"] for row in good) / len(good)
    positive, negative = sum(r["reward"] > 0 for r in good) / len(good), sum(r["reward"] < 0 for r in bad) / len(bad)
    evidence = (
        f"good demonstrations with r_d > 0: {positive:.0%} of {len(good)}, whose robustness is strictly positive "
        f"for all requirements: {strict:.0%}; bad ones with r_d < 0: {negative:.0%} of {len(bad)}"
    )
    return Finding(by_share(min(positive, negative), ALL), evidence)


def _two_goals(results: Results) -> Finding:
    rows = rows_of(results, "two-goals")
    shares = _shares(rows, SHAPED, lambda row: row.success)
    seeds = max(len(by[SHAPED]) for by in rows.values())
    both = _shares(rows, SHAPED, lambda row: row.hard and row.reached)
    verdict = worst([by_share(s) for s in shares.values()])
    return Finding(verdict, f"shortest {_shown(shares, seeds)}; safe and both goals {_shown(both, seeds)}")


def _imperfect(results: Results) -> Finding:
    rows = rows_of(results, "ablation")
    shares = _shares(rows, "imperfect only", lambda row: row.success)
    fewer = {
        g: spread(ratios([r.to_success for r in by["none"]], [r.to_success for r in by["imperfect only"]]))
        for g, by in rows.items()
    }
    seeds = max(len(by["none"]) for by in rows.values())
    verdicts = [*map(by_share, shares.values()), *map(by_ratio, fewer.values())]
    shown = "; ".join(f"{group}: {found} times fewer steps than with none" for group, found in fewer.items())
    return Finding(worst(verdicts), f"success {_shown(shares, seeds)}; {shown}")


def _car(results: Results) -> Finding:
    verdicts, parts = [], []
    for bins in (50, 75, 100):
        for group, by in rows_of(results, f"car-{bins}").items():
            ours, standard = ([row.mean_steps for row in by[m]] for m in (SHAPED, STANDARD))
            better = max(ours) < min(standard)
            half = spread(ours).median < spread(standard).median
            verdicts.append(Verdict.REPRODUCED if better else Verdict.PARTLY if half else Verdict.NOT)
            parts.append(f"{group}: worst of ours {short(max(ours))}, best of standard {short(min(standard))}")
    return Finding(worst(verdicts), "; ".join(parts) + " steps per episode")


CARS = ("car-50", "car-75", "car-100")

CLAIMS = (
    Claim(
        "time", "Inferring the reward is faster than MCE-IRL on every row of Table 1.",
        "faster on every row; partly: on half of them", ("table-1-grid-5",), _faster,
    ),
    Claim(
        "truth", "The reward is nearer to the ground truth than that of MCE-IRL, from far fewer demonstrations.",
        "higher correlation with the paper's ground truth on 5x5 and 7x7; partly: on one of them",
        ("table-1-grid-5", "table-1-grid-7"), _truth,
    ),
    Claim(
        "few", "MCE-IRL needs at least 60 optimal demonstrations for an approximate reward on 5x5.",
        "its correlation with the ground truth is below 0.9 of that from 70 with 30 and fewer; partly: only with 3",
        ("irl-demos",), _few,
    ),
    Claim(
        "dimension", "The time of the inference is not affected by the dimension of the state space.",
        "at most 3 times the time for each sample on 80x80 as on 5x5; partly: 10 times", ("demonstrations",), _grows,
    ),
    Claim(
        "signs", "Good demonstrations have positive rewards, bad ones negative rewards.",
        "all of both; partly: half", ("demonstrations",), _signs,
    ),
    Claim(
        "grids", "The learned policy satisfies all requirements on single-goal grids.",
        "95 % of the maps on every size; partly: on some sizes, or half of the maps", ("grids",),
        _succeeds("grids", SHAPED),
    ),
    Claim(
        "letter", "Algorithm 2, as printed, finds a policy that satisfies all requirements.",
        "95 % of the runs on every map; partly: on some, or half of the runs", ("letter",),
        _succeeds("letter", LETTER),
    ),
    Claim(
        "two-goals", "With two goals the policy visits both, safely and in the shortest time.",
        "95 % of the maps on every size; partly: on some sizes, or half of the maps", ("two-goals",), _two_goals,
    ),
    Claim(
        "exploration", "On FrozenLake fewer steps of exploration are needed than with hand-crafted rewards.",
        "than standard Q-learning without the mask, and than a reward by distance with it, on both maps in three "
        "quarters of the seeds, and by the median 1.1 times; partly: in fewer seeds, or for some",
        ("lakes", "hand-crafted"), _explores,
    ),
    Claim(
        "safety", "Exploration is safer than that of standard Q-learning: hard requirements are violated less often.",
        "on both maps, without the mask, in three quarters of the seeds, and by the median 1.1 times; partly: in fewer "
        "seeds, or on one map",
        ("lakes",),
        _fewer("lakes", lambda row: row.violations),
    ),
    Claim(
        "unseen", "On an unseen map of the same size the agent learns to reach the goal.",
        "95 % of the seeds on every map; partly: on some maps, or half of the seeds", ("transfer",),
        _succeeds("transfer", SHAPED),
    ),
    Claim(
        "imperfect", "Sub-optimal and imperfect demonstrations suffice to infer a reward that helps.",
        "95 % of the maps solved, and three quarters of them in fewer steps than without demonstrations, on every "
        "size; partly: on some sizes, or half of the maps", ("ablation",), _imperfect,
    ),
    Claim(
        "car", "On Mountain Car the worst average of steps is better than the best one of standard Q-learning.",
        "so for every number of bins; partly: for some, or only the medians compare so", CARS, _car,
    ),
)  # fmt: skip
"""All claims that experiments decide."""


def judge(claim: Claim, results: Results) -> Finding:
    """Judge a claim by what was measured."""
    missing = [name for name in claim.needs if name not in results]
    if missing:
        return Finding(Verdict.UNKNOWN, f"not run: {', '.join(missing)}")
    return claim.judge(results)
