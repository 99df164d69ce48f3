"""The state of a segment, unfinished or finished, as JSON and back.

In: a `Learner` between two chunks of episodes. Out: what a checkpoint holds, and a learner in the same state
again, to the bit: JSON keeps every digit of a float. A checkpoint is an input like any other: one that does
not fit is ignored, and the segment starts from the beginning.
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import number
from stlspec.envs.model import Environment
from stlspec.learning.qstl import CHUNK, Learner
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import ENDINGS
from stlspec.learning.task import Task

_FORMAT = 3

Look = tuple[int, int, tuple[int, ...]]
"""A look at the greedy path: episodes and steps so far, and the path, learner states."""


@dataclass(frozen=True, slots=True)
class Position:
    """How far a segment has come: chunks of episodes done, the look after each, seconds spent."""

    chunks: int
    looks: tuple[Look, ...]
    seconds: float


def fingerprint(
    bundle: BundleData,
    environment: Environment,
    task: Task,
    settings: Settings,
    potential: Sequence[float],
    prefilled: Sequence[tuple[int, int]],
) -> str:
    """Hash everything that the course of a segment depends on; equal segments have equal fingerprints.

    Not in the paper: a checkpoint of any other run is worthless.

    Returns: SHA-256, hexadecimal.
    """
    spec = (bundle.time, bundle.signals, bundle.requirements, bundle.nodes)
    world = (environment.fingerprint, environment.describe(), task)
    run = (_FORMAT, CHUNK, settings, tuple(potential), tuple(prefilled), spec, world)
    return hashlib.sha256(repr(run).encode()).hexdigest()


def to_state(learner: Learner, position: Position) -> dict[str, Any]:
    """Return what a checkpoint holds."""
    paths = {path: number for number, path in enumerate(dict.fromkeys(path for _, _, path in position.looks))}
    return {
        "chunks": position.chunks,
        "paths": [list(path) for path in paths],
        "looks": [[episodes, steps, paths[path]] for episodes, steps, path in position.looks],
        "seconds": position.seconds,
        "q": [[number(value) for value in row] for row in learner.q],
        "steps": learner.steps,
        "returns": [number(value) for value in learner.returns],
        "outcomes": learner.outcomes,
        "violations": learner.violations,
        "promises": None if learner.promises is None else learner.promises.to_state(),
    }


def restore(learner: Learner, state: Mapping[str, Any]) -> Position | None:
    """Bring a fresh learner into the state of a checkpoint.

    Not in the paper: resuming.

    Returns: how far the run had come; None, and the learner unchanged, if the state does not fit it.
    """
    try:
        q = [[_value(x) for x in row] for row in state["q"]]
        steps = [_count(x) for x in state["steps"]]
        returns = [_value(x) for x in state["returns"]]
        outcomes = [_count(x) for x in state["outcomes"]]
        paths = [tuple(map(_count, path)) for path in state["paths"]]
        looks = tuple((_count(e), _count(n), paths[_count(k)]) for e, n, k in state["looks"])
        position = Position(_count(state["chunks"]), looks, float(state["seconds"]))
        violations = _count(state["violations"])
        tried, claims = _promises(learner, state["promises"])
    except (KeyError, TypeError, ValueError, OverflowError, IndexError):
        return None
    task, settings = learner.task, learner.settings
    done = min(position.chunks * CHUNK, settings.episodes)
    shapes_fit = len(q) == task.n_states and all(len(row) == task.n_actions for row in q)
    logs_fit = len(steps) == len(returns) == len(outcomes) == done and len(looks) == position.chunks
    known = all(0 <= s < task.n_states for path in paths for s in path) and max(outcomes, default=0) < len(ENDINGS)
    if not shapes_fit or not logs_fit or not known:
        return None
    learner.forbid((s, a) for s, row in enumerate(q) for a, value in enumerate(row) if value == -inf)
    learner.recall(tried, claims)
    learner.q[:] = q
    learner.steps, learner.returns, learner.outcomes = steps, returns, outcomes
    learner.env_steps, learner.violations = sum(steps), violations
    return position


def _promises(learner: Learner, state: Any) -> tuple[list[tuple[int, int]], list[float]]:
    """Read what a checkpoint says of promises; ValueError or a relative if it does not fit the learner."""
    if learner.promises is None:
        return [], []
    n_states, n_actions = learner.task.n_states, learner.task.n_actions
    tried = [(_count(s), _count(a)) for s, a in state["tried"]]
    claims = [float(x) for x in state["claims"]]
    if len(claims) != n_states or any(s >= n_states or a >= n_actions for s, a in tried):
        raise ValueError
    return tried, claims


def _value(item: Any) -> float:
    if isinstance(item, str):
        return {"inf": inf, "-inf": -inf}[item]
    return float(item)


def _count(item: Any) -> int:
    if type(item) is not int or item < 0:
        raise ValueError
    return item
