"""The output directory of a run: written in one step, resumed after an interruption.

In: the texts and pictures of a finished run, or the state of an unfinished one. Out: files. While a run
lasts everything is in the sibling directory OUT.partial (`segment-KEY.json`); the results are written to
OUT.partial/run, and renaming that directory is the only step that changes OUT: nobody ever sees half a run.
"""

import json
import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from stlspec.documents import DamageError, read_document
from stlspec.errors import UsageError, diagnostic

RESULT = "result.json"
RESULT_SCHEMA = "stlspec.learn/1"
CHECKPOINT_SCHEMA = "stlspec.checkpoint/1"
_LARGEST_RESULT = 64 * 2**20
_LARGEST_CHECKPOINT = 2**30


def dumps(document: Any) -> str:
    """Return JSON text; a number that is not finite must have been replaced by a string before."""
    return json.dumps(document, allow_nan=False, ensure_ascii=False)


def claim(out: str | Path) -> Path:
    """Make sure, before any work, that the directory of a run may be written.

    Args:    out: the directory as the user gave it.
    Returns: its absolute path; links are followed.
    Raises:  UsageError D872: it exists and is neither empty nor an earlier run, or cannot be written.
    """
    path = Path(os.path.realpath(out))
    if not path.name:
        raise _refused(out, "is no directory of its own")
    partial = partial_directory(path)
    try:
        if (partial / "old").is_dir() and not path.exists():
            # a run was killed between its last two renames: what was there before comes back
            (partial / "old").rename(path)
        if path.is_dir():
            if any(path.iterdir()) and not _is_run(path):
                raise _refused(out, "holds something else than an earlier run of `stlspec learn`")
            if not os.access(path, os.W_OK):
                raise _refused(out, "cannot be written: permission denied")
        elif path.exists():
            raise _refused(out, "exists and is not a directory")
        if partial.exists() and not partial.is_dir():
            raise _refused(f"{out}.partial", "is where an unfinished run is kept, and is not a directory")
        # made and removed: a place that cannot be written to should be known before training
        partial.mkdir(parents=True, exist_ok=True)
        _remove_if_empty(partial)
    except OSError as error:
        raise _refused(out, f"cannot be written: {error.strerror or error}") from None
    return path


def partial_directory(path: Path) -> Path:
    """Return the directory that keeps an unfinished run of `path`."""
    return path.with_name(path.name + ".partial")


def _is_run(path: Path) -> bool:
    """Tell whether a directory holds an earlier run and nothing else: only that may be replaced."""
    try:
        document = read_document(path / RESULT, RESULT_SCHEMA, _LARGEST_RESULT)
    except DamageError:
        return False
    files = document.get("files")
    names = set(map(str, files.values())) if isinstance(files, dict) else set()
    return {entry.name for entry in path.iterdir()} <= names


def _refused(path: str | Path, problem: str) -> UsageError:
    return UsageError([diagnostic("D872", path=str(path), problem=problem)])


def publish(out: Path, writers: Mapping[str, Callable[[Path], object]]) -> None:
    """Write all files of a run, then put the directory in its place and forget the checkpoint.

    Args:    out: as `claim` returned it. writers: for each file name a function that writes that file.
    Raises:  UsageError D872: the directory cannot be written, or something else was put there meanwhile.
    """
    partial = partial_directory(out)
    try:
        for name in ("run", "old"):
            shutil.rmtree(partial / name, ignore_errors=True)
        (partial / "run").mkdir(parents=True)
        for name, write in writers.items():
            write(partial / "run" / name)
        if out.is_dir():
            if any(out.iterdir()) and not _is_run(out):
                raise _refused(out, "was changed by someone else while the run lasted")
            out.rename(partial / "old")
        (partial / "run").rename(out)
        shutil.rmtree(partial / "old", ignore_errors=True)
        discard(out)
    except OSError as error:
        raise _refused(out, f"cannot be written: {error.strerror or error}") from None


def discard(out: Path) -> None:
    """Remove the checkpoints of a run, and their directory if nothing else is in it."""
    partial = partial_directory(out)
    for place in partial.glob("segment-*.json*"):
        place.unlink(missing_ok=True)
    _remove_if_empty(partial)


def _remove_if_empty(partial: Path) -> None:
    if partial.is_dir() and not any(partial.iterdir()):
        partial.rmdir()


def _checkpoint(out: Path, fingerprint: str) -> Path:
    """Return where a segment is kept: each in a file of its own, since several processes may write."""
    return partial_directory(out) / f"segment-{fingerprint[:16]}.json"


def save_checkpoint(out: Path, fingerprint: str, state: Mapping[str, Any]) -> None:
    """Keep the state of a segment; a crash while writing leaves the checkpoint before it."""
    place = _checkpoint(out, fingerprint)
    fresh = place.with_name(f"{place.name}.{os.getpid()}.new")
    document = {"schema": CHECKPOINT_SCHEMA, "fingerprint": fingerprint, **state}
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        fresh.write_text(dumps(document), encoding="utf-8")
        fresh.replace(place)
    except OSError as error:
        raise _refused(out, f"cannot be written: {error.strerror or error}") from None


def has_checkpoint(out: str | Path) -> bool:
    """Tell whether an unfinished run of a directory was kept."""
    return any(partial_directory(Path(os.path.realpath(out))).glob("segment-*.json"))


def load_checkpoint(out: Path, fingerprint: str) -> dict[str, Any] | None:
    """Return the state of a segment with the same settings; None if there is none that is sound."""
    try:
        document = read_document(_checkpoint(out, fingerprint), CHECKPOINT_SCHEMA, _LARGEST_CHECKPOINT)
    except DamageError:
        return None
    return document if document.get("fingerprint") == fingerprint else None
