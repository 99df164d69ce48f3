"""The options of a run, checked, with their defaults.

In: the options as the user gave them, None where left out. Out: `Settings`. Every default that depends on the
environment is decided here, so that training itself knows no environment.
"""

from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal

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
_MOST = 10**9


@dataclass(frozen=True, slots=True)
class Settings:
    """How to train.

    method: "shaped" (base reward and potential), "plain" (base reward alone, the matched baseline) or "paper"
    (Algorithm 2 to the letter). episodes, max_steps (in one episode): counts, >= 1. gamma: discount, in
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
) -> Settings:
    """Check the options and fill in what was left out.

    Paper: section 4 for gamma 0.99, epsilon 0.4 and alpha 0.1.

    Args:    as the fields of `Settings`; episodes, max_steps and mask may be None: a mask is right only where
             transitions are known to be deterministic. The method "paper" has none.
    Raises:  UsageError D871: an option is out of range.
    """
    if method not in METHODS:
        raise _wrong("method", method, "one of " + ", ".join(METHODS))
    if base not in BASES:
        raise _wrong("base", base, "one of " + ", ".join(BASES))
    if mask is None:
        mask = environment.deterministic
    if max_steps is None:
        max_steps = environment.max_steps or STEPS_PER_STATE * max(1, environment.n_states)
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
