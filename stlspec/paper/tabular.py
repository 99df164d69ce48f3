"""A task as the tables that MCE-IRL needs: transitions with probabilities, starts, visits of demonstrations.

In: spec, environment, demonstrations. Out: a `Tabular`, in sparse form, that knows nothing of who reads it. The
goal absorbs, since the task ends there and a finite-horizon method does not know that episodes end; nothing else
of the spec goes in, for MCE-IRL has demonstrations only. Continuous dynamics become a table by stepping the living
environment from several points of every bin.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import reachable
from stlspec.demos import Demonstration
from stlspec.envs.live import bare
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.learning.goals import Condition, find_agenda
from stlspec.learning.tables import signal_sources
from stlspec.semantics.robustness import evaluate_nodes
from stlspec.traces import make_trace

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

POINTS = 4
"""Points along each axis of a bin from which its transitions are sampled: their middle ones, evenly spaced."""

STARTS = 500
"""Starts drawn of a living environment."""

SLACK = 2
"""The horizon is so many times the longest demonstration, at most the step limit of the environment."""


@dataclass(frozen=True, slots=True, eq=False)
class Tabular:
    """A Markov decision process without a reward, and what demonstrations do in it.

    states, actions, afters, probabilities: (n_entries,), the transitions that can happen, by state, then action,
    then next state; those of one pair of state and action sum to 1. starts, visits: (n_states,), the probability
    to start in a state, and how often a demonstration visits it on average. horizon: steps of an episode; a
    demonstration that ends before goes on in its last state, so that visits sum to horizon + 1.
    """

    n_states: int
    n_actions: int
    states: Ints
    actions: Ints
    afters: Ints
    probabilities: Floats
    starts: Floats
    visits: Floats
    horizon: int


def make_tabular(bundle: BundleData, environment: Environment, demonstrations: Sequence[Demonstration]) -> Tabular:
    """Make the tables of a task.

    Paper: section 4, the comparison with MCE-IRL. Not in the paper: horizon, absorbing goal, binned dynamics.

    Args:    environment: with a table, outcomes, or bins over a living environment whose state can be set.
             demonstrations: at least one, with states of `environment`.
    Returns: the tables.
    Raises:  UsageError D880: the spec has not one goal; DataError: a demonstration does not fit.
    """
    goal = goal_of(bundle)
    paths = [[environment.encode(state) for state in d.recording.states or ()] for d in demonstrations]
    longest = max(len(path) for path in paths) - 1
    horizon = min(SLACK * longest, environment.max_steps or SLACK * longest)
    if environment.bins is None:
        table, starts = _of_table(bundle, environment, goal), np.zeros(environment.n_states)
        starts[environment.start] = 1.0
    else:
        table, starts = _of_bins(bundle, environment, goal), _starts(environment)
    shape = (environment.size, environment.n_actions, environment.size)
    codes, counts = np.unique(np.ravel_multi_index(tuple(table[:3].astype(np.int64)), shape), return_inverse=True)
    probabilities = np.bincount(counts, weights=table[3]).astype(np.float64)
    states, actions, afters = np.unravel_index(codes, shape)
    visits = count_visits(paths, environment.size, horizon)
    return Tabular(shape[0], shape[1], states, actions, afters, probabilities, starts, visits, horizon)


def goal_of(bundle: BundleData) -> tuple[Condition, ...]:
    """Return the conditions of the one goal.

    Paper: section 4, MCE-IRL "was not able to recover the reward for the multiple sequential goals": a reward of
    states cannot say that both are wanted.

    Raises:  UsageError D880: there is none, or there are several.
    """
    wishes = dict.fromkeys(wish.conditions for wish in find_agenda(bundle).wishes)
    if len(wishes) != 1:
        what = f"a reward of states stands for one goal, and the spec has {len(wishes)}"
        raise UsageError([diagnostic("D880", what=what, help="leave out MCE-IRL here")])
    return next(iter(wishes))


def count_visits(paths: Sequence[Sequence[int]], n_states: int, horizon: int) -> Floats:
    """Count how often demonstrations visit each state, on average.

    Not in the paper: the state occupancy of Ziebart (2010), chapter 9, from samples.

    Args:    paths: states by number; one that ends before the horizon stays in its last state until then, one that
             goes on is cut.
    Returns: (n_states,), sum horizon + 1.
    """
    visits = np.zeros(n_states)
    for path in paths:
        padded = [*path, *[path[-1]] * (horizon + 1 - len(path))][: horizon + 1]
        visits += np.bincount(padded, minlength=n_states)
    return visits / len(paths)


def reached(
    bundle: BundleData, environment: Environment, goal: Sequence[Condition], states: npt.NDArray[Any]
) -> npt.NDArray[np.bool_]:
    """Tell where the goal is reached.

    Not in the paper: its goal states are given.

    Args:    states: (n_samples,) numbers, or (n_samples, n_axes) observations.
    Returns: (n_samples,).
    """
    nodes = [condition.node for condition in goal]
    needed = {str(n.value) for n in reachable(bundle.nodes, nodes)[0] if n.op in ("signal", "bool")}
    sources = signal_sources(bundle, needed, environment)
    columns = environment.signals(set(sources.values()), states)
    signals = {name: columns[source] for name, source in sources.items()}
    trace = make_trace(bundle.time, bundle.signals, signals, required=needed, file=f"the states of {environment.id}")
    values = evaluate_nodes(bundle.nodes, nodes, trace)
    held = [(v < 0 if condition.negated else v > 0) for condition, v in zip(goal, values, strict=True)]
    return np.asarray(np.logical_and.reduce(held))


def _of_table(bundle: BundleData, environment: Environment, goal: Sequence[Condition]) -> Floats:
    """Return (4, n_entries): state, action, next state, probability; the goal leads to itself."""
    ends = reached(bundle, environment, goal, np.arange(environment.n_states))
    outcomes = environment.outcomes or [[((1.0, after),) for after in row] for row in environment.transitions or ()]
    rows = [
        (state, action, state if ends[state] else after, probability)
        for state, actions in enumerate(outcomes)
        for action, branches in enumerate(actions)
        for probability, after in branches
    ]
    return np.array(rows, dtype=np.float64).T


def points_of(environment: Environment) -> tuple[Ints, Floats]:
    """Return evenly spaced points of every bin.

    Not in the paper: it says "discretize" only. One point would not do: at 50 x 50 no action changes the velocity
    by as much as half a bin, so that the middle of a bin never leads out of it.

    Returns: the number of the bin (n_points,), and the observation (n_points, n_axes).
    """
    bins = environment.bins
    assert bins is not None
    axes = []
    for low, high, count in zip(bins.low, bins.high, bins.counts, strict=True):
        width = (high - low) / (count * POINTS)
        axes.append(low + (np.arange(count * POINTS) + 0.5) * width)
    points = np.stack([axis.reshape(-1) for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    number = bins.numberer()
    return np.array([number(point) for point in points.tolist()], dtype=np.int64), points


def _of_bins(bundle: BundleData, environment: Environment, goal: Sequence[Condition]) -> Floats:
    """As `_of_table`, by stepping from every point of every bin; a point at the goal stays in its bin."""
    assert environment.bins is not None
    numbers, points = points_of(environment)
    ends = reached(bundle, environment, goal, points)
    live: Any = bare(environment)
    number, weight, rows = environment.bins.numberer(), 1.0 / POINTS ** len(environment.bins.counts), []
    live.reset(seed=0)
    for state, point, ended in zip(numbers.tolist(), points, ends.tolist(), strict=True):
        for action in range(environment.n_actions):
            after = state
            if not ended:
                live.state = point.copy()
                after = number(live.step(action)[0].tolist())
            rows.append((state, action, after, weight))
    live.close()
    return np.array(rows, dtype=np.float64).T


def _starts(environment: Environment) -> Floats:
    """Return how often a living environment starts in each bin, of `STARTS` draws."""
    assert environment.bins is not None
    live, number, found = bare(environment), environment.bins.numberer(), np.zeros(environment.size)
    for draw in range(STARTS):
        found[number(live.reset(seed=0 if draw == 0 else None)[0].tolist())] += 1
    live.close()
    return found / STARTS
