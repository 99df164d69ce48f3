"""NPZ: NumPy's archive, one array a signal.

In: a file with the arrays of the signals, and optionally `time`, `episode`, `states` and `actions`. Out: one
`Recording` an episode. Nothing is unpickled, and before any array is unpacked the sizes that the archive and
the heads of its arrays claim are checked against each other and the bound, since an archive of a few
kilobytes can claim terabytes.
"""

import io
import math
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from stlspec.readers.model import (
    Array,
    Recording,
    checked,
    episode_rows,
    read_bytes,
    refusal,
    repeated,
)
from stlspec.traces import whole_stamps

_BROKEN = (zipfile.BadZipFile, zlib.error, ValueError, OSError, EOFError, NotImplementedError, RuntimeError)
_HELP = 'write it with numpy.savez("demo.npz", x=[...], y=[...])'
_HEAD_AT_MOST = 10_000
_UNPACKED_AT_MOST = 2**30
_AS_OBJECT = 64


def read(path: Path) -> list[Recording]:
    """Read an NPZ file.

    Not in the paper: a file format.

    Raises: DataError D803, D805, D830, D833, D835 to D839: the file cannot be used.
    """
    arrays = _arrays(read_bytes(path, "arrays, one a signal", _UNPACKED_AT_MOST), path)
    time, labels = arrays.pop("time", None), arrays.pop("episode", None)
    states, actions = arrays.pop("states", None), arrays.pop("actions", None)
    columns = {name: _column(array, f"signal '{name}'", path) for name, array in arrays.items()}
    whole = Recording(
        time=None if time is None else _time(time, path),
        columns=columns,
        states=None if states is None else _entries(states, "'states'", path),
        actions=None if actions is None else _entries(actions, "'actions'", path),
    )
    if labels is None:
        return [checked(whole, path)]
    return _episodes(whole, _column(labels, "'episode'", path), path)


def _arrays(data: bytes, path: Path) -> dict[str, Array]:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            _check_size(sum(member.file_size for member in members), path)
            names = [member.filename.removesuffix(".npy") for member in members]
            twice = repeated(names)
            if twice is not None:
                reason = f"the archive has the array '{twice[:60]}' twice"
                raise refusal("D835", path, reason=reason, help="give each array a name of its own")
            return {name: _array(archive, member, path) for name, member in zip(names, members, strict=True)}
    except _BROKEN as error:
        reason = (str(error) or type(error).__name__).splitlines()[0][:120]
        raise refusal("D836", path, format="an NPZ archive", reason=reason, where="", help=_HELP) from None


def _check_size(size: int, path: Path) -> None:
    if size > _UNPACKED_AT_MOST:
        raise refusal("D838", path, size=f"{size:,}", limit=f"{_UNPACKED_AT_MOST:,}")


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo, path: Path) -> Array:
    """Unpack one array, after its head has been held against the size of its member."""
    with archive.open(member) as stream:
        version = np.lib.format.read_magic(stream)
        reader = np.lib.format.read_array_header_1_0
        if version != (1, 0):
            reader = np.lib.format.read_array_header_2_0
        shape, _, dtype = reader(stream, max_header_size=_HEAD_AT_MOST)
    if dtype.hasobject:
        reason = f"the array '{member.filename[:60]}' holds Python objects, which are not unpickled"
        raise refusal("D836", path, format="an NPZ archive of numbers", reason=reason, where="", help=_HELP)
    as_objects = dtype.kind in "US" or member.filename in ("states.npy", "actions.npy")
    _check_size(math.prod(shape) * (_AS_OBJECT if as_objects else 8), path)
    if math.prod(shape) * dtype.itemsize > member.file_size:
        reason = f"the array '{member.filename[:60]}' is shorter than its head says"
        raise refusal("D836", path, format="an NPZ archive", reason=reason, where="", help=_HELP)
    with archive.open(member) as stream:
        array: Array = np.lib.format.read_array(stream, allow_pickle=False)
    return array


def _time(array: Array, path: Path) -> Array:
    column = _column(array, "'time'", path)
    whole = whole_stamps(array)
    return column if whole is None else whole


def _column(array: Array, place: str, path: Path) -> Array:
    if array.ndim != 1 or array.dtype.kind not in "biufUS":
        found = f"an array of shape {array.shape} and type {array.dtype}"
        hint = "a signal has one number or Boolean a sample; a table goes into 'states' or one array a column"
        raise refusal("D837", path, place=place, found=found, expected="an array of one dimension", help=hint)
    if array.dtype.kind in "iuf":
        return array.astype(np.float64)
    return array if array.dtype.kind == "b" else array.astype(str).astype(object)


def _entries(array: Array, place: str, path: Path) -> tuple[Any, ...]:
    if array.ndim == 0 or array.dtype.kind not in "biufUS":
        found = f"an array of shape {array.shape} and type {array.dtype}"
        hint = "the first dimension counts samples"
        raise refusal("D837", path, place=place, found=found, expected="a list of numbers", help=hint)
    return tuple(array.tolist())


def _episodes(whole: Recording, labels: Array, path: Path) -> list[Recording]:
    columns = {**whole.columns, "episode": labels}
    checked(Recording(time=whole.time, columns=columns, states=whole.states), path)
    groups = episode_rows([f"{x:g}" if isinstance(x, float) else x for x in labels.tolist()])
    expected = len(labels) - len(groups)
    if whole.actions is not None and len(whole.actions) != expected:
        samples = f"{len(labels)} samples in {len(groups)} episodes"
        raise refusal("D839", path, length=len(whole.actions), samples=samples)
    recordings = []
    done = 0
    for label, at in groups:
        steps = len(at) - 1
        recordings.append(
            Recording(
                time=None if whole.time is None else whole.time[at],
                columns={name: column[at] for name, column in whole.columns.items()},
                states=None if whole.states is None else tuple(whole.states[i] for i in at),
                actions=None if whole.actions is None else whole.actions[done : done + steps],
                episode=label if len(groups) > 1 else None,
            )
        )
        done += steps
    return recordings
