"""Demonstrations, and what a spec reads from them.

In: files of any format that a reader knows, or arrays. Out: a `Demonstration`, which is independent of any
spec; and `BoundDemonstration`, the signals that one spec uses, with the states and actions behind them. A
signal comes from the column of its name, else from a path into states or actions, else an environment
computes it from the states: the demonstration's own one first. What was recorded is thus never replaced by
what can be computed.
"""

import difflib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt

from stlspec.compiler.bundle import BundleData, Signal
from stlspec.envs.catalogue import environment_of
from stlspec.envs.model import Environment
from stlspec.errors import DataError, Diagnostic, InputError, UsageError, diagnostic
from stlspec.readers.document import SCHEMA
from stlspec.readers.model import Array, Recording, checked, column_of, time_of
from stlspec.readers.registry import read_recordings
from stlspec.traces import unmasked, whole_stamps

OnNan: TypeAlias = Literal["refuse", "hold", "drop"]

_PATH = re.compile(r"(obs|action)((?:\.[A-Za-z_]\w*|\[[0-9]{1,9}\])*)")
_STEP = re.compile(r"\.(\w+)|\[([0-9]+)\]")


@dataclass(frozen=True, slots=True, eq=False)
class Demonstration:
    """One recorded episode under the name that reports show; file: where it was read from."""

    name: str
    recording: Recording
    file: str | None = None

    @property
    def n_samples(self) -> int:
        """The number of samples."""
        return self.recording.n_samples


@dataclass(frozen=True, slots=True, eq=False)
class BoundDemonstration:
    """A demonstration as one spec sees it; all parts have one value a sample.

    signals: for each signal that the formulas use (n_samples,). time: (n_samples,), as written, or None.
    states: numbers of states of `environment`, or as recorded where it is None or has none; None without
    states. actions: one less than samples; None where no action leads from a state to the next; None if
    unknown. environment: the one that the states belong to.
    """

    demonstration: Demonstration
    signals: Mapping[str, Array]
    time: Array | None = None
    states: tuple[Any, ...] | None = None
    actions: tuple[Any, ...] | None = None
    environment: Environment | None = None

    @property
    def name(self) -> str:
        """The name of the demonstration."""
        return self.demonstration.name


def load_demonstrations(paths: str | Path | Sequence[str | Path]) -> tuple[Demonstration, ...]:
    """Read all demonstrations of some files, in the order of the files.

    Not in the paper: file formats.

    Args:    paths: one file, or several.

    Returns: demonstrations; a file may hold several.
    Raises: DataError: some files cannot be used; it carries the diagnostics of all of them.
    """
    found: list[Demonstration] = []
    problems: list[Diagnostic] = []
    for path in [paths] if isinstance(paths, str | Path) else paths:
        try:
            recordings = read_recordings(Path(path))
        except InputError as error:
            problems += error.diagnostics
            continue
        several = len(recordings) > 1
        for index, recording in enumerate(recordings):
            episode = index if recording.episode is None else recording.episode
            name = recording.name or (f"{path}#{episode}" if several else str(path))
            found.append(Demonstration(name, recording, str(path)))
    if problems:
        raise DataError(problems)
    return tuple(found)


def make_demonstration(
    name: str,
    signals: Mapping[str, npt.ArrayLike] | None = None,
    *,
    time: npt.ArrayLike | None = None,
    states: Iterable[Any] | None = None,
    actions: Iterable[Any] | None = None,
    env: Mapping[str, Any] | None = None,
) -> Demonstration:
    """Make a demonstration of what is in memory; the arguments are as in a demonstration file.

    Not in the paper: an interface.

    Raises: DataError D803, D805, D839: the parts do not fit together.
    """
    recording = Recording(
        name=name,
        time=None if time is None else _stamps(time),
        columns={key: _column(values) for key, values in (signals or {}).items()},
        states=None if states is None else tuple(states),
        actions=None if actions is None else tuple(actions),
        env=env,
    )
    return Demonstration(name, checked(recording, Path(name)))


def document_of(demonstration: Demonstration) -> dict[str, Any]:
    """Return the demonstration as the object that JSON files hold; nothing is lost but the file's name.

    Not in the paper: a file format.
    """
    recording = demonstration.recording
    parts = {
        "name": demonstration.name,
        "time": None if recording.time is None else _listed(recording.time),
        "signals": {key: _listed(values) for key, values in recording.columns.items()} or None,
        "states": None if recording.states is None else [_plain(state) for state in recording.states],
        "actions": None if recording.actions is None else [_plain(action) for action in recording.actions],
        "env": None if recording.env is None else dict(recording.env),
    }
    return {"schema": SCHEMA, **{key: part for key, part in parts.items() if part is not None}}


def derive_actions(environment: Environment, states: npt.ArrayLike) -> tuple[int | None, ...] | None:
    """Find the action between each state and the next; the lowest one where several lead there.

    Paper: demonstrations are sequences of states; Algorithms 2 and 3 need state and action.

    Args:    states: (n_samples,), numbers of states of `environment`.
    Returns: n_samples - 1 actions, None where none leads there; None without a deterministic table.
    """
    if environment.table is None:
        return None
    numbers = np.asarray(states, dtype=np.int64)
    leads = environment.table[numbers[:-1]] == numbers[1:, None]
    found = np.where(leads.any(axis=1), leads.argmax(axis=1), -1)
    return tuple(None if action < 0 else action for action in found.tolist())


def bind(
    bundle: BundleData,
    demonstration: Demonstration,
    environment: Environment | None = None,
    on_nan: OnNan = "refuse",
) -> BoundDemonstration:
    """Collect the signals that the formulas of a spec use, with states and actions.

    Not in the paper, which takes signals as given.

    Args: environment: computes what is missing, where the demonstration names no environment of its own, or
        where that one does not offer the signal. on_nan: "refuse" leaves NaN in place, so that the evaluation
        refuses it; "hold" repeats the previous value; "drop" leaves out the sample.
    Raises: DataError D803, D804, D827, D841; InputError: the demonstration's own environment is unknown;
        UsageError D880: `on_nan` is none of the three.
    """
    _check_word(on_nan)
    file = demonstration.file or demonstration.name
    own, failure = _own_environment(demonstration.recording, file)
    # States of an environment that cannot be made mean nothing in another one.
    worlds = () if failure else tuple(world for world in (own, environment) if world is not None)
    home = worlds[0] if worlds else None
    used = _used(bundle)
    recording = _with_paths(demonstration.recording, used, file)
    places = () if home is None or recording.states is not None else home.state_signals
    recording = _settled(recording, {*map(_key, used), *places}, on_nan, file)
    recording, states = _with_states(recording, home, file)
    recording = _with_paths(recording, used, file)
    signals = {s.name: recording.columns[_key(s)] for s in used if _key(s) in recording.columns}
    missing = [s for s in used if s.name not in signals]
    if recording.states is not None:
        signals |= _computed(missing, worlds, recording.states, file)
    missing = [s for s in missing if s.name not in signals]
    if missing:
        raise failure or DataError([_missing(s, recording, worlds, file) for s in missing])
    return BoundDemonstration(
        demonstration=demonstration,
        signals={s.name: signals[s.name] for s in used},
        time=recording.time,
        states=states,
        actions=recording.actions,
        environment=home,
    )


def _check_word(on_nan: str) -> None:
    words = get_args(OnNan)
    if on_nan not in words:
        close = difflib.get_close_matches(str(on_nan).lower(), words, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"it is one of {', '.join(words)}"
        raise UsageError([diagnostic("D880", what=f"on_nan = {_shown(on_nan)} is no way to treat NaN", help=hint)])


def _used(bundle: BundleData) -> list[Signal]:
    names = {node.value for node in bundle.nodes if node.op in ("signal", "bool")}
    return [signal for signal in bundle.signals if signal.name in names]


def _key(signal: Signal) -> str:
    """Return the column that a signal is read from."""
    return signal.source or signal.name


def _own_environment(recording: Recording, file: str) -> tuple[Environment | None, InputError | None]:
    """Make the environment that the demonstration names; a failure matters only if it is needed."""
    if recording.env is None:
        return None, None
    try:
        return environment_of(recording.env, file=file), None
    except InputError as error:
        return None, error


def _with_paths(recording: Recording, used: Sequence[Signal], file: str) -> Recording:
    """Add a column for each signal that is read by a path such as obs[0], where there is one."""
    columns = dict(recording.columns)
    for signal in used:
        key = _key(signal)
        path = _PATH.fullmatch(key)
        if path is None or key in columns:
            continue
        entries = recording.states
        if path[1] == "action":
            # The first sample has no action of its own and takes the one that leaves it.
            entries = (*recording.actions[:1], *recording.actions) if recording.actions else None
        if entries is not None:
            steps = [int(k) if k else name for name, k in _STEP.findall(path[2])]
            columns[key] = column_of([_follow(entry, steps, signal, k, file) for k, entry in enumerate(entries)])
    return replace(recording, columns=columns)


def _follow(entry: Any, steps: Sequence[str | int], signal: Signal, sample: int, file: str) -> Any:
    """Walk from a state or an action to the number inside it; a step without an action gives NaN."""
    if entry is None:
        return math.nan
    value, reason = entry, ""
    for step in steps:
        listed = isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim > 0)
        if isinstance(step, int) and not (listed and step < len(value)):
            reason = f"there is no [{step}] in {_shown(value)}"
        elif isinstance(step, str) and not (isinstance(value, Mapping) and step in value):
            reason = f"there is no .{step} in {_shown(value)}"
        if reason:
            break
        value = value[step]
    if not reason:
        value = _plain(value)
        if value is None or isinstance(value, bool | int | float):
            return math.nan if value is None else value
        reason = f"there is {_shown(value)}, which is no number"
    hint = 'choose an entry, as in "obs[0]", "obs.key[1]" or "action[0]"'
    named: dict[str, Any] = {"signal": signal.name, "path": _key(signal), "sample": sample}
    raise DataError([diagnostic("D841", file=file, reason=reason, help=hint, **named)])


def _settled(recording: Recording, keys: Iterable[str], on_nan: OnNan, file: str) -> Recording:
    """Treat the NaN in some columns as the user asked for."""
    columns = {key: recording.columns[key] for key in keys if key in recording.columns}
    holes = {key: _holes(values) for key, values in columns.items()}
    holes = {key: hole for key, hole in holes.items() if hole.any()}
    if on_nan == "refuse" or not holes:
        return recording
    if on_nan == "hold":
        held = {key: _held(columns[key], hole) for key, hole in holes.items()}
        return replace(recording, columns={**recording.columns, **held})
    kept = np.flatnonzero(~np.logical_or.reduce(list(holes.values())))
    if not len(kept):
        raise DataError([diagnostic("D803", file=file, where=": every sample has a signal that is NaN")])
    actions = None if recording.actions is None else (None, *recording.actions)
    return replace(
        recording,
        time=None if recording.time is None else recording.time[kept],
        columns={key: _again(values[kept]) for key, values in recording.columns.items()},
        states=None if recording.states is None else tuple(recording.states[k] for k in kept),
        actions=None if actions is None else tuple(actions[k] for k in kept[1:]),
    )


def _holes(values: Array) -> npt.NDArray[np.bool_]:
    if values.dtype.kind == "f":
        return np.isnan(values)
    if values.dtype.kind == "O":
        return np.array([value != value for value in values.tolist()], dtype=np.bool_)
    return np.zeros(len(values), dtype=np.bool_)


def _held(values: Array, hole: npt.NDArray[np.bool_]) -> Array:
    """Repeat the last value before each hole; a hole at the beginning stays, and is refused later."""
    last = np.maximum.accumulate(np.where(hole, 0, np.arange(len(values))))
    return _again(values[last])


def _again(values: Array) -> Array:
    """Convert a column of objects again, which without its holes may be all Booleans."""
    return column_of(values.tolist()) if values.dtype.kind == "O" else values


def _with_states(recording: Recording, home: Environment | None, file: str) -> tuple[Recording, tuple[Any, ...] | None]:
    """Find states and actions: the states from the columns that make up a state, the actions from the states.

    Returns: the recording, completed; its states, as numbers if the environment numbers them.
    """
    if recording.states is None and home is not None and home.state_signals:
        columns = [recording.columns.get(name) for name in home.state_signals]
        rows = [values for values in columns if values is not None and values.dtype.kind == "f"]
        if len(rows) == len(columns):
            recording = replace(recording, states=tuple(np.stack(rows, axis=1).tolist()))
    if recording.states is None or home is None or not home.n_states:
        return recording, recording.states
    numbers = home.encode_all(recording.states, file=file)
    if recording.actions is None:
        recording = replace(recording, actions=derive_actions(home, numbers))
    return recording, tuple(numbers.tolist())


def _computed(missing: Sequence[Signal], worlds: Sequence[Environment], states: Any, file: str) -> dict[str, Array]:
    """Let each environment in turn compute the signals that it offers and that are still missing."""
    found: dict[str, Array] = {}
    for world in worlds:
        offered = [s for s in missing if s.name not in found and _key(s) in world.signal_names]
        if offered:
            columns = world.signals({_key(s) for s in offered}, states, file=file)
            found |= {s.name: columns[_key(s)] for s in offered}
    return found


def _missing(signal: Signal, recording: Recording, worlds: Sequence[Environment], file: str) -> Diagnostic:
    key = _key(signal)
    offered = [name for world in worlds for name in world.signal_names]
    close = difflib.get_close_matches(key, [*recording.columns, *offered], 1)
    parts = [f"did you mean '{close[0]}'? write `from \"{close[0]}\"` in its declaration"] if close else []
    if key.startswith("info."):
        parts.append(f"a recording has no info; record a column named '{key}'")
    parts.append("the data has " + (_some(recording.columns) if recording.columns else "no columns"))
    if recording.states is None:
        parts.append("and no states to compute it from")
    elif worlds:
        parts += [f"environment '{w.id}' offers {_some(w.signal_names)}" for w in worlds]
    else:
        parts.append("name the environment that computes it from the states: --env ID")
    return diagnostic("D804", file=file, signal=signal.name, help="; ".join(parts))


def _some(names: Iterable[str]) -> str:
    listed = [f"'{name[:40]}'" for name in names]
    return ", ".join(listed[:8]) + (", ..." if len(listed) > 8 else "") if listed else "no signals"


def _shown(value: Any) -> str:
    text = repr(_plain(value))
    return text if len(text) <= 30 else text[:27] + "..."


def _plain(value: Any) -> Any:
    """Return an array or a NumPy number as plain Python values."""
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def _stamps(values: npt.ArrayLike) -> Array:
    values = unmasked(values)
    if not isinstance(values, np.ndarray):
        return time_of(list(values))  # type: ignore[arg-type]
    whole = whole_stamps(values)
    return _column(values) if whole is None else whole


def _column(values: npt.ArrayLike) -> Array:
    values = unmasked(values)
    if isinstance(values, np.ndarray):
        return values.astype(np.float64) if values.dtype.kind in "iu" else values
    return column_of(list(values))  # type: ignore[arg-type]


def _listed(values: Array) -> list[Any]:
    """Return a column as a list for JSON, where infinities are words and NaN is null."""
    words = {math.inf: "inf", -math.inf: "-inf"}
    return [None if value != value else words.get(value, value) for value in values.tolist()]
