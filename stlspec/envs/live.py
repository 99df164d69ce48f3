"""Living environments: bins for their observations, and signals read from what a step gives.

In: an `Environment` that is known by its id only, or a gymnasium environment of the user's. Out: the same with
bins; functions that read signals from observation, info and action. Making an environment runs its code: only
for callers whose user asked for it.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium.wrappers import OrderEnforcing, PassiveEnvChecker, TimeLimit

from stlspec.compiler.bundle import BundleData, Signal
from stlspec.envs.bins import MOST_BINS, Bins
from stlspec.envs.foreign import make
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic

Reader = Callable[[Any, Any, Any], Any]
"""Reads a signal from an observation, the action that led to it (None at the first) and the info."""

_FAR = 1e30
"""A bound beyond this is none: some environments write the largest 32-bit number."""
_FEW = 8
"""Entries for which a number each is worth writing out."""

_PATH = re.compile(r"(obs|action|info)((?:\.[A-Za-z_][A-Za-z0-9_]*|\[[0-9]{1,9}\])*)")
_STEP = re.compile(r"\.([A-Za-z_][A-Za-z0-9_]*)|\[([0-9]+)\]")


def bare(environment: Environment) -> gymnasium.Env[Any, Any]:
    """Make an environment without the wrappers that only check and count: the learner does both itself.

    Not in the paper: speed; a step of MountainCar takes half the time.

    Raises: UsageError D843: gymnasium could not make it.
    """
    live = make(environment)
    while isinstance(live, OrderEnforcing | PassiveEnvChecker | TimeLimit):
        live = live.env
    return live


def with_bins(environment: Environment, counts: Sequence[int] | None) -> Environment:
    """Number the observations of an environment whose states have no numbers.

    Paper: section 4, the mountain car "discretized into 50x50, 75x75 and 100x100".

    Args:    environment: with `n_states` 0. counts: bins along each entry of the observation, or one number for
             all entries; None = as they are, which needs discrete observations.
    Returns: the environment with `bins`, `n_actions` and its step limit.
    Raises:  UsageError D869: observations or actions are of a kind that has no table; D871: counts do not fit
             the observation; D843: gymnasium could not make the environment.
    """
    live = make(environment)
    observations, actions = live.observation_space, live.action_space
    limit = live.spec.max_episode_steps if live.spec is not None else None
    live.close()
    if not isinstance(actions, gymnasium.spaces.Discrete) or int(actions.start) != 0:
        raise _unfit(environment, f"its actions are {actions}, and the learner takes Discrete ones from 0")
    bins = _bins(environment, observations, counts)
    return replace(environment, bins=bins, binned=True, n_actions=int(actions.n), max_steps=limit)


def _bins(environment: Environment, space: gymnasium.Space[Any], counts: Sequence[int] | None) -> Bins:
    if isinstance(space, gymnasium.spaces.Discrete):
        if counts is not None:
            raise _wrong(counts, "left out: the observations are discrete", "leave --bins out")
        size, first = int(space.n), float(space.start)
        if size > MOST_BINS:
            raise _unfit(environment, f"it has {size} states, and a table holds {MOST_BINS} at most")
        return Bins((first,), (first + size,), (size,))
    if not isinstance(space, gymnasium.spaces.Box) or len(space.shape) != 1 or not space.shape[0]:
        raise _unfit(environment, f"its observations are {str(space)[:80]}, and bins need a flat Box")
    axes = space.shape[0]
    fitting = f"--bins {','.join(['50'] * axes) if axes <= _FEW else '50'}"
    if counts is None:
        raise _unfit(environment, "its observations are continuous", fitting)
    listed = list(counts) * axes if len(counts) == 1 else list(counts)
    if len(listed) != axes or any(type(n) is not int or not 1 <= n <= MOST_BINS for n in listed):
        raise _wrong(counts, f"1 or {axes} whole numbers from 1, one for each entry of the observation", fitting)
    ends = list(zip(map(float, space.low), map(float, space.high), strict=True))
    far = tuple(not (-_FAR < low < high < _FAR) for low, high in ends)
    low, high = zip(*((-1.0, 1.0) if out else pair for pair, out in zip(ends, far, strict=True)), strict=True)
    bins = Bins(low, high, tuple(listed), far if any(far) else ())
    if bins.size > MOST_BINS:
        raise _wrong(counts, f"at most {MOST_BINS} bins in all", "cut each entry into fewer bins")
    return bins


def _unfit(environment: Environment, reason: str, way_out: str = "learn in another environment") -> UsageError:
    return UsageError([diagnostic("D869", env=environment.id, reason=reason, help=way_out)])


def _wrong(counts: Sequence[int], allowed: str, way_out: str) -> UsageError:
    found = diagnostic("D871", option="--bins", value=",".join(map(str, counts))[:40], allowed=allowed)
    return UsageError([replace(found, help=way_out)])  # there is no default for what must be cut


def reader_of(signal: Signal, names: Sequence[str], env: str) -> Reader:
    """Return the function that reads a signal from a step.

    Not in the paper: DESIGN's `from "obs[0]"`, `from "obs.key[1]"`, `from "info.speed"`, `from "action[0]"`.

    Args:    signal: of the spec. names: what the entries of the observation are called, () = not known.
             env: the id of the environment, for messages.
    Returns: the reader; it raises KeyError, IndexError or TypeError where a step does not have the entry.
    Raises:  UsageError D870: the source of the signal is neither a path nor one of the names.
    """
    source = signal.source or signal.name
    if source in names:
        place = list(names).index(source)
        return lambda observation, _action, _info: observation[place]
    path = _PATH.fullmatch(source)
    if path is None:
        offered = ", ".join(names) or "paths only, such as obs[0], info.speed or action[0]"
        raise UsageError([diagnostic("D870", env=env, signal=source, user=f"signal '{signal.name}'", offered=offered)])
    steps = [int(place) if place else name for name, place in _STEP.findall(path[2])]
    start = ("obs", "action", "info").index(path[1])
    if start == 0 and len(steps) == 1:
        (only,) = steps
        return lambda observation, _action, _info: observation[only]

    def read(observation: Any, action: Any, info: Any) -> Any:
        value = (observation, action, info)[start]
        for step in steps:
            # an action of a Discrete space is a number of its own: action[0] is that number
            value = value if start == 1 and step == 0 and np.ndim(value) == 0 else value[step]
        return value

    return read


def readers_of(bundle: BundleData, names: Sequence[str], env: str) -> dict[str, Reader]:
    """Return a reader for every signal that a requirement uses. Arguments and errors as for `reader_of`."""
    used = {str(node.value) for node in bundle.nodes if node.op in ("signal", "bool")}
    return {
        signal.name: _within(reader_of(signal, names, env), signal) for signal in bundle.signals if signal.name in used
    }


def _within(read: Reader, signal: Signal) -> Reader:
    """Take what a 32-bit observation makes of a bound for the bound: -1.2 comes back as -1.2000000476837158."""
    bounds = [bound for bound in (signal.low, signal.high) if bound is not None and abs(bound) < 3e38]
    if not bounds:
        return read
    low, high = min(bounds) if signal.low is not None else -np.inf, max(bounds) if signal.high is not None else np.inf

    def clipped(observation: Any, action: Any, info: Any) -> Any:
        value = read(observation, action, info)
        if isinstance(value, int | float) and not low <= value <= high and abs(value) < 3e38:
            return next((bound for bound in bounds if np.float32(bound) == np.float32(value)), value)
        return value

    return clipped


def sample_of(readers: Mapping[str, Reader], observation: Any, action: Any, info: Any, env: str) -> dict[str, Any]:
    """Read all signals at one step.

    Not in the paper: the step of an environment as a sample of the spec.

    Args:    action: the one that led here; at the first sample None, which reads as NaN where a signal is of it.
    Raises:  UsageError D879: the step does not have an entry that a signal is read from.
    """
    sample = {}
    for name, read in readers.items():
        try:
            value = read(observation, action, info)
        except (KeyError, IndexError, TypeError) as error:
            shown = f"{type(error).__name__}: {error}"[:80]
            raise UsageError([diagnostic("D879", env=env, signal=name, reason=shown)]) from None
        if isinstance(value, np.ndarray | np.generic):
            value = value.item() if value.ndim == 0 else value.tolist()
        sample[name] = value
    return sample
