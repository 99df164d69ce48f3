"""The options of a run, checked, with their defaults.

In: the options as the user gave them, None where left out. Out: `Settings`. Every default that depends on the
environment is decided here, so that training itself knows no environment.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal

from stlspec.compiler.bundle import BundleData
from stlspec.demos import Demonstration
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic

Method = Literal["shaped", "paper", "plain"]
METHODS: tuple[Method, ...] = ("shaped", "paper", "plain")
Base = Literal["spec", "env"]
BASES: tuple[Base, ...] = ("spec", "env")

EPISODES_BY_SIDE = ((5, 3000), (7, 5000))
"""On maps: episodes for sides up to this; larger ones get `EPISODES_ON_LARGE_MAPS`."""
EPISODES_ON_LARGE_MAPS = 10_000
EPISODES_ELSEWHERE = 5000
STEPS_PER_STATE = 4
"""Step limit of an episode for each state, where the environment has no limit of its own."""
STEPS_BETWEEN_BINS = 1000
"""What that comes to at most where states are bins: finer bins make no way longer."""
STEPS_PER_DEMONSTRATED_STEP = 2
"""Step limit for each step of the longest demonstration, which leaves room to explore."""
STEPS_AHEAD = 10_000
"""How far ahead a spec may look to raise the limit: a bound that stands for "for ever" says nothing about episodes."""
_MOST = 10**9


@dataclass(frozen=True, slots=True)
class Settings:
    """How to train.

    method: "shaped" (base reward and potential), "plain" (base reward alone, the matched baseline) or "paper"
    (Algorithm 2 to the letter). episodes, max_steps (in one episode, which goes from one goal to the next where
    there are several): counts, >= 1. gamma: discount, in
    [0, 1]. alpha: learning rate, in (0, 1]. epsilon: share of random actions, in [0, 1]. step_cost: what a
    step costs, >= 0. mask: never take a pair of state and action again that led to a violation. base: whose
    reward is the base, the spec's (goal, violation, steps) or the environment's own.
    """

    method: Method
    episodes: int
    seed: int
    max_steps: int
    gamma: float
    alpha: float
    epsilon: float
    step_cost: float
    mask: bool
    base: Base = "spec"


def default_episodes(environment: Environment) -> int:
    """Return how many episodes to train for. Paper: section 4, "from 3000 to 10000", by the side of a map."""
    if environment.map is None:
        return EPISODES_ELSEWHERE
    side = max(len(environment.map), *map(len, environment.map))
    return next((count for limit, count in EPISODES_BY_SIDE if side <= limit), EPISODES_ON_LARGE_MAPS)


def default_max_steps(environment: Environment, needed: int = 0) -> int:
    """Return the step limit of an episode: the environment's own, else one that leaves time to get anywhere.

    Not in the paper: it has no step limits.

    Args: environment: whose states have numbers, by themselves or by bins. needed: see `needed_steps`.
    """
    if environment.max_steps:
        return environment.max_steps
    most = STEPS_PER_STATE * max(1, environment.size)
    return max(needed, most if environment.bins is None else min(most, STEPS_BETWEEN_BINS))


def needed_steps(bundle: BundleData, demonstrations: Sequence[Demonstration]) -> int:
    """Return how many steps an episode needs at least: twice the longest demonstration, and as far as the spec looks.

    Not in the paper: it has no step limits.
    """
    tick = bundle.time.period or 1
    ahead = max((r.horizon // tick for r in bundle.requirements if r.horizon is not None), default=0)
    shown = max((d.n_samples - 1 for d in demonstrations), default=0)
    return max(STEPS_PER_DEMONSTRATED_STEP * shown, min(ahead, STEPS_AHEAD))


def make_settings(
    environment: Environment,
    *,
    method: str,
    episodes: int | None,
    seed: int,
    max_steps: int | None,
    gamma: float,
    alpha: float,
    epsilon: float,
    step_cost: float,
    mask: bool | None,
    base: str = "spec",
    needed: int = 0,
) -> Settings:
    """Check the options and fill in what was left out.

    Paper: section 4 for gamma 0.99, epsilon 0.4 and alpha 0.1.

    Args:    as the fields of `Settings`; episodes, max_steps and mask may be None: a mask is right only where
             transitions are known to be deterministic. The method "paper" has none. needed: see `needed_steps`.
    Raises:  UsageError D871: an option is out of range.
    """
    if method not in METHODS:
        raise _wrong("method", method, "one of " + ", ".join(METHODS))
    if base not in BASES:
        raise _wrong("base", base, "one of " + ", ".join(BASES))
    if mask is None:
        mask = environment.deterministic
    if max_steps is None:
        max_steps = default_max_steps(environment, needed)
    settings = Settings(
        next(m for m in METHODS if m == method),
        _whole("episodes", default_episodes(environment) if episodes is None else episodes, 1),
        _whole("seed", seed, 0),
        _whole("max-steps", max_steps, 1),
        _number("gamma", gamma, 0.0, 1.0),
        _number("alpha", alpha, 0.0, 1.0),
        _number("epsilon", epsilon, 0.0, 1.0),
        _number("step-cost", step_cost, 0.0, 1e6),
        bool(mask) and method != "paper",
        next(b for b in BASES if b == base),
    )
    if settings.alpha == 0:
        raise _wrong("alpha", alpha, "above 0: with a learning rate of 0 nothing is learned")
    return settings


def _whole(option: str, value: Any, least: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= _MOST:
        raise _wrong(option, value, f"a whole number from {least} to {_MOST}")
    return value


def _number(option: str, value: Any, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise _wrong(option, value, "a number")
    if not low <= value <= high:
        raise _wrong(option, value, f"from {low:g} to {high:g}")
    return float(value)


def _wrong(option: str, value: Any, allowed: str) -> UsageError:
    return UsageError([diagnostic("D871", option=f"--{option}", value=str(value)[:40], allowed=allowed)])
