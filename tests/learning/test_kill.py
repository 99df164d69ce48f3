"""A run that is killed leaves no result or a whole one, and goes on from where it was kept."""

import importlib.util
import random
import subprocess
from pathlib import Path

_SPEC = importlib.util.spec_from_file_location("kill", Path(__file__).with_name("kill.py"))
kill = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(kill)

OFTEN = "from stlspec.learning import segments as s; s.CHECKPOINT_SECONDS, s.CHECKPOINT_SHARE = 0.0, 1e9; "


def often(words):
    """Let a command keep its state after every chunk."""
    return [*words[:2], OFTEN + words[2]]


def test_a_killed_run_is_absent_or_complete_and_resumes_to_the_same_bits(tmp_path):
    name = "two goals"
    whole, out = tmp_path / "whole", tmp_path / "out"
    subprocess.run(kill.command(name, whole, 1500), check=True, stdout=subprocess.DEVNULL)
    draw = random.Random(name)
    killed = 0
    while killed < 2:
        killed += kill.killed_after(often(kill.command(name, out, 1500)), draw.uniform(0.3, 1.2), alone=False)
        assert not out.exists() or kill.complete(out)
        if out.exists():
            break
    subprocess.run(kill.command(name, out, 1500), check=True, stdout=subprocess.DEVNULL)
    assert kill.complete(out)
    assert kill.kept(out) == kill.kept(whole)
    assert {path.name for path in tmp_path.iterdir()} == {"whole", "out"}
