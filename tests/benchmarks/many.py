"""Many Parquet files: throughput of two processes against one, peak memory against the number of files, Ray, a kill.

`python -m tests.benchmarks.many`, from the root of the repository, makes 1,000 files of 1,000 x 1,000 samples (4 GB),
of which a spec uses three columns, and removes them. `--files`, `--samples`, `--columns` scale it to the disk at hand.
"""

import argparse
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

SPEC = """spec many
signal c1
signal c2
signal c3
hard low: always (c1 > -3.5)
soft reach: eventually (c2 > 3)
soft answer depends on low: always (c1 > 2 implies eventually[0, 50] (c3 > 1))
"""


def make_files(folder, files, samples, columns, seed=0):
    """Write the files; each is the same noise, shifted by its number, so that no two are alike."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=(samples, columns)).astype(np.float32)
    for number in range(files):
        shifted = np.roll(noise, number * 7 + 1, axis=0)
        table = pa.table({f"c{k}": np.ascontiguousarray(shifted[:, (k + number) % columns]) for k in range(columns)})
        pq.write_table(table, folder / f"f{number:04}.parquet", compression="none", use_dictionary=False)


def start(folder, out, *words, files="*"):
    """Start scoring in a process group of its own."""
    command = [sys.executable, "-m", "stlspec", "score", "s.stl", f"data/f{files}.parquet", "--out", out, *words]
    where = {**os.environ, "PYTHONPATH": str(Path.cwd())}
    return subprocess.Popen(
        command, cwd=folder, env=where, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )


def scored(folder, out, *words, files="*"):
    """Score to the end; return seconds and the peak of the memory of all its processes together, in bytes."""
    begin, peaks = time.monotonic(), [0]
    process = start(folder, out, *words, files=files)

    def watch():
        while process.poll() is None:
            peaks.append(sum(resident(pid) for pid in family(process.pid)))
            time.sleep(0.05)

    watcher = threading.Thread(target=watch)
    watcher.start()
    assert process.wait() == 0
    seconds = time.monotonic() - begin
    watcher.join()
    return seconds, max(peaks)


def family(pid):
    """Give a process and all below it."""
    found = [pid]
    for one in found:
        try:
            found += map(int, Path(f"/proc/{one}/task/{one}/children").read_text().split())
        except OSError:
            continue
    return found


def resident(pid):
    """Return the memory that a process has for itself, in bytes; 0 if it has gone."""
    try:
        text = Path(f"/proc/{pid}/smaps_rollup").read_text()
    except OSError:
        return 0
    sizes = [line.split() for line in text.splitlines() if line.startswith("Pss:")]
    return int(sizes[0][1]) * 1024 if sizes else 0


def killed(folder, out, files, *words):
    """Start a run, kill it about half-way, and return how many files it had settled; None if it had ended."""
    process, mark = start(folder, out, *words), folder / f"{out}.resume"
    done = 0
    while done < files // 2 and process.poll() is None:
        time.sleep(0.02)
        try:
            done = json.loads(mark.read_text())["files"]
        except (OSError, ValueError):
            continue
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return None if (folder / out).exists() else done


def throughput(folder, files, samples, repeats):
    """Print the throughput of one process and of two, taken in turn."""
    taken = {1: [], 2: []}
    for _ in range(repeats):
        for jobs, seconds in taken.items():
            begin = time.monotonic()
            assert start(folder, f"jobs{jobs}.jsonl", "--jobs", str(jobs)).wait() == 0  # unwatched: watching takes time
            seconds.append(time.monotonic() - begin)
    one, two = (statistics.median(seconds) for seconds in taken.values())
    ratio = statistics.median(a / b for a, b in zip(*taken.values(), strict=True))
    load = "/".join(f"{x:.1f}" for x in os.getloadavg())
    rates = " and ".join(f"{files / t:,.0f} files/s ({files * samples / t / 1e3:,.0f} k samples/s)" for t in (one, two))
    print(f"--jobs 1 and --jobs 2: {rates}; two are {ratio:.2f} times one (medians of {repeats}; load {load})")


def compare(folder, files, with_ray):
    """Print peaks of memory, and whether every way of working gives the same bytes."""
    _, few = scored(folder, "few.jsonl", "--jobs", "2", files="00*")
    _, all_files = scored(folder, "all.jsonl", "--jobs", "2")
    counts = f"{len(list(folder.glob('data/f00*')))} and {files} files"
    print(f"peak memory of all processes, {counts}: {few / 2**20:.0f} and {all_files / 2**20:.0f} MiB")
    expected = (folder / "all.jsonl").read_bytes()
    ways = {"--jobs 1": ["--jobs", "1"], **({"Ray": ["--engine", "ray"]} if with_ray else {})}
    for name, words in ways.items():
        seconds, _ = scored(folder, "way.jsonl", *words)
        same = (folder / "way.jsonl").read_bytes() == expected
        print(f"{name}: {'the same bytes' if same else 'OTHER BYTES'} as --jobs 2 ({seconds:.1f} s)")
    done = killed(folder, "killed.jsonl", files, "--jobs", "2")
    scored(folder, "killed.jsonl", "--jobs", "2")
    same = (folder / "killed.jsonl").read_bytes() == expected
    told = "ended before it could be killed" if done is None else f"killed after {done} of {files} files and resumed"
    print(f"{told}: {'the same bytes' if same else 'OTHER BYTES'}")


def main(arguments=None):
    parser = argparse.ArgumentParser(description=main.__doc__)
    for name, value in (("files", 1000), ("samples", 1000), ("columns", 1000), ("repeats", 5)):
        parser.add_argument(f"--{name}", type=int, default=value)
    parser.add_argument("--ray", action="store_true", help="Ray too; needs the extra ray")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "s.stl").write_text(SPEC)
        (folder / "data").mkdir()
        make_files(folder / "data", options.files, options.samples, options.columns)
        size = sum(path.stat().st_size for path in (folder / "data").iterdir())
        print(
            f"{options.files} files of {options.samples} x {options.columns} samples, {size / 1e9:.2f} GB", flush=True
        )
        throughput(folder, options.files, options.samples, options.repeats)
        compare(folder, options.files, options.ray)
    return 0


if __name__ == "__main__":
    sys.exit(main())
