"""The demonstration object `stlspec.demo/1`, as JSON and JSON Lines files hold it.

In: text. Out: the decoded value, and a `Recording` of it. Decoding is bounded and strict where silence would
cost more than an error: a key that comes twice is refused, while keys that are not ours are left alone, so
that other tools can keep their notes in the same file.
"""

import json
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from stlspec.errors import DataError
from stlspec.readers.model import Array, Recording, checked, column_of, refusal, repeated, time_of

SCHEMA = "stlspec.demo/1"
_WORDS = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}
_OBJECT = 'a demonstration is an object such as {"signals": {"x": [1, 2]}}'


_ESCAPED_SURROGATE = re.compile(r"\\u[dD][89a-fA-F]")


class _RepeatedKeyError(ValueError):
    """A key that comes twice; carries the key."""


def decode(text: str, file: Path, line: int = 1) -> Any:
    """Decode JSON; NaN and Infinity are read as Python writes them.

    Not in the paper: a file format.

    Args:   line: the line of the file on which `text` begins, for messages.
    Raises: DataError D835: a key comes twice; D836: it is no JSON, is cut off, is nested too deeply, or has half
        of a surrogate pair.
    """
    try:
        value = json.loads(text, object_pairs_hook=_pairs)
        if _ESCAPED_SURROGATE.search(text):
            # Half of a pair is no character: neither a terminal nor a file could show it later.
            json.dumps(value, ensure_ascii=False).encode()
        return value
    except json.JSONDecodeError as error:
        cut = error.pos >= len(text.rstrip())
        hint = "the file seems to be cut off" if cut else "check it with: python -m json.tool FILE"
        where = f" (line {line + error.lineno - 1}, column {error.colno})"
        raise refusal("D836", file, format="JSON", reason=error.msg.lower(), where=where, help=hint) from None
    except _RepeatedKeyError as error:
        reason = f"the key '{str(error)[:60]}' comes twice in one object"
        raise refusal("D835", file, reason=reason, help="give each key a name of its own") from None
    except RecursionError:
        hint = "a demonstration is nested a few levels deep"
        raise refusal(
            "D836", file, format="JSON", reason="it is nested too deeply", where=_on(line), help=hint
        ) from None
    except UnicodeEncodeError as error:
        reason = f"\\u{ord(error.object[error.start]):04x} is half of a surrogate pair"
        hint = "write both halves, or the character itself"
        raise refusal("D836", file, format="JSON", reason=reason, where=_on(line), help=hint) from None
    except ValueError:
        # Python refuses to convert whole numbers of more than 4300 digits.
        hint = 'write it as 1e999 or "inf" if it stands for infinity'
        raise refusal("D836", file, format="JSON", reason="a number is too long", where=_on(line), help=hint) from None


def is_whole(text: str) -> bool:
    """Tell whether a text is one JSON object or list. Not in the paper: a file format."""
    try:
        return isinstance(json.loads(text), dict | list)
    except (ValueError, RecursionError):
        return False


def is_lines(text: str) -> bool:
    """Tell whether each of several lines is a JSON object or list. Not in the paper: a file format."""
    lines = [line for line in text.split("\n") if line.strip()]
    return len(lines) > 1 and all(map(is_whole, lines))


def other_format(file: Path, reason: str, suffix: str) -> DataError:
    """Say under which name a file of JSON is read. Not in the paper: a file format."""
    wanted = "JSON" if suffix == ".jsonl" else "JSON Lines"
    way = f"name it `{file.with_suffix(suffix).name}`"
    return refusal("D836", file, format=wanted, reason=reason, where="", help=way)


def recording_of(document: Any, file: Path, place: str = "the demonstration") -> Recording:
    """Read one demonstration object.

    Not in the paper: a file format.

    Args:   place: what the object is called in messages, such as "line 3".
    Raises: DataError D803, D805, D837, D839: it is no demonstration.
    """
    if not isinstance(document, dict):
        raise _wrong(file, place, document, "an object", _OBJECT)
    schema = document.get("schema", SCHEMA)
    if schema != SCHEMA:
        raise _wrong(file, f"'schema' of {place}", schema, f"'{SCHEMA}'", "this file is of another kind or version")
    signals, states = document.get("signals"), document.get("states")
    if signals is None and states is None:
        keys = ", ".join(map(repr, list(document)[:8])) or "nothing"
        raise refusal(
            "D837",
            file,
            place=place,
            found=f"an object with {keys}",
            expected="one with 'signals' or 'states'",
            help=_OBJECT,
        )
    if not isinstance(signals, dict | None):
        raise _wrong(file, f"'signals' of {place}", signals, "an object of lists", _OBJECT)
    time = document.get("time")
    recording = Recording(
        name=_text(document.get("name"), f"'name' of {place}", file),
        time=None if time is None else _column(time, f"'time' of {place}", file, time_of),
        columns={k: _column(v, f"signal '{k[:60]}' of {place}", file) for k, v in (signals or {}).items()},
        states=_list(states, f"'states' of {place}", file),
        actions=_list(document.get("actions"), f"'actions' of {place}", file),
        env=_environment(document.get("env"), f"'env' of {place}", file),
        episode=_text(document.get("episode"), f"'episode' of {place}", file),
    )
    return checked(recording, file)


def numbered(recordings: Sequence[Recording]) -> list[Recording]:
    """Give each of several recordings of one file its number, from 0, as its episode.

    Not in the paper: a file format.

    Returns: the recordings; those with an episode of their own keep it, and a single one stays without.
    """
    if len(recordings) == 1:
        return list(recordings)
    return [
        recording if recording.episode is not None else _renumbered(recording, index)
        for index, recording in enumerate(recordings)
    ]


def _renumbered(of: Recording, index: int) -> Recording:
    return Recording(of.name, of.time, of.columns, of.states, of.actions, of.env, str(index))


def _pairs(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise _RepeatedKeyError(repeated([key for key, _ in pairs]))
    return found


def _on(line: int) -> str:
    return f" (line {line})" if line > 1 else ""


def _wrong(file: Path, place: str, value: Any, expected: str, hint: str) -> DataError:
    return refusal("D837", file, place=place, found=_kind(value), expected=expected, help=hint)


def _kind(value: Any) -> str:
    names = {dict: "an object", list: "a list", bool: "a Boolean", type(None): "null"}
    return names.get(type(value)) or f"{str(value)[:40]!r}"


def _text(value: Any, place: str, file: Path) -> str | None:
    if value is None or isinstance(value, str):
        return value
    if type(value) is int and abs(value) < 10**18:
        return str(value)
    raise _wrong(file, place, value, "text", "put it in double quotes")
    return None


def _list(value: Any, place: str, file: Path) -> tuple[Any, ...] | None:
    if not isinstance(value, list | None):
        raise _wrong(file, place, value, "a list", "write it in square brackets, one entry a sample")
    return None if value is None else tuple(value)


def _column(values: Any, place: str, file: Path, convert: Callable[[Sequence[Any]], Array] = column_of) -> Array:
    listed = _list(values, place, file) or ()
    kinds = set(map(type, listed))
    for kind in (list, dict):
        if kind in kinds:
            index = next(i for i, value in enumerate(listed) if type(value) is kind)
            hint = "a signal has one number a sample"
            raise _wrong(file, f"{place} at sample {index}", listed[index], "a number", hint)
    if kinds & {str, type(None)}:
        # null is how tools without NaN in their JSON write a hole; it is refused later, with its sample.
        listed = tuple(
            math.nan if value is None else _WORDS.get(value, value) if isinstance(value, str) else value
            for value in listed
        )
    return convert(listed)


def _environment(value: Any, place: str, file: Path) -> dict[str, Any] | None:
    if not isinstance(value, dict | None):
        hint = 'write {"id": "...", "args": {...}, "map": ["...", ...]}'
        raise _wrong(file, place, value, "an object", hint)
    return value
