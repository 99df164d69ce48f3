"""Compiling, and the command that is run most: `stlspec check`.

Whole processes are timed by the CPU seconds of ended children, in turn with an empty Typer command that
imports Lark, since that is what any such command must pay.
"""

import resource
import subprocess
import sys
from pathlib import Path

from tests.benchmarks.contest import Figure, OwnFailureError
from tests.benchmarks.table import Goal, Section
from tests.benchmarks.workloads import spec_of_30_lines

ROOT = Path(__file__).resolve().parents[2]
EMPTY = "import lark, typer\napp = typer.Typer(add_completion=False)\napp.command()(lambda: None)\napp()"


def compiling(arena, data):
    """Compile 30 lines within a process that has done it before."""
    section = Section("compile 30 lines, in a running process")
    job = ("stlspec", {"kind": "compile", "spec": spec_of_30_lines()})
    section.contest(arena.contest({"stlspec.compile": job}), "ms")
    return section


def checking(arena, data):
    """`stlspec check` of 30 lines as a process of its own."""
    spec = arena.work / "data" / "thirty.stl"
    spec.write_text(spec_of_30_lines(), encoding="utf-8")
    commands = {
        "an empty Typer command with `import lark`": [sys.executable, "-c", EMPTY],
        "stlspec check": [sys.executable, "-m", "stlspec", "check", str(spec)],
        "a bare interpreter": [sys.executable, "-c", "pass"],
    }
    rounds = {label: [] for label in commands}
    for turn in range(4 if arena.quick else 16):
        for label, command in commands.items():
            taken = child_seconds(command)
            if turn:  # the first one writes byte code and fills the cache of the disk
                rounds[label].append(taken)
    figures = {label: Figure.of(seconds) for label, seconds in rounds.items()}
    section = Section("stlspec check of 30 lines, whole process, CPU")
    section.contest(figures, "ms")
    times = figures["stlspec check"].median / figures["an empty Typer command with `import lark`"].median
    section.goals = [Goal("times the empty command", times, 2, at_least=False)]
    return section


def child_seconds(command):
    """Run a command; return its CPU seconds. Raises: OwnFailureError: it fails."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=ROOT)
    if done.returncode:
        raise OwnFailureError(f"{' '.join(command[-3:])}: {(done.stdout + done.stderr)[:300]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
