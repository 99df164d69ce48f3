"""The state of an unfinished run, as JSON and back.

In: a `Learner` between two chunks of episodes. Out: what a checkpoint holds, and a learner in the same state
again, to the bit: JSON keeps every digit of a float. A checkpoint is an input like any other: one that does
not fit is ignored, and the run starts from the beginning.
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
from stlspec.learning.shaping import ENDINGS

_FORMAT = 1

Check = tuple[int, int, bool]
"""A look at the greedy path: episodes and steps so far, and whether it meets every requirement."""


@dataclass(frozen=True, slots=True)
class Position:
    """How far a run has come: chunks of episodes done, checks so far, seconds spent."""

    chunks: int
    checks: tuple[Check, ...]
    seconds: float


def fingerprint(
    bundle: BundleData, environment: Environment, learner: Learner, prefilled: Sequence[tuple[int, int]]
) -> str:
    """Hash everything that the course of a run depends on; equal runs have equal fingerprints.

    Not in the paper: a checkpoint of any other run is worthless.

    Returns: SHA-256, hexadecimal.
    """
    spec = (bundle.time, bundle.signals, bundle.requirements, bundle.nodes)
    world = (environment.fingerprint, environment.describe(), learner.task)
    run = (_FORMAT, CHUNK, learner.settings, learner.reward, tuple(prefilled), spec, world)
    return hashlib.sha256(repr(run).encode()).hexdigest()


def to_state(learner: Learner, position: Position) -> dict[str, Any]:
    """Return what a checkpoint holds."""
    return {
        "chunks": position.chunks,
        "checks": [list(check) for check in position.checks],
        "seconds": position.seconds,
        "q": [[number(value) for value in row] for row in learner.q],
        "steps": learner.steps,
        "returns": [number(value) for value in learner.returns],
        "outcomes": learner.outcomes,
        "violations": learner.violations,
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
        checks = tuple((_count(e), _count(n), bool(ok)) for e, n, ok in state["checks"])
        position = Position(_count(state["chunks"]), checks, float(state["seconds"]))
        violations = _count(state["violations"])
    except (KeyError, TypeError, ValueError, OverflowError):
        return None
    task, settings = learner.task, learner.settings
    done = min(position.chunks * CHUNK, settings.episodes)
    shapes_fit = len(q) == task.n_states and all(len(row) == task.n_actions for row in q)
    logs_fit = len(steps) == len(returns) == len(outcomes) == done and len(checks) == position.chunks
    if not shapes_fit or not logs_fit or max(outcomes, default=0) >= len(ENDINGS):
        return None
    learner.forbid((s, a) for s, row in enumerate(q) for a, value in enumerate(row) if value == -inf)
    learner.q[:] = q
    learner.steps, learner.returns, learner.outcomes = steps, returns, outcomes
    learner.env_steps, learner.violations = sum(steps), violations
    return position


def _value(item: Any) -> float:
    if isinstance(item, str):
        return {"inf": inf, "-inf": -inf}[item]
    return float(item)


def _count(item: Any) -> int:
    if type(item) is not int or item < 0:
        raise ValueError
    return item
