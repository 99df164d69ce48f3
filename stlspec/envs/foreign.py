"""Any environment that gymnasium knows and stlspec does not.

In: an id. Out: an `Environment` that offers no signals: a spec reads it through `from "obs[0]"`. Nothing is
made here, since an id may come from a data file, and making an environment can run anything; `make` is for
callers whose user asked for it.
"""

import difflib
import warnings
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import gymnasium

from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic


def environment(env_id: str, args: Mapping[str, Any], rows: Sequence[str] | None, ids: Sequence[str]) -> Environment:
    """Describe a registered gymnasium environment whose states are raw observations.

    Not in the paper: it stands for everything beyond the paper's environments.

    Args: env_id, args: as for `gymnasium.make`. rows: a map; must be None. ids: further known ids, for a
        suggestion.
    Raises: UsageError D820: gymnasium has no such environment; D821: there is a map.
    """
    spec = gymnasium.registry.get(env_id)
    if spec is None:
        close = difflib.get_close_matches(env_id, [*ids, *gymnasium.registry], 1)
        known = "known are " + ", ".join(ids) + ", and every id that gymnasium has registered; for one of your own "
        known += "name the module that registers it: --env MODULE:ID"
        hint = f"did you mean '{close[0]}'?" if close else known
        raise UsageError([diagnostic("D820", id=env_id[:60], help=hint)])
    if rows is not None:
        raise UsageError([diagnostic("D821", id=env_id, what="a map", help="leave out the map")])
    return Environment(id=env_id, args=dict(args), max_steps=spec.max_episode_steps, options=dict(args))


def registering(module: str, env_id: str) -> None:
    """Import the module that registers an environment, because the user has named it.

    Not in the paper: gymnasium's own form MODULE:ID.

    Raises: UsageError D843: it cannot be imported.
    """
    try:
        import_module(module)
    except Exception as error:
        # What a module does on import is its own affair, so anything may be raised.
        lines = str(error).splitlines() or [type(error).__name__]
        place = "it is looked for in the current folder and among the installed packages"
        reason = f"module '{module}' cannot be imported ({lines[0][:120]}); {place}"
        raise UsageError([diagnostic("D843", id=env_id, reason=reason)]) from error


def make(environment: Environment, **options: Any) -> gymnasium.Env[Any, Any]:
    """Make the live gymnasium environment that `environment` describes.

    Not in the paper: the learner runs on tables where it can.

    Args: options: further keyword arguments of `gymnasium.make`, such as render_mode.
    Raises: UsageError D843: gymnasium could not make it.
    """
    return make_quietly(environment.asked, {**environment.options, **options})


def make_quietly(env_id: str, options: Mapping[str, Any]) -> gymnasium.Env[Any, Any]:
    """Call `gymnasium.make` without its warnings, and with its errors as a diagnostic.

    Not in the paper: packaging.

    Raises: UsageError D843: gymnasium could not make it.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return gymnasium.make(env_id, **options)
    except Exception as error:
        # An environment's constructor may raise anything; all of it is caused by what the user asked for.
        reason = f"{type(error).__name__}: {error}".splitlines()[0][:200]
        raise UsageError([diagnostic("D843", id=env_id, reason=reason)]) from error
