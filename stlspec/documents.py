"""JSON documents that stlspec wrote itself and reads again: reward maps, policies, results, checkpoints.

In: a path and what the document should be. Out: its fields, or a `DamageError` that says what is wrong, which
the caller turns into a diagnostic of its own. At most `limit` bytes are read, whatever size the file claims.
"""

import json
from pathlib import Path
from typing import Any

State = int | tuple[int, int]
"""A state as files have it: its number, or (row, col) on maps."""


class DamageError(ValueError):
    """What is wrong with a document, in the words of a diagnostic."""


def read_document(path: Path, schema: str, limit: int) -> dict[str, Any]:
    """Read a JSON object of one schema.

    Not in the paper: file formats.

    Args:    path: the file. schema: what its "schema" must be. limit: bytes, the largest size.
    Returns: the object; only its schema has been checked.
    Raises:  DamageError: it cannot be read, is larger, no JSON in UTF-8, or of another schema.
    """
    try:
        with path.open("rb") as file:
            data = file.read(limit + 1)
    except (OSError, ValueError) as error:
        raise DamageError(getattr(error, "strerror", None) or "it cannot be read") from None
    if len(data) > limit:
        raise DamageError(f"the file is larger than {limit} bytes")
    try:
        document = json.loads(data.decode("utf-8"))
    except (ValueError, RecursionError):
        raise DamageError("it is not JSON in UTF-8") from None
    if not isinstance(document, dict) or document.get("schema") != schema:
        raise DamageError(f"its schema is not {schema}")
    return document


def read_state(value: Any) -> State:
    """Turn a state as JSON has it into a state. Not in the paper. Raises: DamageError: it is none."""
    if type(value) is int and value >= 0:
        return value
    if isinstance(value, list) and len(value) == 2 and all(type(x) is int and x >= 0 for x in value):
        return (value[0], value[1])
    raise DamageError(f"{str(value)[:40]!r} is not a state: a number or [row, col]")
