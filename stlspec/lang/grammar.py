"""The Lark grammar: where it lies, its parser table, and the groups of terminals that the parser asks for.

In: `stl.lark`, inside the installed package or beside it in a checkout. Out: a Lark instance. The saved table
is read from the package only (it is a pickle) and only if it was made from this grammar by this Lark; if not,
the table is built in memory. This module imports nothing of stlspec, so the build hook can load it alone.
"""

import hashlib
import io
import pickle
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import lark

_HERE = Path(__file__).resolve()
_TABLE = _HERE.with_name("table.bin")
_STARTS = ["statement", "expression", "lexicon"]
_KEY_LENGTH = 64


def grammar_path() -> Path:
    """Return the place of the grammar: in the package (wheel) or beside it (checkout, editable install)."""
    package = _HERE.parents[1]
    inside = package / "grammars" / "stl.lark"
    return inside if inside.exists() else package.parent / "grammars" / "stl.lark"


@cache
def grammar_text() -> str:
    """Return the text of the grammar."""
    return grammar_path().read_text(encoding="utf-8")


def _key() -> bytes:
    made_from = f"{lark.__version__}\n{grammar_text()}"
    return hashlib.sha256(made_from.encode()).hexdigest().encode()


def build(transformer: object | None = None, *, strict: bool = False) -> lark.Lark:
    """Build the parser from the grammar's text; `strict` refuses any conflict (needs interegular)."""
    return lark.Lark(
        grammar_text(),
        parser="lalr",
        lexer="basic",
        start=_STARTS,
        keep_all_tokens=True,
        maybe_placeholders=False,
        transformer=transformer,
        strict=strict,
    )


def write_table() -> None:
    """Save the parser table in the package, whole or not at all."""
    buffer = io.BytesIO()
    build().save(buffer)
    with tempfile.NamedTemporaryFile(dir=_TABLE.parent, delete=False) as file:
        file.write(_key() + buffer.getvalue())
    Path(file.name).chmod(0o644)
    Path(file.name).replace(_TABLE)


def _saved_table() -> Any:
    """Return the saved table; None if there is none, it is damaged, or another grammar or Lark made it."""
    try:
        data = _TABLE.read_bytes()
        if data[:_KEY_LENGTH] != _key():
            return None
        return pickle.loads(data[_KEY_LENGTH:])  # noqa: S301 - made by the build, in the package
    except (OSError, EOFError, ValueError, pickle.UnpicklingError):
        return None


def table_is_current() -> bool:
    """Tell whether the saved table was made from this grammar by this Lark."""
    return _saved_table() is not None


def parser(transformer: object) -> lark.Lark:
    """Return the parser with `transformer`'s methods as its callbacks, from the saved table if it is current."""
    saved = _saved_table()
    if saved is None:
        return build(transformer)
    instance = lark.Lark.__new__(lark.Lark)
    return instance._load(saved, transformer=transformer)
