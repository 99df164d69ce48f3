"""A spec around any gymnasium environment: what it demands ends episodes, pays, and is reported.

In: an environment and a spec. Out: `STLReward`, an environment with the two modifications of the paper: hard
requirements are watched at every step, and a reward map shapes the reward without changing what is optimal.
Robustness and verdicts come from the spec's own online monitor, so they are exact whatever the formula.
"""

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import Any, Literal, SupportsFloat

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.utils import RecordConstructorArgs
from gymnasium.wrappers import Autoreset

from stlspec import api
from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import dump, load, meaning_sha256
from stlspec.compiler.dependencies import ancestors
from stlspec.documents import DamageError
from stlspec.envs.bins import read_bins
from stlspec.envs.catalogue import environment_of, make_environment
from stlspec.envs.gridworld import GridWorld
from stlspec.envs.live import Reader, readers_of, sample_of
from stlspec.envs.model import Environment
from stlspec.errors import DataError, StlspecError, UsageError, diagnostic
from stlspec.errors.model import render
from stlspec.rewards import RewardMap, load_reward, read_reward
from stlspec.semantics.evaluation import Verdict
from stlspec.semantics.online.monitor import Monitor, make_monitor

PENALTY = 1.0
"""What a violation costs, whatever the base reward: as much as all goals pay."""

STEP_COST = 0.01
"""What a step costs with the base reward of the spec."""

ELSEWHERE = 0.05
"""How much of a reward map from another environment or map counts: the learner's promises differ as little there."""

Base = Literal["env", "spec"]
OnViolation = Literal["terminate", "penalise", "ignore"]
_CHOICES = {"base": ("env", "spec"), "on_violation": ("terminate", "penalise", "ignore")}


class STLReward(gymnasium.Wrapper[Any, Any, Any, Any], RecordConstructorArgs):
    """Watches and rewards an environment by a spec.

    Paper: section 3.2: the robustness of the partial run, and the reward of the demonstrations, as potential.

    Every step pays base + gamma * Phi(s') - Phi(s), less 1 for a violation of a hard requirement. base "env": the
    environment's own reward. base "spec": -1/100, and the share of 1 by weight of each soft requirement that has
    become certain to hold, as soon as all that it depends on holds so far or is violated for good; the episode
    ends when no soft requirement is open any more, and no hard one that does not hold so far, such as an
    `eventually` that is still to be met. Phi is the reward map, 0 without one and 0 where an episode terminates;
    a truncated episode goes on in principle, so it keeps its Phi. A map that was inferred in another environment
    or on another map shapes by 1/20 of it only, for the order of its states may mislead here.
    on_violation "terminate": ends the episode. "penalise": the episode goes on, and from the next sample on the
    requirement is watched afresh, so that staying in a forbidden place costs 1 a step. "ignore": costs nothing.
    Where the environment terminates an episode, a hard requirement that is still open and does not hold so far
    is violated at that step; where it truncates one, nothing is decided.
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        spec: "str | Path | BundleData",
        reward: "str | Path | Mapping[str, Any] | RewardMap | None" = None,
        gamma: float = 0.99,
        base: Base = "env",
        on_violation: OnViolation = "terminate",
        params: Mapping[str, float | str] | None = None,
    ) -> None:
        """Wrap an environment; with vector environments wrap each sub-environment.

        Args:    env: any environment of gymnasium; the built-in ones offer their signals by name, all others
                 through `from "obs[0]"`, `from "obs.key[1]"`, `from "info.speed"`, `from "action[0]"`.
                 spec: the path of a spec or bundle, or the text of a spec. reward: a reward map, its document,
                 or its path; a Python warning tells that it is of another spec (D865) or place (D883).
                 gamma: the discount that the agent uses, in [0, 1]. base, on_violation: see the class.
                 params: of the spec.
        Raises:  SpecError, InputError: the spec or the reward map cannot be used; UsageError D870: a signal is
                 not offered; D871: an option is out of range; D876: the spec measures stamps; D880: the
                 environment resets itself, or `reward` is none.
        """
        if isinstance(env, gymnasium.vector.VectorEnv):
            what = "STLReward wraps one environment, and this is a vector of them"
            way_out = "wrap each: SyncVectorEnv([lambda: STLReward(gymnasium.make(ID), SPEC)] * 4)"
            raise UsageError([diagnostic("D880", what=what, help=way_out)])
        plain: dict[str, Any] = {
            # What is recorded makes the wrapper again elsewhere, so it is text, a bundle as its document.
            "spec": dump(spec).decode() if isinstance(spec, BundleData) else str(spec),
            "reward": reward.to_json() if isinstance(reward, RewardMap) else _as_text(reward),
            "params": None if params is None else dict(params),
        }
        RecordConstructorArgs.__init__(self, gamma=gamma, base=base, on_violation=on_violation, **plain)
        gymnasium.Wrapper.__init__(self, env)
        _check(env, gamma, base=base, on_violation=on_violation)
        self.bundle = _bundle(spec, params)
        if self.bundle.time.kind == "stamps":
            raise UsageError([diagnostic("D876", file=self.bundle.sources[0][0] if self.bundle.sources else None)])
        self.gamma, self.base, self.on_violation = float(gamma), base, on_violation
        self._known = _known(env)
        self._readers = _readers(self.bundle, self._known, _id(env))
        self._potential = _Potential(_reward(reward), self._known, None if env.spec is None else env.spec.id)
        self._potential.warn(self.bundle)
        self._hard = [r.name for r in self.bundle.requirements if r.strength == "hard"]
        soft = [(r.name, w) for r, w in zip(self.bundle.requirements, self.bundle.weights, strict=True)]
        soft = [(name, weight) for name, weight in soft if name not in self._hard]
        self._shares = {name: weight / sum(w for _, w in soft) for name, weight in soft}
        self._before = _prerequisites(self.bundle)
        used = {str(node.value) for node in self.bundle.nodes if node.op in ("signal", "bool")}
        self._late = any((s.source or "").startswith("action") for s in self.bundle.signals if s.name in used)
        self._over = True

    def __getstate__(self) -> dict[str, Any]:
        """Leave out functions that were made for this environment and spec, and save what monitors remember."""
        state = {name: value for name, value in self.__dict__.items() if name != "_readers"}
        if "_monitor" in state:
            state["_monitor"] = self._monitor.to_bytes()
            state["_guards"] = {name: guard.to_bytes() for name, guard in self._guards.items()}
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Make readers and monitors again."""
        self.__dict__.update(state)
        self._readers = _readers(self.bundle, self._known, _id(self.env))
        if "_monitor" in state:
            self._monitor = Monitor.from_bytes(self.bundle, state["_monitor"])
            saved = state["_guards"].items()
            self._guards = {name: Monitor.from_bytes(_alone(self.bundle, name), data) for name, data in saved}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode; see `gymnasium.Env.reset`. The info has what the steps' have, but for the reward."""
        observation, info = self.env.reset(seed=seed, options=options)
        self._monitor = make_monitor(self.bundle)
        self._guards = {name: make_monitor(_alone(self.bundle, name)) for name in self._hard}
        self._paid: set[str] = set()
        self._phi = self._potential(observation)
        self._first = (observation, info) if self._late else None
        self._over = False
        violated = False if self._late else self._look(observation, None, info)
        # nobody can end an episode that begins with a violation before its first step
        self._began_badly = violated
        return observation, {**info, **self._report(violated)}

    def step(self, action: Any) -> tuple[Any, SupportsFloat, bool, bool, dict[str, Any]]:
        """Take a step; see `gymnasium.Env.step`.

        Returns: the info has `original_reward`; `robustness`, for each requirement that of the episode so far,
                 and `satisfied`, whether it would hold if the episode ended here; `violation`, whether this step
                 violated a hard requirement.
        """
        if self._over:
            raise ResetNeeded("STLReward: the episode is over; call reset() before the next step")
        observation, own, terminated, truncated, info = self.env.step(action)
        violated = self._began_badly
        if self._first is not None:
            violated = self._look(self._first[0], action, self._first[1])
            self._first = None
        violated = self._look(observation, action, info) or violated
        violated = violated or (bool(terminated) and self._unmet(self._hard))
        self._began_badly = False
        gained = float(own) if self.base == "env" else self._gained()
        if violated and self.on_violation != "ignore":
            gained -= PENALTY
        terminated = bool(terminated) or (violated and self.on_violation == "terminate") or self._settled()
        ahead = 0.0 if terminated else self._potential(observation)
        reward = gained + self.gamma * ahead - self._phi
        self._phi = ahead
        self._over = terminated or bool(truncated)
        more = {"original_reward": float(own), **self._report(violated)}
        return observation, reward, terminated, bool(truncated), {**info, **more}

    def _look(self, observation: Any, action: Any, info: Any) -> bool:
        """Show the monitors a sample; tell whether it violates a hard requirement."""
        sample = sample_of(self._readers, observation, action, info, _id(self.env))
        self._standing = self._monitor.update(sample)
        self._ends = self._monitor.finish()
        violated = False
        for name, guard in self._guards.items():
            if guard.update(sample)[name].verdict is Verdict.VIOLATED:
                violated = True
                self._guards[name] = make_monitor(_alone(self.bundle, name))
        return violated

    def _unmet(self, names: Iterable[str]) -> bool:
        """Tell whether one of some requirements is open and would be violated if the episode ended here."""
        standing, ends = self._standing, self._ends
        return any(
            standing[name].verdict is Verdict.UNDECIDED and ends[name].verdict is Verdict.VIOLATED for name in names
        )

    def _gained(self) -> float:
        certain = {n for n in self._shares if self._standing[n].verdict is Verdict.SATISFIED} - self._paid
        held = {name for name in certain if not self._unmet(self._before[name])}
        self._paid |= held
        return sum((self._shares[name] for name in sorted(held)), -STEP_COST)

    def _settled(self) -> bool:
        """Tell whether the spec has nothing more to pay for, and nothing more to ask for."""
        if self.base == "env" or not self._shares:
            return False
        decided = all(self._standing[name].verdict is not Verdict.UNDECIDED for name in self._shares)
        return decided and not self._unmet(self._hard)

    def _report(self, violated: bool) -> dict[str, Any]:
        names = [r.name for r in self.bundle.requirements]
        if self._late and self._first is not None:
            return {
                "robustness": dict.fromkeys(names, 0.0),
                "satisfied": dict.fromkeys(names, False),
                "violation": False,
            }
        ends = self._ends
        return {
            "robustness": {name: float(ends[name].robustness) for name in names},
            "satisfied": {name: ends[name].verdict is Verdict.SATISFIED for name in names},
            "violation": violated,
        }


def _as_text(place: Any) -> Any:
    return str(place) if isinstance(place, Path) else place


def _check(env: gymnasium.Env[Any, Any], gamma: float, **chosen: str) -> None:
    layer: Any = env
    while isinstance(layer, gymnasium.Wrapper):
        if isinstance(layer, Autoreset):
            what = "STLReward cannot see where an episode begins if the environment below resets itself"
            raise UsageError([diagnostic("D880", what=what, help="put Autoreset around STLReward, not under it")])
        layer = layer.env
    if isinstance(gamma, bool) or not isinstance(gamma, int | float) or not isfinite(gamma) or not 0 <= gamma <= 1:
        raise UsageError([diagnostic("D871", option="gamma", value=str(gamma)[:40], allowed="from 0 to 1")])
    for option, value in chosen.items():
        if value not in _CHOICES[option]:
            allowed = "one of " + ", ".join(_CHOICES[option])
            raise UsageError([diagnostic("D871", option=option, value=str(value)[:40], allowed=allowed)])


def _bundle(spec: "str | Path | BundleData", params: Mapping[str, float | str] | None) -> BundleData:
    if isinstance(spec, str) and spec.startswith("{"):
        spec = load(spec.encode())
    if isinstance(spec, BundleData):
        if params:
            what, way = "params are bound when a bundle is compiled, so it takes none here", "give the spec's path"
            raise UsageError([diagnostic("D880", what=what, help=way)])
        return spec if isinstance(spec, api.Bundle) else api.publish(spec)
    if isinstance(spec, Path) or ("\n" not in spec and spec.endswith((".stl", ".stlspec", ".stlb"))):
        return api.read(spec, params)
    return api.compile(spec, params)


def _prerequisites(bundle: BundleData) -> dict[str, list[str]]:
    """Return the names of all that each requirement depends on, in one step or several."""
    names = [r.name for r in bundle.requirements]
    above = ancestors({r.name: r.depends_on for r in bundle.requirements})
    return {name: [names[i] for i in range(len(names)) if above[name] >> i & 1] for name in names}


def _alone(bundle: BundleData, name: str) -> BundleData:
    place = next(i for i, r in enumerate(bundle.requirements) if r.name == name)
    return replace(bundle, requirements=(bundle.requirements[place],), weights=(1.0,))


def _id(env: gymnasium.Env[Any, Any]) -> str:
    return env.spec.id if env.spec is not None else type(env.unwrapped).__name__


def _known(env: gymnasium.Env[Any, Any]) -> Environment | None:
    """Describe a built-in environment by the map that it really has; None for any other.

    Where a wrapper makes other observations of them, they are no longer the states that the signals are known for.
    """
    bare: Any = env.unwrapped
    while isinstance(env, gymnasium.Wrapper):
        if isinstance(env, gymnasium.ObservationWrapper):
            return None
        env = env.env
    if isinstance(bare, GridWorld):
        return make_environment("stlspec/GridWorld-v0", None, bare.map)
    kind = f"{type(bare).__module__}.{type(bare).__name__}"
    if kind == "gymnasium.envs.toy_text.frozen_lake.FrozenLakeEnv":
        rows = ["".join(mark.decode() for mark in row) for row in bare.desc.tolist()]
        return make_environment("FrozenLake-v1", None, rows)
    if kind == "gymnasium.envs.classic_control.mountain_car.MountainCarEnv":
        return make_environment("MountainCar-v0")
    return None


def _readers(bundle: BundleData, known: Environment | None, env: str) -> dict[str, Reader]:
    """Return a reader for every signal: a look-up by the number of the state, an entry, or a path."""
    if known is None or not known.n_states:
        return readers_of(bundle, () if known is None else known.signal_names, env)
    used = {str(node.value) for node in bundle.nodes if node.op in ("signal", "bool")}
    found: dict[str, Reader] = {}
    for signal in bundle.signals:
        source = signal.source or signal.name
        if signal.name in used and source in known.signal_names:
            found[signal.name] = _look_up(known.signals([source], range(known.n_states))[source].tolist())
    rest = tuple(signal for signal in bundle.signals if signal.name not in found)
    try:
        return found | readers_of(replace(bundle, signals=rest), (), env)
    except UsageError as error:
        (first,) = error.diagnostics[:1]
        offered = ", ".join(known.signal_names) + " and paths such as obs, info.x or action[0]"
        user = next((f"signal '{s.name}'" for s in rest if s.name in first.message), "the spec")
        name = next((s.source or s.name for s in rest if s.name in first.message), "?")
        raise UsageError([diagnostic("D870", env=env, signal=name, user=user, offered=offered)]) from None


def _look_up(table: list[Any]) -> Reader:
    return lambda observation, _action, _info: table[observation]


class _Potential:
    """The reward map as a function of observations; 0 without one."""

    def __init__(self, reward: RewardMap | None, known: Environment | None, env: str | None) -> None:
        self._reward, self._foreign = reward, False
        self._values: dict[int, float] = {}
        self._home: Environment | None = None
        if reward is None:
            return
        home = known if known is not None and known.n_states else None
        bins = reward.environment.get("bins")
        if home is None:
            home = _home_of(reward)
        if bins is not None and home is not None:
            home = replace(home, bins=read_bins(bins), binned=True)
        if home is None or not home.size:
            what = "the states of the reward map have no numbers here"
            raise UsageError([diagnostic("D880", what=what, help="infer it in the same environment, with --bins")])
        self._home, self._foreign = home, not _made_here(reward, known, env)
        scale = ELSEWHERE if self._foreign else 1.0
        self._values = {s: scale * value for s, value in enumerate(reward.table(home)) if value}

    def warn(self, bundle: BundleData) -> None:
        """Warn where the reward map is not of this spec, or not of this environment."""
        if self._reward is None:
            return
        found = [diagnostic("D865")] if self._reward.meaning_sha256 != meaning_sha256(bundle) else []
        found += [diagnostic("D883")] if self._foreign else []
        for warning in found:
            warnings.warn(render(warning), stacklevel=3)

    def __call__(self, observation: Any) -> float:
        """Return Phi of an observation."""
        if self._home is None:
            return 0.0
        plain = observation.tolist() if isinstance(observation, np.ndarray | np.generic) else observation
        return self._values.get(self._home.encode(plain), 0.0)


def _reward(reward: Any) -> RewardMap | None:
    """Return a reward map from what the caller has: the map, its document or its path."""
    if isinstance(reward, str | Path):
        return load_reward(reward)
    if isinstance(reward, Mapping):
        try:
            return read_reward(reward)
        except DamageError as error:
            raise DataError([diagnostic("D863", file="the reward map", problem=str(error))]) from None
    if reward is None or isinstance(reward, RewardMap):
        return reward
    what = f"`reward` is a reward map, its document or its path, not {type(reward).__name__}"
    raise UsageError([diagnostic("D880", what=what, help="make one: stlspec reward SPEC DEMO... -o R.json")])


def _made_here(reward: RewardMap, known: Environment | None, env: str | None) -> bool:
    """Tell whether a reward map was inferred in this environment, on this map where it has one."""
    if known is None:
        return env is None or reward.environment.get("id") == env
    home = _home_of(reward)
    return home is not None and home.id == known.id and _cells(home) == _cells(known)


def _cells(environment: Environment) -> list[str]:
    """Return the rows of a map; where episodes begin does not count."""
    return [row.replace("S", ".").replace("F", ".") for row in environment.map or ()]


def _home_of(reward: RewardMap) -> Environment | None:
    try:
        return environment_of(reward.environment)
    except StlspecError:
        return None
