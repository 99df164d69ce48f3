"""What the reward of MCE-IRL is good for, beside ours: on the map of the demonstrations and on unseen ones.

In: a case, and how many seeds and unseen maps. Out: figures as JSON. Two questions. What does a reward ask for by
itself? The policy that is best for it is worked out exactly, the goal absorbing, and the spec judges its path; no
learner stands between. What does it do for Q-learning? The same learner is shaped by it as by ours. It is given the
same bad demonstrations for the mask, and two ways to be used: as it is, and by the values that planning with the
known transitions makes of it. The measure of both is a reward that says nothing, which shapes too: it makes the
learner hopeful.
"""

import random
from collections.abc import Iterator, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.learning.policy import greedy_path
from stlspec.learning.shaping import GOAL
from stlspec.learning.task import make_world, segment
from stlspec.learning.training import Judge
from stlspec.paper.cases import BAD, KINDS, LAKE, Case, random_grid
from stlspec.paper.maps import moved_holes
from stlspec.paper.runs import Run
from stlspec.paper.tabular import Tabular, make_tabular
from stlspec.rewards import RewardMap, infer_reward

Floats = npt.NDArray[np.float64]

OURS, IRL, IRL_VALUES, NOTHING, PLAIN = "STL reward", "MCE-IRL reward", "MCE-IRL values", "no information", "plain"
HOME = "demonstrated"

GAMMA = 0.99
_SWEEPS = 5000
_ENOUGH = 1e-9


def action_values(tabular: Tabular, reward: Sequence[float], gamma: float = GAMMA) -> Floats:
    """Work out what actions are worth where entering a state pays its reward.

    Not in the paper: value iteration, the limit of Q-learning.

    Args:    reward: (n_states,). gamma: the discount, below 1.
    Returns: (n_states, n_actions), within 1e-9 / (1 - gamma) of the fixed point.
    """
    paid, pairs = np.asarray(reward, dtype=np.float64), tabular.states * tabular.n_actions + tabular.actions
    firsts = np.searchsorted(pairs, np.arange(tabular.n_states * tabular.n_actions))
    values, found = np.zeros(tabular.n_states), np.zeros((tabular.n_states, tabular.n_actions))
    for _ in range(_SWEEPS):
        flows = tabular.probabilities * (paid + gamma * values)[tabular.afters]
        found = np.add.reduceat(flows, firsts).reshape(found.shape)
        change, values = float(np.max(np.abs(found.max(axis=1) - values))), found.max(axis=1)
        if change < _ENOUGH:
            break
    return found


def alone(case: Case, reward: Sequence[float]) -> dict[str, Any]:
    """Judge the policy that is best for a reward.

    Paper: section 4, the rewards compared with the ground truth by eye; this asks what they ask for.

    Args:    case: the map, with one goal. reward: (n_states,).
    Returns: hard, all: whether the path meets the hard requirements, and all; reached: whether it gets to the goal;
             steps.
    """
    bundle, environment = case.bundle(), case.environment()
    world = make_world(bundle, environment, environment.max_steps or environment.n_states)
    task = segment(world, world.product.start, 0)
    values = action_values(make_tabular(bundle, environment, case.experts(1)), reward).round(7).tolist()
    path, actions = greedy_path(values, task.transitions, task.endings, task.start, environment.n_states)
    found = Judge(bundle, environment, world)(path)
    return {
        "hard": found.meets_hard, "all": found.meets_all, "reached": task.endings[path[-1]] == GOAL,
        "steps": len(actions),
    }  # fmt: skip


def on_unseen_maps(case: Case, count: int) -> list[Case]:
    """Return the case on other maps of its size: obstacles elsewhere, start and goal where they were.

    Paper: section 3.2, and section 4 on FrozenLake.
    """
    assert case.map is not None
    draw = random.Random(f"worth/{case.name}")  # noqa: S311 - maps, no secrets
    if case.env == LAKE:
        return [case.on_map(moved_holes(case.map, draw)) for _ in range(count)]
    size = len(case.map)
    grids = [random_grid(size, 1, KINDS[case.name], draw.randrange(2**31)) for _ in range(count)]
    return [case.on_map(grid.map) for grid in grids if grid.map is not None]


def as_map(case: Case, values: Sequence[float]) -> RewardMap:
    """Return values of states as a reward map, from 0 to 1: only differences of a state reward mean something."""
    environment = case.environment()
    array = np.asarray(values, dtype=np.float64)
    spread = float(np.ptp(array)) or 1.0
    states = tuple(tuple(environment.decode(s)) for s in range(environment.n_states))
    scaled = ((array - array.min()) / spread).tolist()
    return RewardMap(meaning_sha256(case.bundle()), MappingProxyType(environment.describe()), states, tuple(scaled))


def reward_maps(case: Case, reward: Sequence[float]) -> dict[str, RewardMap]:
    """Return the maps that shape the learner, but for ours: the reward, its values on the map of the demonstrations,
    and one that is the same everywhere, too small to tell from nothing.
    """
    tabular = make_tabular(case.bundle(), case.environment(), case.experts(1))
    nothing = as_map(case, reward)
    return {
        IRL: as_map(case, reward),
        IRL_VALUES: as_map(case, action_values(tabular, reward).max(axis=1).tolist()),
        NOTHING: replace(nothing, values=(1e-9,) * len(nothing.values)),
    }


def runs_of(case: Case, reward: Sequence[float], seeds: int, unseen: int) -> Iterator[Run]:
    """Yield the runs of the learner: by each reward and without, on the map of the demonstrations and on others.

    Args: reward: of MCE-IRL, (n_states,). unseen: how many other maps.
    """
    given = reward_maps(case, reward)
    maps = [(HOME, case), *((f"unseen {k}", c) for k, c in enumerate(on_unseen_maps(case, unseen), 1))]
    for where, here in maps:
        for seed in range(seeds):
            group = f"{case.name}, {where}"
            yield Run(group, OURS, here, seed, case, options={"method": "shaped"})
            yield Run(group, PLAIN, here, seed, case, options={"method": "plain"})
            for name, found in given.items():
                options = {"method": "shaped", "reward": found}
                yield Run(group, name, here, seed, case, (BAD,), BAD not in KINDS[case.name], options)


def asked_for(case: Case, reward: Sequence[float], unseen: int) -> dict[str, dict[str, Any]]:
    """Say what the policies that are best for either reward do, here and on other maps.

    Returns: for `OURS` and `IRL`: "home", as `alone`; hard, all, reached: on how many of the `unseen` maps.
    """
    environment = case.environment()
    ours = infer_reward(case.bundle(), case.demonstrations(), environment).table(environment)
    others = on_unseen_maps(case, unseen)
    found = {}
    for name, values in ((OURS, ours), (IRL, reward)):
        away = [alone(other, values) for other in others]
        counts = {key: sum(bool(a[key]) for a in away) for key in ("hard", "all", "reached")}
        found[name] = {"home": alone(case, values), "maps": len(away), **counts}
    return found
