"""Time stlspec beside other tools, in one run.

    python tests/benchmarks/run.py [--quick] [--json FILE]

Each tool is installed in an environment of its own under the user's cache directory or `--work DIR`; one that
does not install is reported. Contestants are timed in turn, by CPU seconds of their own process, on the same
data; every figure is a median with the least and the greatest of the rounds beside it. Only ratios within one
run mean anything. A coarse clock is refused.
"""

import argparse
import json
import platform
import sys
import time
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.benchmarks import offline, online, parsing, startup
from tests.benchmarks.contest import Arena, OwnFailureError
from tests.benchmarks.peers.measuring import CoarseClockError, check_clock
from tests.benchmarks.table import Section, document_of, text_of
from tests.benchmarks.workloads import Data
from tests.peers.environments import default_work

TOOLS = ("mstlo", "rtamt", "reelay", "stlrom", "moonlight")
PARTS = {
    "windows": offline.windows,
    "until": offline.until,
    "batch": offline.batch,
    "passes": offline.passes,
    "memory": offline.memory,
    "every": online.every,
    "start": online.start,
    "pending": online.pending,
    "parse": parsing.parsing,
    "compile": startup.compiling,
    "check": startup.checking,
}


def noise(arena, data, when):
    """Time the yardstick itself: how far apart its rounds lie is what this machine adds to every figure."""
    section = Section(f"np.minimum over n = 1e6, {when}")
    section.contest(arena.contest({"a pass": data.job("stlspec", "minimum", [], data.long, 10**6)}))
    return section


def sections_of(arena, data, names):
    """Run the parts and yield their sections."""
    yield noise(arena, data, "before")
    for name in names:
        found = PARTS[name](arena, data)
        yield from found if isinstance(found, list) else [found]
    yield noise(arena, data, "after")


def main(arguments=None):
    """Print the table, and write it with `--json`; return 1 if stlspec fails, 2 where nothing can be timed."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter rounds, smaller sizes")
    parser.add_argument("--only", nargs="*", default=list(PARTS), choices=list(PARTS), help="only these parts")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures here too")
    parser.add_argument("--work", type=Path, default=default_work(), help="where environments and data are kept")
    options = parser.parse_args(arguments)
    try:
        step = check_clock()
    except CoarseClockError as error:
        print(f"refused: {error}", file=sys.stderr)
        return 2
    begin = time.perf_counter()
    arena = Arena(options.work, options.quick)
    arena.install(TOOLS)
    data = Data(options.work / "data", 10**6 if options.quick else 10**7)
    machine = {"python": platform.python_version(), "system": platform.system(), "clock_step_seconds": step}
    print(
        f"Python {machine['python']}, process clock in steps of {step * 1e6:.2g} us; missing: {arena.missing or 'none'}"
    )
    sections = []
    try:
        for section in sections_of(arena, data, options.only):
            sections.append(section)
            print(f"\n{text_of(section)}", flush=True)
    except OwnFailureError as error:
        print(f"stlspec fails: {error}", file=sys.stderr)
        return 1
    versions = ", ".join(f"{tool} {version}" for tool, version in sorted(arena.versions.items()))
    print(f"\n{versions}; {time.perf_counter() - begin:.0f} s")
    if options.json is not None:
        document = document_of(
            sections, machine | {"missing": arena.missing, "versions": arena.versions, "quick": options.quick}
        )
        options.json.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
