"""Parquet: one column a signal, one row a sample; needs the extra `parquet`.

In: a file whose columns are named as those of a CSV file are, with `time`, `episode` and `action` of the same
meaning, and `states` as a column of lists. Out: one `Recording` an episode. Only the columns that somebody asks for
are read, so that a spec over three signals costs the same from a log of three columns and from one of a thousand.
Stamps of a time type bring their unit along.
"""

import math
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stlspec.readers.model import (
    Array,
    Recording,
    checked,
    column_of,
    episode_rows,
    refusal,
    repeated,
    required_file,
    time_of,
)

if TYPE_CHECKING:
    import pyarrow as pa

_ROWS_AT_MOST = 2**27
_NUMBERS_AT_MOST = 2**28
_SPECIAL = ("time", "episode", "action", "states")
_HELP = "write it with pandas: frame.to_parquet(...), or with pyarrow.parquet.write_table"


def read(path: Path, columns: Collection[str] | None = None) -> list[Recording]:
    """Read a Parquet file.

    Not in the paper: a file format.

    Args:   columns: the signals that are wanted; None = all.
    Raises: DataError D803, D805, D830, D833, D835 to D838, D840: the file cannot be used; D847: the extra is missing.
    """
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise refusal("D847", path, what="reading Parquet", extra="parquet") from None
    required_file(path, "columns, one a signal")
    try:
        # Neither the page index nor a memory map: a file that changes meanwhile must not take the process down.
        with pq.ParquetFile(path, memory_map=False) as file:
            names = file.schema_arrow.names
            _check_names(names, path)
            wanted = [name for name in names if columns is None or name in columns or name in _SPECIAL]
            _check_size(file.metadata.num_rows, len(wanted), path)
            # With no column at all (a spec over `now` alone) some column still tells the number of samples.
            table = file.read(columns=wanted or names[:1])
        parts = {name: _converted(table.column(name), name, path) for name in table.column_names}
        unit = _time_unit(table.schema.field("time").type) if "time" in parts else None
    except (pa.ArrowException, OSError) as error:
        reason = (str(error) or type(error).__name__).splitlines()[0][:120]
        raise refusal("D836", path, format="a Parquet file", reason=reason, where="", help=_HELP) from None
    return _recordings(parts, unit, tuple(n for n in names if n not in parts), path)


def _check_names(names: list[str], path: Path) -> None:
    twice = repeated(names)
    if twice is not None:
        reason = f"the file has the column '{twice[:60]}' twice"
        raise refusal("D835", path, reason=reason, help="give each column a name of its own")
    if not names:
        raise refusal("D833", path, expected="columns, one a signal")


def _check_size(n_rows: int, n_columns: int, path: Path) -> None:
    if n_rows == 0:
        raise refusal("D803", path, where=": the file has columns and no rows")
    if n_rows > _ROWS_AT_MOST or n_rows * max(1, n_columns) > _NUMBERS_AT_MOST:
        raise refusal("D838", path, size=f"{n_rows * max(1, n_columns) * 8:,}", limit=f"{_NUMBERS_AT_MOST * 8:,}")


def _time_unit(kind: "pa.DataType") -> str | None:
    """Return the unit of stamps of a time type; such stamps are whole numbers of it."""
    return getattr(kind, "unit", None) if str(kind).startswith(("timestamp", "duration", "time32", "time64")) else None


def _converted(column: "pa.ChunkedArray", name: str, path: Path) -> Any:
    """Return a column as an array, holes as NaN; as a list where its entries are lists or texts."""
    import pyarrow as pa

    kind = column.type
    if pa.types.is_dictionary(kind):
        column = column.cast(kind.value_type)
        kind = column.type
    if name in ("states", "action", "episode"):
        return column.to_pylist()
    if name == "time":
        return _stamps(column, path)
    if pa.types.is_boolean(kind) and not column.null_count:
        return column.to_numpy().astype(np.bool_)
    if pa.types.is_floating(kind) or pa.types.is_integer(kind):
        return np.asarray(column.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64)
    if pa.types.is_decimal(kind):
        return np.asarray(column.cast(pa.float64()).to_numpy(), dtype=np.float64)
    if pa.types.is_null(kind):
        return np.full(len(column), math.nan)
    if pa.types.is_boolean(kind) or pa.types.is_string(kind) or pa.types.is_large_string(kind):
        return column_of([math.nan if value is None else value for value in column.to_pylist()])
    hint = "a signal has one number or Boolean a sample; lists of numbers go into the column 'states'"
    place, found = f"column '{name[:60]}'", f"of type {kind}"
    raise refusal("D837", path, place=place, found=found, expected="numbers or Booleans", help=hint)


def _stamps(column: "pa.ChunkedArray", path: Path) -> Array:
    import pyarrow as pa

    kind = column.type
    if column.null_count:
        sample = next(i for i, value in enumerate(column.is_null().to_pylist()) if value)
        raise refusal("D812", path, time="null", sample=sample)
    if _time_unit(kind) or pa.types.is_integer(kind):
        return np.asarray(column.cast(pa.int64()).to_numpy(), dtype=np.int64)
    if pa.types.is_floating(kind):
        return np.asarray(column.cast(pa.float64()).to_numpy(), dtype=np.float64)
    return time_of(column.to_pylist())


def _recordings(parts: dict[str, Any], unit: str | None, others: tuple[str, ...], path: Path) -> list[Recording]:
    time, labels = parts.pop("time", None), parts.pop("episode", None)
    actions, states = parts.pop("action", None), parts.pop("states", None)
    length = len(next(part for part in (time, labels, actions, states, *parts.values()) if part is not None))
    groups: list[tuple[str | None, Any]] = [(None, np.arange(length))]
    if labels is not None:
        found = episode_rows(labels)
        groups = [(label if len(found) > 1 else None, at) for label, at in found]
    return [
        checked(
            Recording(
                time=None if time is None else time[at],
                columns={name: column[at] for name, column in parts.items()},
                states=None if states is None else tuple(states[k] for k in at),
                actions=None if actions is None else _actions([actions[k] for k in at], path),
                episode=label,
                time_unit=unit,
                others=others,
            ),
            path,
        )
        for label, at in groups
    ]


def _actions(own: list[Any], path: Path) -> tuple[Any, ...]:
    """Take the actions of one episode: none in its first row, one in every other."""
    if own[0] is not None:
        raise refusal("D840", path, reason=f"the first row of an episode has the action {str(own[0])[:40]!r}")
    if None in own[1:]:
        raise refusal("D840", path, reason=f"sample {own.index(None, 1)} of an episode has no action")
    return tuple(own[1:])
