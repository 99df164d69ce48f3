"""Environments by their ids.

In: an id, arguments and a map, from the command line or from a data file. Out: an `Environment`. The built-in
ones are known without package metadata; other packages add theirs through the entry point group
`stlspec.environments` (a callable that takes args and map); what is left is looked up in gymnasium. Factories
are named, not imported, so that gymnasium loads only when an environment is asked for.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from stlspec.envs.maps import read_map
from stlspec.envs.model import Environment
from stlspec.errors import Diagnostic, StlspecError, UsageError, diagnostic

__all__ = ["BUILT_IN", "environment_of", "make_environment", "parse_env_args", "read_map"]

GROUP = "stlspec.environments"
BUILT_IN = ("stlspec/GridWorld-v0", "FrozenLake-v1", "MountainCar-v0")
_FACTORIES = {
    "stlspec/GridWorld-v0": "stlspec.envs.gridworld:environment",
    "FrozenLake-v1": "stlspec.envs.frozenlake:environment",
    "MountainCar-v0": "stlspec.envs.mountaincar:environment",
}
_FOREIGN = "stlspec.envs.foreign:environment"
_REGISTERING = "stlspec.envs.foreign:registering"
_MODULE = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*")
_LIVE = "stlspec.envs.foreign:make"
_INTEGER = re.compile(r"[+-]?[0-9]{1,18}")
_FLOAT = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,4})?")
_KEPT = 16


def make_environment(
    id: str,  # noqa: A002
    args: Mapping[str, Any] | None = None,
    map_rows: Sequence[str] | None = None,
    *,
    file: str | None = None,
) -> Environment:
    """Describe the environment `id`.

    Not in the paper: the paper's environments and any other of gymnasium.

    Args: id: of one that is built in, added by a package, or registered in gymnasium; MODULE:ID imports the
        module first, as `gymnasium.make` does, so take no such id from data. args: its arguments. map_rows: its
        map, if it takes one, as rows or as lines of text. file: the input that asks for it, for messages.
    Returns: the same object for the same request, since environments do not change.
    Raises: InputError D820, D821, D823 to D826, D842, D843.
    """
    rows = None if map_rows is None else _rows(map_rows)
    try:
        key = json.dumps(dict(args or {}), sort_keys=True)
    except (TypeError, ValueError, RecursionError):
        what = "arguments that are not JSON"
        raise UsageError([diagnostic("D821", file=file, id=id, what=what, help="use plain values")]) from None
    try:
        return _made(id, key, rows)
    except StlspecError as error:
        raise type(error)([_in_file(d, file) for d in error.diagnostics]) from error


def make_live(environment: Environment, **options: Any) -> Any:
    """Make the live gymnasium environment that `environment` describes.

    Not in the paper: an interface.

    Args:   options: further keyword arguments of `gymnasium.make`, such as render_mode.
    Raises: UsageError D843: gymnasium could not make it.
    """
    return EntryPoint(environment.id, _LIVE, GROUP).load()(environment, **options)


def environment_of(description: Any, *, file: str | None = None) -> Environment:
    """Make the environment that a file describes as {"id", "args", "map"}.

    Not in the paper: a file format.

    Raises: UsageError D829: it is described in another way, or its id names a module; otherwise as
        `make_environment`.
    """
    reason = _misdescribed(description)
    if reason:
        raise UsageError([diagnostic("D829", file=file, reason=reason)])
    return make_environment(description["id"], description.get("args"), description.get("map"), file=file)


def parse_env_args(texts: Sequence[str]) -> dict[str, Any]:
    """Read `--env-arg KEY=VALUE` options: true, false, a whole number, a number, or else a word.

    Not in the paper: the command line.

    Raises: UsageError D822: an option is not of that form, or a key comes twice.
    """
    values: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        reason = ""
        if not equals:
            reason = "there is no '='"
        elif not key.isidentifier():
            reason = f"'{key}' is not a name"
        elif key in values:
            reason = f"'{key}' is given twice"
        if reason:
            raise UsageError([diagnostic("D822", text=text[:60], reason=reason)])
        values[key] = _value(value)
    return values


def _value(text: str) -> bool | int | float | str:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    if _INTEGER.fullmatch(text):
        return int(text)
    return float(text) if _FLOAT.fullmatch(text) else text


def _rows(map_rows: Sequence[str]) -> tuple[str, ...]:
    """Return the rows of a map; text is taken by its lines, for as a sequence it would be a map of one column."""
    lines = [line.strip() for line in map_rows.strip().splitlines()] if isinstance(map_rows, str) else map_rows
    return tuple(lines)


@lru_cache(maxsize=_KEPT)
def _made(id: str, key: str, rows: tuple[str, ...] | None) -> Environment:  # noqa: A002
    args = json.loads(key)
    module, colon, registered = id.partition(":")
    if colon and _MODULE.fullmatch(module):
        _loaded(EntryPoint(id, _REGISTERING, GROUP))(module, registered)
        return replace(_made(registered, key, rows), module=module)
    if id in _FACTORIES:
        return _call(EntryPoint(id, _FACTORIES[id], GROUP), args, rows)
    added = entry_points(group=GROUP)
    for point in added:
        if point.name == id:
            return _call(point, args, rows)
    known = (*BUILT_IN, *sorted({point.name for point in added} - set(BUILT_IN)))
    return _call(EntryPoint(id, _FOREIGN, GROUP), id, args, rows, known)


def _call(point: EntryPoint, *arguments: Any) -> Environment:
    made: Environment = _loaded(point)(*arguments)
    return made


def _loaded(point: EntryPoint) -> Any:
    try:
        return point.load()
    except (ImportError, AttributeError) as error:
        reason = str(error).splitlines()[0][:200]
        raise UsageError([diagnostic("D842", name=point.name, group=GROUP, reason=reason)]) from error


def _misdescribed(description: Any) -> str:
    if not isinstance(description, Mapping):
        return "it should be an object"
    if not isinstance(description.get("id"), str):
        return "its 'id' should be text"
    if ":" in description["id"]:
        return "its 'id' names a module, and a file does not choose what is imported; `--env MODULE:ID` does"
    args, rows = description.get("args"), description.get("map")
    if args is not None and not isinstance(args, Mapping):
        return "its 'args' should be an object"
    if rows is not None and not (isinstance(rows, list | tuple) and all(isinstance(row, str) for row in rows)):
        return "its 'map' should be a list of rows of text"
    return ""


def _in_file(found: Diagnostic, file: str | None) -> Diagnostic:
    if file is None or found.file is not None:
        return found
    return Diagnostic(found.code, found.severity, found.message, file=file, help=found.help)
