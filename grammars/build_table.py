"""Build hook: makes the parser table, for wheels and editable installs alike.

In: grammars/stl.lark. Out: stlspec/lang/table.bin beside the module that reads it, keyed by the grammar and
Lark's version. It is a cache: without it, or if it is stale, the table is built in memory at the first parse.
"""

import importlib.util
from pathlib import Path
from types import ModuleType
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


def _grammar_module(root: Path) -> ModuleType:
    """Load stlspec/lang/grammar.py alone: the package and what it depends on are not installed yet."""
    spec = importlib.util.spec_from_file_location("stlspec_grammar", root / "stlspec" / "lang" / "grammar.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class TableHook(BuildHookInterface):  # type: ignore[type-arg,misc]
    """Writes the table before the files of the distribution are collected."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Make the table in the source tree, where both kinds of install find it."""
        if self.target_name == "wheel":
            _grammar_module(Path(self.root)).write_table()
