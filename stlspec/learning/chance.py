"""Q-learning where transitions are by chance, or known only by taking them.

In: a `Problem` over numbered states, with a table of outcomes or a living environment, and `Settings`. Out: a
`Sampler`, whose values have grown by some episodes. With chance a step says little, so that rates fall with the
number of visits, and what counts is the mean of the values over the second half of training (Polyak and
Juditsky 1992): on slippery ice the last values reached 80 to 98 % of the best policy, their mean 98 to 100 %.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stlspec.learning.qstl import CHUNK
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import LIMIT, RUNS, VIOLATION, base_reward

SLOWEST = 0.01
"""Learning rates do not fall below this."""

FALL = -0.6
"""Learning rates fall with the number of visits to this power."""

AVERAGED = 0.5
"""The share of the chunks, at the end, whose values are averaged."""

_BLOCK = 4096

Branch = tuple[float, int, float, int]
"""One outcome of an action: cumulative probability, next state, base reward, how the episode stands there."""


@dataclass(frozen=True, slots=True)
class Step:
    """What a living environment did: the state it is in, its own reward, how the episode stands by spec."""

    state: int
    reward: float
    ending: int
    cut: bool = False


@dataclass(frozen=True, slots=True)
class World:
    """A living environment as training sees it.

    reset: by a seed, or None = go on with the environment's own random numbers; gives the first step.
    step: takes an action. Neither judges more than how the episode stands.
    """

    reset: Callable[[int | None], Step]
    step: Callable[[int], Step]


@dataclass(frozen=True, slots=True)
class Problem:
    """What there is to learn.

    goal_name: what the goal is called. potentials: (n_states,), Phi, in which values start. branches: outcomes
    for [state][action], with `start` and `endings` (n_states,); or world: a living environment instead.
    """

    goal_name: str
    n_states: int
    n_actions: int
    potentials: tuple[float, ...]
    branches: tuple[tuple[tuple[Branch, ...], ...], ...] = ()
    start: int = 0
    endings: tuple[int, ...] = ()
    world: World | None = None


class Sampler:
    """What training changes.

    q: (n_states, n_actions), values now; visits: how often each was updated; mean: their mean over the last
    `averaged` chunks. choices: the actions still allowed. steps, returns, outcomes: the log, one entry for each
    episode; a return is the sum of the rewards, without discount. violations: steps that violated.
    """

    def __init__(self, problem: Problem, settings: Settings) -> None:
        self.problem = problem
        self.settings = settings
        shaped = settings.method == "shaped"
        self.q = [[value if shaped else 0.0] * problem.n_actions for value in problem.potentials]
        self.visits = [[0] * problem.n_actions for _ in range(problem.n_states)]
        self.choices = [list(range(problem.n_actions)) for _ in range(problem.n_states)]
        self.mean: npt.NDArray[np.float64] = np.zeros((problem.n_states, problem.n_actions))
        self.averaged = 0
        self.violations = 0
        self.steps: list[int] = []
        self.returns: list[float] = []
        self.outcomes: list[int] = []

    @property
    def masked(self) -> int:
        """How many pairs of state and action are masked."""
        return sum(self.problem.n_actions - len(row) for row in self.choices)

    def record(self, state: int, action: int, ending: int, steps: int, total: float) -> None:
        """Write an episode, which ended with `action` in `state`, into the log and, where asked for, the mask."""
        self.steps.append(steps)
        self.returns.append(total)
        self.outcomes.append(ending)
        if ending == VIOLATION:
            self.violations += 1
            if self.settings.mask and len(self.choices[state]) > 1 and action in self.choices[state]:
                self.choices[state].remove(action)

    def average(self, chunk: int) -> None:
        """Take the values after a chunk into their mean, if the chunk is one of the last."""
        if chunk * CHUNK >= (1 - AVERAGED) * self.settings.episodes:
            self.averaged += 1
            self.mean += (np.array(self.q) - self.mean) / self.averaged

    def values(self) -> list[list[float]]:
        """Return the values to act by: the mean, -inf where masked."""
        table: list[list[float]] = (self.mean if self.averaged else np.array(self.q)).tolist()
        for row, allowed in zip(table, self.choices, strict=True):
            for action in set(range(len(row))).difference(allowed):
                row[action] = -np.inf
        return table

    def to_state(self) -> dict[str, Any]:
        """Return what a checkpoint holds."""
        return {
            "q": self.q,
            "visits": self.visits,
            "mean": self.mean.tolist(),
            "averaged": self.averaged,
            "choices": self.choices,
            "violations": self.violations,
            "steps": self.steps,
            "returns": self.returns,
            "outcomes": self.outcomes,
        }

    def restore(self, state: Mapping[str, Any]) -> bool:
        """Go back to the state of a checkpoint; False, and nothing changed, if it does not fit.

        A checkpoint is an input like any other: what does not have the right shape is left alone.
        """
        problem = self.problem
        try:
            q, mean = np.array(state["q"], dtype=np.float64), np.array(state["mean"], dtype=np.float64)
            visits = np.array(state["visits"], dtype=np.int64)
            choices = [[range(problem.n_actions)[a] for a in row] for row in state["choices"]]
            steps, outcomes = ([range(2**40)[n] for n in state[key]] for key in ("steps", "outcomes"))
            returns = [float(x) for x in state["returns"]]
            chunks, averaged, violations = (range(2**40)[state[k]] for k in ("chunks", "averaged", "violations"))
            float(state["seconds"])
        except (KeyError, TypeError, ValueError, OverflowError, IndexError):
            return False
        done = min(chunks * CHUNK, self.settings.episodes)
        if not q.shape == mean.shape == visits.shape == self.mean.shape or len(choices) != problem.n_states:
            return False
        if not len(steps) == len(returns) == len(outcomes) == done or not all(choices) or visits.min() < 0:
            return False
        self.q, self.visits, self.mean, self.choices = q.tolist(), visits.tolist(), mean, choices
        self.averaged, self.violations = averaged, violations
        self.steps, self.returns, self.outcomes = steps, returns, outcomes
        return True


RATES = [max(SLOWEST, (n + 1) ** FALL) for n in range(2200)]
"""The learning rate after n visits, before it is capped; constant from the last one on."""


def run_chunk(sampler: Sampler, index: int) -> None:
    """Train for the next `CHUNK` episodes, or for those that are left.

    Not in the paper: random numbers depend on the seed and the number of the chunk alone, those of a living
    environment too (it is reset with a seed), so that a resumed run repeats an uninterrupted one bit for bit.

    Args:    sampler: changed in place. index: the number of the chunk, from 0.
    """
    settings = sampler.settings
    count = min(CHUNK, settings.episodes - index * CHUNK)
    random = np.random.default_rng([settings.seed, index])
    if sampler.problem.world is None:
        _run_table(sampler, count, random)
    else:
        seed = int(np.random.default_rng([settings.seed, index, 1]).integers(2**31))
        _run_world(sampler, sampler.problem.world, count, random, seed)
    sampler.average(index)


def _choose(row: Sequence[float], free: Sequence[int], uniform: float, epsilon: float) -> int:
    """Return the best allowed action, the lowest on ties, or with probability epsilon any of them."""
    if uniform < epsilon:
        return free[int(uniform / epsilon * len(free))]
    return row.index(max(row)) if len(free) == len(row) else max(free, key=row.__getitem__)


def _update(sampler: Sampler, state: int, action: int, target: float) -> None:
    """Move a value towards a target, the slower the more often it was moved."""
    visits, row = sampler.visits[state], sampler.q[state]
    n = visits[action]
    visits[action] = n + 1
    rate = RATES[n] if n < len(RATES) else SLOWEST
    row[action] += min(rate, sampler.settings.alpha) * (target - row[action])


def _run_table(sampler: Sampler, count: int, random: np.random.Generator) -> None:
    problem, settings, q, choices = sampler.problem, sampler.settings, sampler.q, sampler.choices
    branches, numbers = problem.branches, list[float]()
    for _ in range(count):
        state, steps, total, ending, action = problem.start, 0, 0.0, problem.endings[problem.start], 0
        while ending == RUNS:
            if len(numbers) < 2:
                numbers = random.random(_BLOCK).tolist()
            action = _choose(q[state], choices[state], numbers.pop(), settings.epsilon)
            uniform = numbers.pop()
            for edge, after, reward, ending in branches[state][action]:  # noqa: B007
                if uniform < edge:
                    break
            ahead = 0.0 if ending != RUNS else max(q[after])
            _update(sampler, state, action, reward + settings.gamma * ahead)
            total += reward
            steps += 1
            if ending == RUNS:
                state = after
                ending = LIMIT if steps == settings.max_steps else RUNS
        sampler.record(state, action, ending, steps, total)


def _run_world(sampler: Sampler, world: World, count: int, random: np.random.Generator, seed: int) -> None:
    """Train in a living environment; an end by its own limit is none of the task: the value there is used."""
    settings, q, choices = sampler.settings, sampler.q, sampler.choices
    numbers = list[float]()
    for episode in range(count):
        here = world.reset(seed if episode == 0 else None)
        state, ending, steps, total, action = here.state, here.ending, 0, 0.0, 0
        while ending == RUNS:
            if not numbers:
                numbers = random.random(_BLOCK).tolist()
            action = _choose(q[state], choices[state], numbers.pop(), settings.epsilon)
            here = world.step(action)
            reward = pay(here, settings)
            ending = here.ending
            ahead = 0.0 if ending != RUNS else max(q[here.state])
            _update(sampler, state, action, reward + settings.gamma * ahead)
            total += reward
            steps += 1
            if ending == RUNS:
                state = here.state
                ending = LIMIT if here.cut or steps == settings.max_steps else RUNS
        sampler.record(state, action, ending, steps, total)


def pay(here: Step, settings: Settings) -> float:
    """Return the base reward of a step: by the spec, or with `--base env` the environment's own.

    Not in the paper: decision 7. A violation costs 1 in any case: an environment that pays for nothing else
    than getting to an end would pay for violating.
    """
    if settings.base == "env":
        return here.reward - (1.0 if here.ending == VIOLATION else 0.0)
    return base_reward(here.ending, settings.step_cost)


def pays(ending: int, own: float, settings: Settings) -> float:
    """Return the base reward of entering a state of a table. Arguments as the fields of `Step`."""
    return pay(Step(0, own, ending), settings)
