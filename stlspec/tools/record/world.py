"""The live environment of a recording: steps, frames, and the way back.

In: an `Environment` and actions. Out: `Moment`s, what was observed after each. The real gymnasium environment is
stepped, so that ice is as slippery as it is. The way back is taken by repeating the steps from the same seed: the
dice fall again as they fell, and undoing a step cannot be used to roll them anew.
"""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any, Literal

import gymnasium
import numpy as np
from numpy.typing import NDArray

from stlspec.envs.foreign import make
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic

Kind = Literal["map", "frames", "values"]
"""How an environment is shown: by its map, by what it renders, or by its observations as numbers."""

_MOST_ACTIONS = 1000
_QUIET = {"PYGAME_HIDE_SUPPORT_PROMPT": "1", "SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy"}


@dataclass(frozen=True, slots=True)
class Moment:
    """What was observed: the state as a file holds it, info, and why the episode is over ("" if it is not)."""

    state: Any
    info: Mapping[str, Any] = field(default_factory=dict)
    ended: str = ""


class World:
    """A live environment. Use it from one thread; `close` it."""

    def __init__(self, environment: Environment, seed: int = 0) -> None:
        """Make the environment.

        Raises: UsageError D843: gymnasium cannot make it; D885: it cannot be recorded.
        """
        self.environment, self._seed = environment, seed
        live = make(environment, disable_env_checker=True)
        self.kind: Kind = "map" if environment.map is not None and environment.n_columns else "values"
        if self.kind == "values" and "rgb_array" in (live.metadata.get("render_modes") or ()):
            self.kind = "frames"
            live.close()
            # Frames need neither a screen nor sound, and pygame would greet on stdout.
            for name, value in _QUIET.items():
                os.environ.setdefault(name, value)
            live = make(environment, disable_env_checker=True, render_mode="rgb_array")
        self._live = live
        space = live.action_space
        if not isinstance(space, gymnasium.spaces.Discrete) or space.n > _MOST_ACTIONS:
            live.close()
            raise self._refusal(f"its actions are {_shown(space)}", "choose one with discrete actions, a key for each")
        self.first_action, self.n_actions = int(space.start), int(space.n)

    def reset(self, episode: int) -> Moment:
        """Begin an episode; its number chooses the dice. Raises: UsageError D885: the environment failed."""
        try:
            observation, info = self._live.reset(seed=self._seed + episode)
        except Exception as error:  # An environment may raise anything; it is the user's choice, not our fault.
            raise self._failed(error) from error
        return Moment(self._state(observation), info)

    def step(self, action: int) -> Moment:
        """Take an action. Raises: UsageError D885: the environment failed."""
        try:
            observation, _, terminated, truncated, info = self._live.step(action)
        except Exception as error:  # See `reset`.
            raise self._failed(error) from error
        ended = "the environment ended the episode here" if terminated else ""
        if truncated and not terminated:
            ended = "the environment's step limit is reached"
        return Moment(self._state(observation), info, ended)

    def rewind(self, episode: int, actions: Sequence[int]) -> Moment:
        """Go back to where some actions lead from the start of an episode. Raises: as `step`."""
        moment = self.reset(episode)
        for action in actions:
            moment = self.step(action)
        return moment

    def frame(self) -> NDArray[np.uint8] | None:
        """Render what is to be seen, (height, width, 3); None where nothing is.

        Raises: UsageError D885: rendering fails, most often because pygame is missing.
        """
        if self.kind != "frames":
            return None
        try:
            found: Any = self._live.render()
        except Exception as error:  # See `reset`.
            if isinstance(error, gymnasium.error.DependencyNotInstalled | ImportError) and find_spec("pygame") is None:
                way = "install the extra: pip install 'stlspec[record]'"
                raise self._refusal("rendering its frames needs pygame, which is not installed", way) from error
            raise self._failed(error) from error
        picture = np.asarray(found)
        if picture.ndim != 3 or picture.shape[2] != 3 or picture.dtype != np.uint8:
            raise self._refusal("it renders no picture", "choose an environment with the render mode rgb_array")
        return picture

    def close(self) -> None:
        """Let go of the environment."""
        self._live.close()

    def _state(self, observation: Any) -> Any:
        if self.environment.n_states:
            return self.environment.decode(self.environment.encode(observation))
        state = _listed(observation)
        try:
            json.dumps(state, allow_nan=False)
        except (TypeError, ValueError, RecursionError):
            raise self._refusal(f"it observes {_shown(state)}", "choose one that observes finite numbers") from None
        return state

    def _failed(self, error: Exception) -> UsageError:
        reason = f"{type(error).__name__}: {error}".splitlines()[0][:200]
        return self._refusal(f"it failed with {reason}", "is it meant to be used this way?")

    def _refusal(self, reason: str, way: str) -> UsageError:
        return UsageError([diagnostic("D885", id=self.environment.id, reason=reason, help=way)])


def _listed(value: Any) -> Any:
    """Return an observation as JSON holds it."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _listed(entry) for key, entry in value.items()}
    return [_listed(entry) for entry in value] if isinstance(value, list | tuple) else value


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
