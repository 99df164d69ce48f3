"""Demonstrations, as files or memory hold them.

In: files of any format that a reader knows, or arrays. Out: `Demonstration`, which is independent of any spec:
what a spec reads from one is the matter of `binding`.
"""

import json
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stlspec.columns import unmasked
from stlspec.compiler.files import write_bytes
from stlspec.envs.catalogue import environment_of, make_live
from stlspec.envs.model import Environment, derive_actions
from stlspec.errors import DataError, Diagnostic, InputError
from stlspec.readers import minari
from stlspec.readers.document import SCHEMA
from stlspec.readers.model import Array, Recording, checked, column_of, plain, refusal, time_of
from stlspec.readers.registry import read_recordings
from stlspec.traces import whole_stamps


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


def load_demonstrations(
    paths: str | Path | Sequence[str | Path], columns: Collection[str] | None = None
) -> tuple[Demonstration, ...]:
    """Read all demonstrations of some files, in the order of the files.

    Not in the paper: file formats.

    Args:    paths: one file, or several; `minari:ID` is a dataset of Minari. columns: the signals that are wanted
             (`binding.columns_of`); formats in which columns lie apart leave out the others. None = all.
    Returns: demonstrations; a file may hold several.
    Raises: DataError: some files cannot be used; it carries the diagnostics of all of them.
    """
    found: list[Demonstration] = []
    problems: list[Diagnostic] = []
    for path in [paths] if isinstance(paths, str | Path) else paths:
        try:
            recordings = read_recordings(Path(path), columns)
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


def common_environment(demonstrations: Sequence[Demonstration]) -> Environment | None:
    """Return the environment that all demonstrations name; None if one names none, or they name different ones.

    Not in the paper: file formats.

    Raises: InputError: it is unknown, or is not described well.
    """
    described = [d.recording.env for d in demonstrations]
    if not described or described[0] is None or any(env != described[0] for env in described):
        return None
    return environment_of(described[0], file=demonstrations[0].file or demonstrations[0].name)


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


def save_demonstrations(demonstrations: Sequence[Demonstration], target: str | Path) -> None:
    """Write demonstrations to a file, whole or not at all.

    Not in the paper: file formats.

    Args:   target: a file that ends in .jsonl (one a line) or .json, or `minari:ID`, which keeps states, actions and
            signals (as infos) but no time stamps.
    Raises: DataError D831: no writer knows the suffix; others as the format has it. InputError S092: the file cannot
            be written.
    """
    path = Path(target)
    if str(target).startswith(minari.SCHEME):
        _save_minari(demonstrations, str(target).removeprefix(minari.SCHEME))
        return
    documents = [document_of(demonstration) for demonstration in demonstrations]
    if path.suffix == ".jsonl":
        text = "".join(json.dumps(d, ensure_ascii=False, allow_nan=False) + "\n" for d in documents)
    elif path.suffix == ".json":
        text = json.dumps(documents, ensure_ascii=False, allow_nan=False, indent=1) + "\n"
    else:
        raise refusal("D831", path, suffix=path.suffix, help="write .jsonl or .json, or minari:ID")
    write_bytes(path, text.encode())


def _save_minari(demonstrations: Sequence[Demonstration], name: str) -> None:
    """Write a dataset whose states and actions are those of the environment that all demonstrations name."""
    recordings = [demonstration.recording for demonstration in demonstrations]
    descriptions = [r.env for r in recordings]
    live = None
    if recordings and descriptions[0] is not None and all(d == descriptions[0] for d in descriptions):
        world = environment_of(descriptions[0])
        if world.n_states:
            recordings = [r if r.states is None else _numbered(r, world) for r in recordings]
        live = make_live(world)
    minari.write(recordings, name, live)


def _numbered(recording: Recording, world: Environment) -> Recording:
    """Return the recording with numbers for states, as gymnasium observes them, and with actions."""
    numbers = world.encode_all(recording.states or ())
    actions = recording.actions if recording.actions is not None else derive_actions(world, numbers)
    return replace(recording, states=tuple(numbers.tolist()), actions=actions)


def document_of(demonstration: Demonstration) -> dict[str, Any]:
    """Return the demonstration as the object that JSON files hold; nothing is lost but the file's name.

    Not in the paper: a file format.
    """
    recording = demonstration.recording
    parts = {
        "name": demonstration.name,
        "time": None if recording.time is None else _listed(recording.time),
        "signals": {key: _listed(values) for key, values in recording.columns.items()} or None,
        "states": None if recording.states is None else [plain(state) for state in recording.states],
        "actions": None if recording.actions is None else [plain(action) for action in recording.actions],
        "env": None if recording.env is None else dict(recording.env),
    }
    return {"schema": SCHEMA, **{key: part for key, part in parts.items() if part is not None}}


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
