"""The tasks of the paper as data: spec, environment, demonstrations, and the figures that Table 1 prints.

In: the name of a case. Out: a `Case`, from which whoever runs it makes the bundle, the environment and the
demonstrations. The paper gives no maps; those here are drawn with fixed seeds, as its own were drawn.
"""

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from gymnasium.envs.toy_text.frozen_lake import MAPS

from stlspec import api
from stlspec.demos import Demonstration, make_demonstration
from stlspec.envs.catalogue import make_environment
from stlspec.envs.live import with_bins
from stlspec.envs.model import Environment
from stlspec.paper import hills
from stlspec.paper.maps import (
    Rows,
    bad_path,
    good_path,
    least_steps,
    random_map,
    roundabout_path,
    unfinished_path,
)

DATA = Path(__file__).with_name("data")
GRID, LAKE, CAR = "stlspec/GridWorld-v0", "FrozenLake-v1", hills.ID
GOOD, ROUNDABOUT, UNFINISHED, BAD = "good", "roundabout", "unfinished", "bad"
_PATHS: Mapping[str, Callable[[Rows, random.Random], Sequence[Any]]] = {
    GOOD: good_path, ROUNDABOUT: roundabout_path, UNFINISHED: unfinished_path, BAD: bad_path,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Published:
    """One row of the paper's Table 1.

    demos, irl_demos: how many demonstrations, as printed. seconds, irl_seconds: execution time on the authors'
    machine; at_least: the time of MCE-IRL is a lower bound.
    """

    demos: str
    seconds: float
    irl_demos: str
    irl_seconds: float
    at_least: bool = False


@dataclass(frozen=True, slots=True)
class Case:
    """One task.

    name: one word. title: as the paper calls it. spec: a file. params: what the spec leaves open. env, args, map:
    the environment. bins: along each entry of an observation, () = states have numbers. demos: for each
    demonstration its kind ("good", "roundabout", "unfinished", "bad") and its states. published: the row of
    Table 1, None where it has none.
    """

    name: str
    title: str
    spec: Path
    env: str
    demos: tuple[tuple[str, tuple[Any, ...]], ...]
    params: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    args: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    map: Rows | None = None
    bins: tuple[int, ...] = ()
    published: Published | None = None

    def bundle(self) -> api.Bundle:
        """Compile the spec."""
        return api.compile(self.spec, params=dict(self.params))

    def environment(self) -> Environment:
        """Describe the environment, with bins where the case has them."""
        environment = make_environment(self.env, dict(self.args), self.map)
        return with_bins(environment, self.bins) if self.bins else environment

    def demonstrations(self, *kinds: str) -> tuple[Demonstration, ...]:
        """Return the demonstrations, all or those of some kinds; the names say the kind."""
        numbered = enumerate(self.demos, 1)
        return tuple(self._demonstration(f"{k} {i}", p) for i, (k, p) in numbered if not kinds or k in kinds)

    def experts(self, count: int, seed: int = 0) -> tuple[Demonstration, ...]:
        """Return optimal demonstrations, as many as MCE-IRL is to be given.

        Paper: section 4, "the demonstrations provided for MCE-IRL are all optimal".

        Args: count: how many. seed: each demonstration is drawn afresh, on maps one of the shortest paths, for
            the mountain car a drive from another start.
        """
        draw = random.Random(f"experts/{self.name}/{seed}")  # noqa: S311 - maps, no secrets
        if self.map is None:
            paths: list[Sequence[Any]] = [hills.drive(draw.randrange(2**31)) for _ in range(count)]
        else:
            paths = [good_path(self.map, draw) for _ in range(count)]
        return tuple(self._demonstration(f"expert {i}", path) for i, path in enumerate(paths, 1))

    def _demonstration(self, name: str, path: Sequence[Any]) -> Demonstration:
        return make_demonstration(name, states=[list(state) for state in path])

    def on_map(self, rows: Rows) -> "Case":
        """Return the case on another map, the goals to be reached within the shortest time there.

        Paper: section 3.2, the unseen map; demonstrations stay those of the first map.
        """
        return replace(self, map=rows, params=MappingProxyType({"T_goal": least_steps(rows)}))


def on_rows(
    name: str, title: str, env: str, rows: Rows, kinds: Sequence[str], seed: int, published: Published | None = None
) -> Case:
    """Make the case of a map, with demonstrations of the given kinds on it.

    Args: env: `GRID` or `LAKE`. rows: the map. kinds: of demonstrations. seed: draws them.
    """
    draw = random.Random(f"{name}/{seed}")  # noqa: S311 - maps, no secrets
    demos = tuple((kind, tuple(_PATHS[kind](rows, draw))) for kind in kinds)
    spec = "two_goals.stl" if "2" in "".join(rows) else "single_goal.stl"
    args = MappingProxyType({"is_slippery": False} if env == LAKE else {})
    params = MappingProxyType({"T_goal": least_steps(rows)})
    return Case(name, title, DATA / spec, env, demos, params, args, rows, published=published)


def random_grid(size: int, goals: int, kinds: Sequence[str], seed: int) -> Case:
    """Make a grid-world case with obstacles in random places on about 15 % of the cells (2 on 5x5).

    Paper: section 4, "the obstacles were assigned randomly"; the ground truth of its 5x5 map has 2.
    """
    draw = random.Random(f"map/{size}/{goals}/{seed}")  # noqa: S311 - maps, no secrets
    obstacles = 2 if size == 5 else round(0.15 * size * size)
    while True:
        rows = random_map(size, goals, obstacles, draw)
        name = f"grid-{size}" if goals == 1 else f"two-goal-{size}"
        try:
            return on_rows(name, f"({size} x {size}) grid" + ", two goals" * (goals > 1), GRID, rows, kinds, seed)
        except ValueError:
            continue  # a map without a roundabout, say


KINDS: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "grid-5": (GOOD, GOOD, BAD),
    "grid-7": (GOOD, GOOD, BAD, UNFINISHED, ROUNDABOUT),
    "grid-10": (GOOD, GOOD, BAD, UNFINISHED),
    "two-goal-5": (GOOD, GOOD, BAD),
    "two-goal-7": (ROUNDABOUT, ROUNDABOUT),
    "lake-4": (GOOD, GOOD, GOOD, ROUNDABOUT),
    "lake-8": (GOOD, GOOD, GOOD, GOOD, UNFINISHED),
})  # fmt: skip
"""The kinds of demonstrations that the paper names for each map; for 7x7, Table 1 has one more than its text."""

PUBLISHED: Mapping[str, Published] = MappingProxyType({
    "grid-5": Published("3", 2.62, "70", 3.77),
    "grid-7": Published("5", 2.74, "150", 6.81),
    "lake-4": Published("4", 2.81, "150", 3.96),
    "lake-8": Published("5", 3.11, "800", 13.18),
    "car-50": Published("2-3", 2.95, "10-20", 60.0, at_least=True),
})  # fmt: skip
"""Table 1 of the paper."""

NAMES = (*KINDS, "car-50", "car-75", "car-100")
"""All cases, in the order of the paper."""

TABLE_1 = tuple(PUBLISHED)
"""The cases of Table 1, in its order."""


@cache
def case_of(name: str) -> Case:
    """Return a case by its name.

    Raises: KeyError: there is no such case.
    """
    kind, size = name.rsplit("-", 1)
    published = PUBLISHED.get(name)
    if kind == "car" and name in NAMES:
        demos = tuple((GOOD, hills.drive(seed)) for seed in (1, 2))
        bins, title = (int(size), int(size)), f"Mountain Car, {size} x {size} bins"
        return Case(name, title, DATA / "mountain_car.stl", CAR, demos, bins=bins, published=published)
    if kind == "lake":
        rows = tuple(MAPS[f"{size}x{size}"])
        return on_rows(name, f"FrozenLake-{size}", LAKE, rows, KINDS[name], 0, published)
    found = random_grid(int(size), 2 if kind == "two-goal" else 1, KINDS[name], 0)
    return replace(found, published=published)
