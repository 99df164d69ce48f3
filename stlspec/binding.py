"""What a spec reads from a demonstration.

In: a demonstration and a spec. Out: `BoundDemonstration`, the signals that the spec uses, with the states and
actions behind them. A signal comes from the column of its name, else from a path into states or actions, else an
environment computes it from the states: the demonstration's own one first. What was recorded is thus never
replaced by what can be computed.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stlspec.compiler.bundle import BundleData, Signal
from stlspec.demos import Demonstration
from stlspec.envs.catalogue import environment_of
from stlspec.envs.model import Environment, derive_actions
from stlspec.envs.steps import wrong_step
from stlspec.errors import DataError, Diagnostic, InputError, diagnostic
from stlspec.lang.spelling import closest_column, split_unit
from stlspec.lang.units import dimension, respelt
from stlspec.readers.model import Array, Recording, column_of, plain
from stlspec.sampling import OnNan, check_on_nan, in_unit_of, resampled, settled

_PATH = re.compile(r"(obs|action)((?:\.[A-Za-z_]\w*|\[[0-9]{1,9}\])*)")


_STEP = re.compile(r"\.(\w+)|\[([0-9]+)\]")


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

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """D859 for the first step that the environment cannot take, where it knows its transitions."""
        home, states = self.environment, self.states
        found = None if home is None or not home.n_states or states is None else wrong_step(home, states, self.actions)
        if home is None or found is None:
            return ()
        help_ = "correct 'actions', or leave them out: they are then found from the states"
        if not found.by_action:
            elsewhere = 'if it was made in another environment, name that one: "env" in it, --demo-env, --demo-map'
            help_ = f"record every step, since what lies between is not seen and labels can be wrong; {elsewhere}"
        more = f" (the first of {found.count})" if found.count > 1 else ""
        place: dict[str, Any] = {"sample": found.sample, "next": found.sample + 1, "env": home.id}
        file = self.demonstration.file
        return (diagnostic("D859", file=file, name=self.name, what=found.what, more=more, help=help_, **place),)


def bind(
    bundle: BundleData,
    demonstration: Demonstration,
    environment: Environment | None = None,
    on_nan: OnNan = "refuse",
    resample: int | None = None,
) -> BoundDemonstration:
    """Collect the signals that the formulas of a spec use, with states and actions.

    Not in the paper, which takes signals as given.

    Args: environment: computes what is missing, where the demonstration names no environment of its own, or
        where that one does not offer the signal. on_nan: "refuse" leaves NaN in place, so that the evaluation
        refuses it; "hold" repeats the previous value; "drop" leaves out the sample. resample: a period in
        nanoseconds, at which every signal is read again; None leaves the samples as they are.
    Raises: DataError D801 to D804, D810, D812, D827, D841, D845; InputError: the demonstration's own environment
        is unknown; UsageError D846, D880: `resample` does not fit the spec; `on_nan` is none of the three.
    """
    check_on_nan(on_nan)
    file = demonstration.file or demonstration.name
    own, failure = _own_environment(demonstration.recording, file)
    # States of an environment that cannot be made mean nothing in another one.
    worlds = () if failure else tuple(world for world in (own, environment) if world is not None)
    home = worlds[0] if worlds else None
    used = used_signals(bundle)
    recording = in_unit_of(demonstration.recording, bundle.time)
    recording = _with_paths(recording, used, file)
    places = () if home is None or recording.states is not None else home.state_signals
    keys = {*map(_key, used), *places}
    if resample is None:
        recording = settled(recording, keys, on_nan, file)
    else:
        recording = recording if on_nan == "hold" else settled(recording, keys, on_nan, file)
        recording = resampled(recording, keys, bundle.time, resample, on_nan, file)
    recording, states = _with_states(recording, home, file)
    recording = _with_paths(recording, used, file)
    signals = {s.name: recording.columns[_key(s)] for s in used if _key(s) in recording.columns}
    missing = [s for s in used if s.name not in signals]
    if recording.states is not None:
        signals |= _computed(missing, worlds, recording.states, file)
    missing = [s for s in missing if s.name not in signals]
    if missing:
        raise failure or DataError([missing_signal(s, recording, worlds, file) for s in missing])
    return BoundDemonstration(
        demonstration=demonstration,
        signals={s.name: signals[s.name] for s in used},
        time=recording.time,
        states=states,
        actions=recording.actions,
        environment=home,
    )


def columns_of(bundle: BundleData, environment: Environment | None = None) -> frozenset[str]:
    """Return the columns of a recording that `bind` may look at.

    Not in the paper: it spares the reading of others.
    """
    places = () if environment is None else environment.state_signals
    return frozenset({*map(_key, used_signals(bundle)), *places})


def used_signals(bundle: BundleData) -> list[Signal]:
    """Return the signals that the formulas use, as they are declared. Not in the paper: an interface."""
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
        value = plain(value)
        if value is None or isinstance(value, bool | int | float):
            return math.nan if value is None else value
        reason = f"there is {_shown(value)}, which is no number"
    hint = 'choose an entry, as in "obs[0]", "obs.key[1]" or "action[0]"'
    named: dict[str, Any] = {"signal": signal.name, "path": _key(signal), "sample": sample}
    raise DataError([diagnostic("D841", file=file, reason=reason, help=hint, **named)])


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


def missing_signal(signal: Signal, recording: Recording, worlds: Sequence[Environment], file: str) -> Diagnostic:
    """Say that a signal is neither recorded nor computed, and what there is. Not in the paper: error handling."""
    key = _key(signal)
    offered = [name for world in worlds for name in world.signal_names]
    held = (*recording.columns, *recording.others)
    close = closest_column(key, [*held, *offered])
    parts = [f"did you mean '{close}'? write `from \"{close}\"` in its declaration"] if close else []
    if close and (other := _other_unit(signal, close)):
        parts.append(other)
    if key.startswith("info."):
        parts.append(f"a recording has no info; record a column named '{key}'")
    parts.append("the data has " + (_some(held) if held else "no columns"))
    if recording.states is None:
        parts.append("and no states to compute it from")
    elif worlds:
        parts += [f"environment '{w.id}' offers {_some(w.signal_names)}" for w in worlds]
    else:
        parts.append("name the environment that computes it from the states: --env ID")
    return diagnostic("D804", file=file, signal=signal.name, help="; ".join(parts))


def _other_unit(signal: Signal, column: str) -> str | None:
    """Say that the unit in the name of a column is not the one that its signal is declared in."""
    written = split_unit(column)[1]
    if written is None or signal.unit is None or _unit(written) == _unit(signal.unit):
        return None
    return f"its name says {written}, and `{signal.name}` is declared in {signal.unit}"


def _unit(text: str) -> object:
    return dimension(respelt(text) or text) or text


def _some(names: Iterable[str]) -> str:
    listed = [f"'{name[:40]}'" for name in names]
    return ", ".join(listed[:8]) + (", ..." if len(listed) > 8 else "") if listed else "no signals"


def _shown(value: Any) -> str:
    text = repr(plain(value))
    return text if len(text) <= 30 else text[:27] + "..."
