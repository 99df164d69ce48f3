"""Minari: datasets of recorded episodes, as offline reinforcement learning keeps them; needs the extra `minari`.

In: `minari:ID`, a dataset in Minari's own folder. Out: one `Recording` an episode: observations are its states,
`infos` columns such as `info.speed`, and the environment is the one that the dataset names. Nothing is downloaded,
and the environment is not made, since a dataset may come from anywhere. `write` makes such a dataset.
"""

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from stlspec.readers.model import Array, Recording, checked, plain, refusal

SCHEME = "minari:"
_NUMBERS_AT_MOST = 2**26
_QUIET = ("render_mode", "disable_env_checker")


def read(path: Path) -> list[Recording]:
    """Read all episodes of a local Minari dataset.

    Not in the paper: a file format.

    Args:   path: `minari:ID`.
    Raises: DataError D830, D836 to D838: there is no such dataset, or it cannot be used; D847: the extra is missing.
    """
    minari = _minari(path)
    name = str(path).removeprefix(SCHEME)
    problems = (OSError, ValueError, KeyError, TypeError, AssertionError, AttributeError, RuntimeError, ImportError)
    try:
        dataset = minari.load_dataset(name, download=False)
        env = _description(dataset.env_spec)
        episodes = list(_bounded(dataset, path))
    except FileNotFoundError:
        hint = f"`minari download {name}` fetches a published one; MINARI_DATASETS_PATH names the folder"
        raise refusal("D830", path, reason="there is no such dataset on this machine", help=hint) from None
    except problems as error:
        reason = f"{type(error).__name__}: {error}".splitlines()[0][:120]
        hint = "check it with: minari show " + name
        raise refusal("D836", path, format="a Minari dataset", reason=reason, where="", help=hint) from None
    if not episodes:
        raise refusal("D803", path, where=": the dataset has no episodes")
    return [checked(replace(_recording(e, path), env=env, episode=str(e.id)), path) for e in episodes]


def write(recordings: Sequence[Recording], name: str, live: Any = None) -> None:
    """Make a local Minari dataset of recordings that have states and actions.

    Not in the paper: a file format.

    Args:   name: the id, as in `minari:ID`. live: the gymnasium environment that states and actions belong to; None:
            their spaces are what the recordings show.
    Raises: DataError D830: the dataset is there already, or cannot be written; D837: a recording has no states
            or actions; D847: the extra is missing.
    """
    path = Path(f"{SCHEME}{name}")
    minari = _minari(path)
    from minari.data_collector import EpisodeBuffer

    parts = [_buffer(r, path) for r in recordings]
    buffers = [EpisodeBuffer(id=i, **part) for i, part in enumerate(parts)]
    spaces = {
        "observation_space": _space([p["observations"] for p in parts]) if live is None else live.observation_space,
        "action_space": _space([p["actions"] for p in parts]) if live is None else live.action_space,
    }
    try:
        with warnings.catch_warnings():
            # It asks for an author and a permanent link, which a recording does not have.
            warnings.simplefilter("ignore")
            minari.create_dataset_from_buffers(name, buffers, env=live, data_format="hdf5", **spaces)
    except (OSError, ValueError) as error:
        raise refusal("D830", path, reason=str(error).splitlines()[0][:200], help="choose another id") from None


def _minari(path: Path) -> Any:
    try:
        import h5py  # noqa: F401 - what Minari's own format needs, and does not declare
        import minari
        import PIL  # noqa: F401 - likewise
    except ImportError:
        raise refusal("D847", path, what="Minari", extra="minari") from None
    return minari


def _bounded(dataset: Any, path: Path) -> Iterable[Any]:
    shape = getattr(dataset.observation_space, "shape", None) or (1,)
    size = int(dataset.total_steps) * int(np.prod(shape))
    if size > _NUMBERS_AT_MOST:
        raise refusal("D838", path, size=f"{size * 8:,}", limit=f"{_NUMBERS_AT_MOST * 8:,}")
    found: Iterable[Any] = dataset.iterate_episodes()
    return found


def _description(spec: Any) -> dict[str, Any] | None:
    """Describe the environment as demonstration files do: {"id", "args", "map"}."""
    if spec is None:
        return None
    args = {key: value for key, value in dict(spec.kwargs).items() if key not in _QUIET and value is not None}
    rows = args.pop("desc", None) or args.pop("map", None)
    return {"id": spec.id, "args": args, **({} if rows is None else {"map": [str(row) for row in rows]})}


def _recording(episode: Any, path: Path) -> Recording:
    n_samples = len(episode.rewards) + 1
    observations, actions = _rows(episode.observations, n_samples), _rows(episode.actions, n_samples - 1)
    if observations is None or actions is None:
        hint = "an episode has one observation more than actions"
        place = f"episode {episode.id}"
        raise refusal("D837", path, place=place, found="without them", expected="observations and actions", help=hint)
    return Recording(columns=dict(_infos(episode.infos or {}, n_samples)), states=observations, actions=actions)


def _rows(values: Any, length: int) -> tuple[Any, ...] | None:
    """Turn a structure of arrays into one entry a sample; None if it has another length."""
    if isinstance(values, Mapping):
        columns = {key: _rows(value, length) for key, value in values.items()}
        if any(column is None for column in columns.values()):
            return None
        return tuple({key: column[k] for key, column in columns.items() if column} for k in range(length))
    if isinstance(values, tuple):
        parts = [_rows(value, length) for value in values]
        return None if None in parts else tuple(list(row) for row in zip(*(p for p in parts if p), strict=True))
    listed = plain(np.asarray(values))
    return tuple(listed) if isinstance(listed, list) and len(listed) == length else None


def _infos(infos: Mapping[str, Any], length: int, prefix: str = "info.") -> Iterable[tuple[str, Array]]:
    """Return the columns that `infos` holds: everything with one number or Boolean a sample."""
    for name, value in infos.items():
        if isinstance(value, Mapping):
            yield from _infos(value, length, f"{prefix}{name}.")
            continue
        try:
            column = np.asarray(value)
        except ValueError:
            continue
        if column.shape == (length,) and column.dtype.kind in "biuf":
            yield f"{prefix}{name}", column if column.dtype.kind == "b" else column.astype(np.float64)


def _space(arrays: Sequence[Array]) -> Any:
    """Return a space that holds what the recordings hold."""
    from gymnasium import spaces

    whole = np.concatenate([array for array in arrays if len(array)] or [np.zeros(1, dtype=np.int64)])
    if whole.ndim == 1 and whole.dtype.kind in "iu" and whole.min(initial=0) >= 0:
        return spaces.Discrete(int(whole.max(initial=0)) + 1)
    kind = whole.dtype.type if whole.dtype.kind in "iu" else np.float64
    low, high = (-np.inf, np.inf) if kind is np.float64 else (int(whole.min()), int(whole.max()))
    return spaces.Box(low, high, whole.shape[1:], kind)


def _buffer(recording: Recording, path: Path) -> dict[str, Any]:
    if recording.states is None or recording.actions is None or None in recording.actions:
        lacking = "states" if recording.states is None else "actions"
        place, hint = f"demonstration '{recording.name or ''}'", "record both; Minari keeps observations and actions"
        raise refusal("D837", path, place=place, found=f"without {lacking}", expected="one with both", help=hint)
    steps = len(recording.actions)
    return {
        "observations": np.asarray(recording.states),
        "actions": np.asarray(recording.actions),
        "rewards": [0.0] * steps,
        "terminations": [False] * steps,
        "truncations": [False] * (steps - 1) + [True] * (steps > 0),
        "infos": {name.removeprefix("info."): np.asarray(column) for name, column in recording.columns.items()} or None,
    }
