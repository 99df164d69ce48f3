"""The hooks for pre-commit run commands that there are, on the files that are specs.

`pre-commit run --all-files` itself, against a clone, needs the network: it builds an environment.
"""

import re
from pathlib import Path

import pytest

from stlspec.cli.main import run

HOOKS = (Path(__file__).parents[1] / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
ENTRIES = re.findall(r"^  entry: stlspec (.+)$", HOOKS, re.M)
CANONICAL = "signal d\n\nhard a:\n    always (d > 1)\n"


def test_there_is_one_to_check_and_one_to_format_and_each_takes_specs_only():
    assert ENTRIES == ["check", "fmt"]
    for pattern in re.findall(r"^  files: (.+)$", HOOKS, re.M):
        assert [bool(re.search(pattern, name)) for name in ("a.stl", "b/c.stlspec", "d.stlb", "stl")] == [1, 1, 0, 0]
    assert HOOKS.count("types: [text]") == 2, "meshes are binary, and have the same ending"


@pytest.mark.parametrize("entry", ENTRIES)
def test_each_passes_good_files_and_fails_with_a_broken_one(entry, tmp_path):
    good, bad = tmp_path / "a good one.stl", tmp_path / "bad.stl"
    good.write_text(CANONICAL)
    bad.write_text("signal d\nhard a: always (d > 1) and\n")
    assert run([*entry.split(), str(good), str(good)]) == 0
    assert run([*entry.split(), str(good), str(bad)]) == 1
    assert good.read_text() == CANONICAL
