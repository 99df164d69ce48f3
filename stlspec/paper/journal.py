"""What was measured, kept as one JSON file for each experiment, so that a stopped reproduction goes on.

In: the result of an experiment as JSON. Out: `Record`s. A file is written whole or not at all, and counts only for
the same experiment with the same budget and the same version of the package.
"""

import json
import math
import os
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from stlspec import __version__
from stlspec.compiler.files import write_bytes
from stlspec.documents import DamageError, read_document

SCHEMA = "stlspec.paper/1"
PACKAGES = ("stlspec", "numpy", "gymnasium")
_LARGEST = 256 * 2**20


@dataclass(frozen=True, slots=True)
class Record:
    """One finished experiment.

    name: of the experiment. budget: see `budgets`. seconds: wall-clock time it took. load: how many processes
    wanted a processor, on average over the last minute, before and after. machine: processors, and versions of
    what ran. result: as JSON.
    """

    name: str
    budget: Mapping[str, Any]
    seconds: float
    load: tuple[float, float]
    machine: Mapping[str, Any]
    result: Mapping[str, Any]


def load_of_machine() -> float:
    """Return how many processes wanted a processor over the last minute; -1 where the system does not say."""
    return round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else -1.0


def machine() -> dict[str, Any]:
    """Describe what the experiments run on: figures of time mean nothing without it."""
    return {
        "processors": os.cpu_count() or 1,
        "architecture": platform.machine(),
        "system": platform.system(),
        "python": platform.python_version(),
        **{name: version(name) for name in PACKAGES},
    }


def place_of(out: Path, name: str) -> Path:
    """Return the file of an experiment."""
    return out / "results" / f"{name}.json"


def save(out: Path, record: Record) -> None:
    """Keep a finished experiment.

    Raises: InputError: the file cannot be written.
    """
    place = place_of(out, record.name)
    text = json.dumps({"schema": SCHEMA, "version": __version__, **asdict(record)}, allow_nan=False, indent=1)
    write_bytes(place, text.encode("utf-8"))


def load(out: Path, name: str, budget: Mapping[str, Any] | None = None) -> Record | None:
    """Return what was kept of an experiment.

    Args:    budget: it must have been measured with; None: with any.
    Returns: the record; None if there is none, or it is damaged, or of another budget or version. What its result
             holds is checked by whoever reads it.
    """
    try:
        document = read_document(place_of(out, name), SCHEMA, _LARGEST)
    except DamageError:
        return None
    try:
        if document.pop("version") != __version__ or document.pop("schema") != SCHEMA or document["name"] != name:
            return None
        record = Record(**document | {"load": tuple(document["load"])})
    except (KeyError, TypeError):
        return None
    if not _is_sound(record):
        return None
    return record if budget is None or record.budget == dict(budget) else None


def _is_sound(record: Record) -> bool:
    """Say whether all fields are of their kind."""
    numbers = (record.seconds, *record.load)
    mappings = (record.budget, record.machine, record.result)
    return (
        len(numbers) == 3
        and all(type(x) in (int, float) and abs(x) < math.inf for x in numbers)
        and all(isinstance(x, dict) for x in mappings)
    )
