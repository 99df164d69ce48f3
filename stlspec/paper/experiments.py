"""The experiments of the paper, each a function from a budget to figures as JSON.

In: a budget and processes. Out: for experiments that learn the rows of all runs, by group and method; for the
others what `inference` gives. Every experiment can be run alone; none needs the result of another.
"""

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import chain
from typing import Any

from stlspec.paper import inference, worth
from stlspec.paper.budgets import Budget
from stlspec.paper.cases import (
    BAD,
    GOOD,
    KINDS,
    PUBLISHED,
    ROUNDABOUT,
    TABLE_1,
    UNFINISHED,
    Case,
    case_of,
    random_grid,
)
from stlspec.paper.handmade import REWARDS, make_handmade
from stlspec.paper.irl import measure
from stlspec.paper.maps import moved_holes
from stlspec.paper.runs import Row, Rows, Run, make_run, make_runs

SIZES = (5, 7, 10)
UNSEEN_MAPS = 3
MIXED = (GOOD, GOOD, BAD, UNFINISHED, ROUNDABOUT)

SHAPED, PLAIN, UNMASKED, STANDARD, LETTER = "shaped", "plain", "shaped, no mask", "standard", "to the letter"
OPTIONS: Mapping[str, Mapping[str, Any]] = {
    SHAPED: {"method": "shaped"},
    PLAIN: {"method": "plain"},
    UNMASKED: {"method": "shaped", "mask": False},
    STANDARD: {"method": "plain", "mask": False},
    LETTER: {"method": "paper"},
}
"""Methods: LfD+STL as stlspec does it; Q-learning with the same mask; both without the mask, which is not in the
paper, so that "standard" is Q-learning as everybody knows it; and the paper's Algorithm 2 as printed."""

Progress = Callable[[int, int], object]


@dataclass(frozen=True, slots=True)
class Experiment:
    """One experiment. name: one word. title: a line. run: measures it, with processes and a progress callback."""

    name: str
    title: str
    run: Callable[[Budget, int, Progress], dict[str, Any]]


def rows_to_json(rows: Rows) -> dict[str, Any]:
    """Return rows as JSON."""
    return {group: {m: [asdict(row) for row in found] for m, found in by.items()} for group, by in rows.items()}


def rows_from_json(document: Mapping[str, Any]) -> Rows:
    """Read what `rows_to_json` wrote."""
    return {
        group: {m: [Row(**row | {"curve": tuple(row["curve"])}) for row in found] for m, found in by.items()}
        for group, by in document.items()
    }


def _learned(runs: Iterator[Run], jobs: int, progress: Progress) -> dict[str, Any]:
    return rows_to_json(make_runs(list(runs), jobs, progress))


def _each(group: str, cases: Sequence[Case], methods: Sequence[str], **options: Any) -> Iterator[Run]:
    """Yield runs on a case for each seed, by each method."""
    for method in methods:
        for seed, case in enumerate(cases):
            yield Run(group, method, case, seed, options=dict(OPTIONS[method]) | options)


def grids(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
    """Learn on single-goal grids, another map for each seed.

    Paper: section 4, single-goal grid-world.
    """

    def runs() -> Iterator[Run]:
        for size in SIZES:
            cases = [random_grid(size, 1, KINDS[f"grid-{size}"], seed) for seed in range(budget.seeds)]
            yield from _each(f"grid-{size}", cases, (SHAPED, PLAIN, UNMASKED, STANDARD))

    return _learned(runs(), jobs, progress)


def two_goals(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
    """Learn on grids with two goals, another map for each seed.

    Paper: section 4, multi-goal grid-world, and Algorithm 3.
    """

    def runs() -> Iterator[Run]:
        for size in (5, 7):
            cases = [random_grid(size, 2, KINDS[f"two-goal-{size}"], seed) for seed in range(budget.seeds)]
            yield from _each(f"two-goal-{size}", cases, (SHAPED, PLAIN))

    return _learned(runs(), jobs, progress)


def lakes(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
    """Learn on the two stock maps of FrozenLake, not slippery.

    Paper: section 4, FrozenLake, figures 4a and 4b.
    """

    def runs() -> Iterator[Run]:
        for name in ("lake-4", "lake-8"):
            yield from _each(name, [case_of(name)] * budget.seeds, (SHAPED, PLAIN, UNMASKED, STANDARD))

    return _learned(runs(), jobs, progress)


HAND_CRAFTED = ("grid-5", "grid-7", "grid-10", "lake-4", "lake-8")


def hand_crafted(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
    """Learn with hand-crafted rewards and the same mask, cost of a step and start: only the reward differs.

    Paper: section 4, "standard Q-Learning with hand-crafted rewards".
    """

    def runs() -> Iterator[Run]:
        for name in HAND_CRAFTED:
            for method in (SHAPED, *REWARDS):
                for seed in range(budget.seeds):
                    yield Run(name, method, case_of(name), seed, options=OPTIONS.get(method, {}))

    return rows_to_json(make_runs(list(runs()), jobs, progress, make_either))


def make_either(run: Run) -> Row:
    """Make a run, of a hand-crafted reward if its method is one."""
    return make_handmade(run) if run.method in REWARDS else make_run(run)


def unseen(name: str) -> list[Case]:
    """Return a lake on maps on which nobody demonstrated anything: the same number of holes, elsewhere.

    Paper: section 4, "to relocate the holes, while the goal location remained the same".
    """
    case = case_of(name)
    assert case.map is not None
    draw = random.Random(f"unseen/{name}")  # noqa: S311 - maps, no secrets
    return [case.on_map(moved_holes(case.map, draw)) for _ in range(UNSEEN_MAPS)]


def transfer(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
    """Learn on unseen maps with demonstrations of the stock map.

    Paper: section 3.2, and the appendix on FrozenLake.
    """

    def runs() -> Iterator[Run]:
        for name in ("lake-4", "lake-8"):
            for number, case in enumerate(unseen(name), 1):
                for method in (SHAPED, PLAIN):
                    for seed in range(budget.seeds):
                        group, home = f"{name}, map {number}", case_of(name)
                        yield Run(group, method, case, seed, home, options=OPTIONS[method])

    return _learned(runs(), jobs, progress)


ABLATION: Mapping[str, tuple[str, ...] | None] = {
    "all": (),
    "without the bad": (GOOD, UNFINISHED, ROUNDABOUT),
    "imperfect only": (BAD, UNFINISHED, ROUNDABOUT),
    "none": None,
}
"""Which demonstrations are used."""


def ablation(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
    """Learn on grids with some of the demonstrations.

    Paper: section 4 claims that sub-optimal and imperfect demonstrations will do.
    """

    def runs() -> Iterator[Run]:
        for size in SIZES:
            for variant, kinds in ABLATION.items():
                for seed in range(budget.seeds):
                    case = random_grid(size, 1, MIXED, seed)
                    options = OPTIONS[SHAPED]
                    used, none = kinds or (), kinds is None
                    yield Run(f"grid-{size}", variant, case, seed, kinds=used, none=none, options=options)

    return _learned(runs(), jobs, progress)


def letter(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
    """Learn by Algorithm 2 as it is printed.

    Paper: Algorithm 2 with R_fb(s') + the robustness of the partial policy as reward.
    """

    def runs() -> Iterator[Run]:
        for size in SIZES:
            cases = [random_grid(size, 1, KINDS[f"grid-{size}"], seed) for seed in range(budget.seeds)]
            yield from _each(f"grid-{size}", cases, (LETTER,))
        for name in ("lake-4", "lake-8"):
            yield from _each(name, [case_of(name)] * budget.seeds, (LETTER,))

    return _learned(runs(), jobs, progress)


def rewards(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
    """Ask what the reward of MCE-IRL is good for, on the map of the demonstrations and on others.

    Paper: section 4, where the rewards of both methods are compared by eye.

    Returns: rows by case and map; asked, by case, see `worth.asked_for`; notes: by case, how MCE-IRL was trained.
    """
    rows, asked, notes = dict[str, Any](), dict[str, Any](), dict[str, str]()
    for name in ("grid-7", "lake-8"):
        case = case_of(name)
        experts = case.experts(int(PUBLISHED[name].irl_demos))
        # four times the time of Table 1: there a part of the training will do, here it has to come to its end
        found = measure(case, experts, iterations=budget.irl_iterations, seconds=4 * budget.irl_seconds)
        notes[name] = found.skipped or found.note
        if found.reward is not None:
            asked[name] = worth.asked_for(case, found.reward, budget.seeds)
            rows |= _learned(worth.runs_of(case, found.reward, budget.seeds, 2), jobs, progress)
    return {"rows": rows, "asked": asked, "notes": notes}


def car(bins: int) -> Callable[[Budget, int, Progress], dict[str, Any]]:
    """Make the experiment with Mountain Car in so many bins along each axis.

    Paper: section 4, Mountain Car, figure 4c. The hand-crafted reward is the environment's own, -1 a step; LfD+STL
    has the reward of the spec and the potential of the demonstrations, and PLAIN the reward of the spec alone.
    """

    def run(budget: Budget, jobs: int, progress: Progress) -> dict[str, Any]:
        name, seeds = f"car-{bins}", dict(budget.car_seeds)[bins]
        cases = [case_of(name)] * seeds
        common = {"episodes": budget.car_episodes, "max_steps": budget.car_steps}
        ours = _each(name, cases, (SHAPED, PLAIN), base="spec", **common)
        return _learned(chain(ours, _each(name, cases, (STANDARD,), base="env", **common)), jobs, progress)

    return run


def demonstrations(budget: Budget, _jobs: int, progress: Progress) -> dict[str, Any]:
    """Score demonstrations on random maps, and time the inference as maps grow.

    Paper: definitions 3 and 4, and "isn't affected by the dimensionality of the state space".
    """
    worth, times = [], {}
    for seed in range(budget.seeds):
        for size in SIZES:
            worth += inference.worth(random_grid(size, 1, MIXED, seed))
        progress(seed + 1, budget.seeds)
    for size in (5, 10, 20, 40, 80):
        times[str(size)] = inference.time_inference(random_grid(size, 1, (GOOD, GOOD, BAD), 0), budget.repeats)
    return {"worth": worth, "times": times}


def table_1(name: str) -> Callable[[Budget, int, Progress], dict[str, Any]]:
    """Make the experiment of one row of Table 1: the time of both methods, one after the other.

    Paper: Table 1. MCE-IRL gets as many optimal demonstrations as the paper gave it, the lower end of a range.
    """

    def run(budget: Budget, _jobs: int, progress: Progress) -> dict[str, Any]:
        case = case_of(name)
        ours = inference.time_inference(case, budget.repeats)
        ours["cold"] = inference.time_cold(case, max(1, budget.repeats // 5))
        progress(1, 2)
        experts = case.experts(int(PUBLISHED[name].irl_demos.split("-")[0]))
        irl = measure(case, experts, iterations=budget.irl_iterations, seconds=budget.irl_seconds).to_json()
        progress(2, 2)
        if not name.startswith("grid") or case.map is None:
            return {"ours": ours, "irl": irl, "truth": None}
        truth = inference.ground_truth(case.map)
        ours["correlation"] = inference.correlation(inference.infer(name).table(case.environment()), truth)
        irl["correlation"] = None if irl["reward"] is None else inference.correlation(irl["reward"], truth)
        return {"ours": ours, "irl": irl, "truth": truth}

    return run


COUNTS = (3, 10, 30, 70)


def irl_demonstrations(budget: Budget, _jobs: int, progress: Progress) -> dict[str, Any]:
    """Measure how near MCE-IRL comes to the ground truth from more and more optimal demonstrations.

    Paper: section 4, "MCE-IRL requires at least 60 optimal demonstrations".
    """
    case, rows = case_of("grid-5"), []
    assert case.map is not None
    truth = inference.ground_truth(case.map)
    for number, count in enumerate(COUNTS, 1):
        found = measure(case, case.experts(count), iterations=budget.irl_iterations, seconds=budget.irl_seconds)
        near = None if found.reward is None else inference.correlation(found.reward, truth)
        rows.append(found.to_json() | {"correlation": near})
        progress(number, len(COUNTS))
    return {"counts": list(COUNTS), "rows": rows, "irl": rows[-1]}


EXPERIMENTS: Mapping[str, Experiment] = {
    found.name: found
    for found in (
        *(Experiment(f"table-1-{n}", f"Table 1: {case_of(n).title}", table_1(n)) for n in TABLE_1),
        Experiment("irl-demos", "MCE-IRL from more and more demonstrations", irl_demonstrations),
        Experiment("demonstrations", "what demonstrations are worth; inference on larger maps", demonstrations),
        Experiment("grids", "single-goal grids", grids),
        Experiment("two-goals", "grids with two goals", two_goals),
        Experiment("lakes", "FrozenLake, exploration", lakes),
        Experiment("hand-crafted", "with hand-crafted rewards", hand_crafted),
        Experiment("transfer", "FrozenLake, unseen maps", transfer),
        Experiment("ablation", "with some of the demonstrations", ablation),
        Experiment("rewards", "what the reward of MCE-IRL is good for", rewards),
        Experiment("letter", "Algorithm 2 as printed", letter),
        *(Experiment(f"car-{n}", f"Mountain Car, {n} bins", car(n)) for n in (50, 75, 100)),
    )
}
"""All experiments by name, in the order in which they are run."""
