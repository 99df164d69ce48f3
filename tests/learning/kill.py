"""Kill `stlspec learn` at random moments, and see that nothing is ever broken.

Run it as `python tests/learning/kill.py [TIMES] [SEED]` (default 20). Each time a run is killed (SIGKILL, with or
without its processes) at a random moment; OUT must then be absent, or a complete run. The same command again must
finish, with the very policy, log and path of a run that nobody killed. It exits with 1 if that is ever not so.
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SPECS = Path(__file__).parents[2] / "specs"
COMMANDS = {
    "two goals": ["grid_two_goals.stl", "grid_5x5_two_goals", []],
    "two goals, two processes": ["grid_two_goals.stl", "grid_5x5_two_goals", ["--jobs", "2"]],
    "memory": ["grid_wet_dry.stl", "grid_wet_dry", []],
}
KEPT = ("policy.json", "episodes.csv", "reward.json", "lessons.json")


def command(name, out, episodes):
    spec, stem, more = COMMANDS[name]
    words = ["learn", str(SPECS / spec), "--env", "stlspec/GridWorld-v0", "--map", str(SPECS / "maps" / f"{stem}.txt")]
    words += ["--demos", str(SPECS / "demos" / f"{stem}.jsonl"), "--out", str(out), "--episodes", str(episodes), *more]
    return [sys.executable, "-c", f"from stlspec.cli.main import run; raise SystemExit(run({words!r}))"]


def complete(out):
    """Tell whether a directory holds a whole run."""
    try:
        result = json.loads((out / "result.json").read_text())
    except (OSError, ValueError):
        return False
    return {path.name for path in out.iterdir()} == set(result["files"].values())


def kept(out):
    """Return what two equal runs share to the bit."""
    result = json.loads((out / "result.json").read_text())
    del result["training"]["seconds"]
    return [result, *((out / name).read_bytes() for name in KEPT)]


def killed_after(words, seconds, *, alone):
    """Run a command and kill it after so many seconds; alone, or with all its processes. Tell whether it still ran."""
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, start_new_session=True)
    try:
        process.wait(timeout=seconds)
    except subprocess.TimeoutExpired:
        (os.kill if alone else os.killpg)(process.pid, signal.SIGKILL)
        process.wait()
        return True
    return False


def attempt(name, place, draw, episodes, whole, lasts):
    """Kill a run up to three times, each time later on the way; return what is wrong, and how often it was killed."""
    out, kills = place / "out", 0
    words = command(name, out, episodes)
    for _ in range(draw.randint(1, 3)):
        kills += killed_after(words, draw.uniform(0.1, lasts), alone=draw.random() < 0.5)
        if out.exists() and not complete(out):
            return "OUT is neither absent nor complete", kills
    resumed = any((place / "out.partial").glob("segment-*.json"))
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    if not complete(out):
        return "the same command did not finish the run", kills
    if kept(out) != whole:
        return "a resumed run differs from a whole one", kills
    left = [path.name for path in place.iterdir() if path.name != "out"]
    return f"left behind: {left}" if left else "", kills + 1000 * resumed


def main(times=20, seed=0, episodes=60_000):
    draw = random.Random(seed)
    broken = kills = resumed = 0
    for name in COMMANDS:
        with tempfile.TemporaryDirectory() as place:
            began = time.perf_counter()
            subprocess.run(command(name, Path(place, "out"), episodes), check=True, stdout=subprocess.DEVNULL)
            lasts = time.perf_counter() - began
            whole = kept(Path(place, "out"))
        for _ in range(-(-times // len(COMMANDS))):
            with tempfile.TemporaryDirectory() as place:
                problem, count = attempt(name, Path(place), draw, episodes, whole, lasts)
            kills, resumed = kills + count % 1000, resumed + count // 1000
            broken += bool(problem)
            if problem:
                print(f"{name}: {problem}")
        print(
            f"{name}: a run takes {lasts:.1f} s; so far killed {kills} times, {resumed} runs resumed, {broken} broken"
        )
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
