"""Which warnings are reported, and how severely: the settings of `pyproject.toml` and of the command line.

In: `[tool.stlspec]` of the nearest pyproject.toml, upward from a spec. Out: `Selection`, and `applied`, which keeps
what is selected. Codes are named whole or by their beginning, as `L6`; the longest that fits decides. Errors are
always reported: a spec with errors cannot be compiled, whatever is ignored.
"""

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Literal

from stlspec.errors import CATALOGUE, Diagnostic, InputError, diagnostic

Level = Literal["off", "warning", "error"]
ALL = "ALL"
LARGEST = 2**20
_KEYS = ("select", "ignore", "deny", "levels")
_LEVELS = ("off", "warning", "error")


@dataclass(frozen=True, slots=True)
class Selection:
    """What is reported of warnings; errors are reported always.

    select, ignore: codes or their beginnings, or ALL; among those that fit the longest decides, and `ignore` where
    both are as long. levels: by code or beginning. deny: whether warnings count as errors.
    """

    select: tuple[str, ...] = (ALL,)
    ignore: tuple[str, ...] = ()
    deny: bool = False
    levels: Mapping[str, Level] = field(default_factory=dict)

    def level(self, found: Diagnostic) -> Level:
        """Return what a diagnostic counts as."""
        if found.severity == "error":
            return "error"
        if _fit(found.code, self.select) <= _fit(found.code, self.ignore):
            return "off"
        named = max((name for name in self.levels if _fits(found.code, name)), key=len, default=None)
        level: Level = self.levels[named] if named is not None else "warning"
        return "error" if level == "warning" and self.deny else level

    def applied(self, diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """Return the diagnostics that are reported, each with the severity that it has here."""
        kept = []
        for found in diagnostics:
            level = self.level(found)
            if level != "off":
                kept.append(found if level == found.severity else replace(found, severity=level))
        return tuple(kept)


def _fits(code: str, name: str) -> bool:
    return name == ALL or code.startswith(name)


def _fit(code: str, names: Iterable[str]) -> int:
    """Return the length of the longest name that fits, 0 for ALL, -1 if none does."""
    return max(((0 if name == ALL else len(name)) for name in names if _fits(code, name)), default=-1)


def problem_with(name: str, *, hides: bool) -> tuple[str, str] | None:
    """Say what is wrong with a code or the beginning of one, and the way out; None if nothing is.

    hides: whether it is there to hide warnings, which errors are not.
    """
    fitting = [row for row in CATALOGUE.values() if _fits(row.code, name)] if name else []
    if not fitting:
        close = get_close_matches(name.upper(), CATALOGUE, 1, 0.6)
        way = f"did you mean `{close[0]}`?" if close else "`stlspec explain` lists all codes"
        return f"there is no code `{name[:20]}`", way
    if hides and all(row.level == "error" for row in fitting):
        return (
            f"`{name}` is an error, and errors cannot be ignored",
            "mend what it reports",
        )
    return None


def override(
    base: Selection, select: Sequence[str] | None, ignore: Sequence[str] | None, deny: Sequence[str] | None
) -> Selection:
    """Replace settings by those of the command line, where it gives any.

    Raises: InputError: a code that there is not, or an error that is to be ignored.
    """
    given: dict[str, Any] = {}
    problems = []
    for key, values in (("select", select), ("ignore", ignore)):
        if values is not None:
            names = tuple(part.strip().upper() for value in values for part in value.split(",") if part.strip())
            if not names:
                problems.append((f"--{key}: no code is given", "name codes, or how codes begin, such as `L6`"))
            wrong = [problem_with(name, hides=key == "ignore") for name in names]
            problems += [(f"--{key}: {w[0]}", w[1]) for w in wrong if w]
            given[key] = names
    if deny is not None:
        problems += [(f"--deny: `{d[:20]}` is no level", "write `--deny warning`") for d in deny if d not in _DENIED]
        given["deny"] = bool(deny)
    if problems:
        raise InputError(diagnostic("D880", what=what, help=way) for what, way in problems)
    return replace(base, **given)


_DENIED = ("warning", "warnings")


def configured(spec: Path) -> Selection:
    """Read the settings that hold for a spec file.

    Returns: those of the nearest pyproject.toml in its folder or above that has `[tool.stlspec]`, else the default.
    Raises: InputError: S094, the settings cannot be used.
    """
    for folder in spec.absolute().parents:
        path = folder / "pyproject.toml"
        if path.is_file():
            table = _table(path)
            if table is not None:
                return _read(path, table)
    return Selection()


def _table(path: Path) -> Any:
    try:
        with path.open("rb") as file:
            text = file.read(LARGEST + 1)
        if len(text) > LARGEST:
            raise InputError([_bad(path, f"it has more than {LARGEST} bytes", "keep it small")])
        tool = tomllib.loads(text.decode("utf-8")).get("tool", {})
    except (OSError, ValueError, RecursionError) as error:
        problem = str(getattr(error, "strerror", None) or error).splitlines()[0][:200]
        raise InputError([_bad(path, problem, "mend it; it must be TOML in UTF-8")]) from None
    return tool.get("stlspec") if isinstance(tool, dict) else None


def _read(path: Path, table: Any) -> Selection:
    if not isinstance(table, dict):
        raise InputError([_bad(path, "`tool.stlspec` is no table", "write `[tool.stlspec]`")])
    problems: list[Diagnostic] = []
    for key in table.keys() - set(_KEYS):
        close = get_close_matches(key, _KEYS, 1, 0.5)
        way = f"did you mean `{close[0]}`?" if close else f"its keys are {', '.join(_KEYS)}"
        problems.append(_bad(path, f"there is no setting `{key[:40]}`", way))
    names = {key: _names(path, key, table.get(key, default), problems) for key, default in _LISTS.items()}
    deny = table.get("deny", [])
    if deny not in ("warning", [], ["warning"]):
        problems.append(_bad(path, '`deny` is not "warning"', 'write deny = "warning"'))
    levels = _levels(path, table.get("levels", {}), problems)
    if problems:
        raise InputError(sorted(problems, key=lambda p: p.message))
    return Selection(names["select"], names["ignore"], bool(deny), levels)


_LISTS = {"select": [ALL], "ignore": list[str]()}


def _names(path: Path, key: str, value: Any, problems: list[Diagnostic]) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        problems.append(_bad(path, f"`{key}` is no list of codes", f'write {key} = ["L603"]'))
        return ()
    names = tuple(name.upper() for name in value)
    for name in names:
        wrong = problem_with(name, hides=key == "ignore")
        if wrong:
            problems.append(_bad(path, f"{key}: {wrong[0]}", wrong[1]))
    return names


def _levels(path: Path, value: Any, problems: list[Diagnostic]) -> dict[str, Level]:
    if not isinstance(value, dict):
        problems.append(_bad(path, "`levels` is no table", 'write levels = { L603 = "error" }'))
        return {}
    found: dict[str, Level] = {}
    for name, level in value.items():
        wrong = problem_with(name.upper(), hides=level != "error")
        if wrong:
            problems.append(_bad(path, f"levels: {wrong[0]}", wrong[1]))
        elif level not in _LEVELS:
            problems.append(_bad(path, f"levels: {str(level)[:20]!r} is no level", "write off, warning or error"))
        else:
            found[name.upper()] = level
    return found


def _bad(path: Path, problem: str, way: str) -> Diagnostic:
    return diagnostic("S094", file=str(path), problem=problem, help=way)
