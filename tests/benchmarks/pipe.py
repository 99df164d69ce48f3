"""CSV through a pipe: time and peak memory of `score SPEC -` against the size of the input.

`python -m tests.benchmarks.pipe --gb 0.1 1 3`, from the root of the repository. The rows are made as they are sent.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

SPEC = """spec pipe
time 10 ms
signal x
signal y
hard up: always (x > -100)
soft reach: eventually (y > 4)
soft answer depends on up: always (x > 2 implies eventually[0, 500 ms] (y > 0))
soft seen: always (y > 3 implies once (x > 1))
soft stay: (x > -100) until (y > 5)
"""
HEADER = b"time,a,x,b,y,c,d\n"
ROWS = 50_000


def rows(size, seed=0):
    """Give rows until about `size` bytes have been given: stamps in order, the rest from a pool of blocks."""
    rng = np.random.default_rng(seed)
    pool = [[",".join(f"{v:.4f}" for v in row) for row in rng.normal(size=(ROWS, 6)).tolist()] for _ in range(8)]
    sent = sample = 0
    while sent < size:
        tails = pool[int(rng.integers(len(pool)))]
        block = "\n".join(f"{10 * (sample + i)},{tail}" for i, tail in enumerate(tails)).encode() + b"\n"
        yield block
        sent += len(block)
        sample += ROWS


def measured(size, spec):
    """Send a stream to the command; return bytes sent, seconds, and the peak resident memory in bytes."""
    command = [sys.executable, "-m", "stlspec", "score", str(spec), "-", "--format", "json"]
    begin = time.monotonic()
    sent = len(HEADER)
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        answer = []
        reader = threading.Thread(target=lambda: answer.append(process.stdout.read()))
        reader.start()
        process.stdin.write(HEADER)
        for block in rows(size):
            process.stdin.write(block)
            sent += len(block)
        process.stdin.close()
        reader.join()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0 and b"stlspec.score/1" in answer[0]
    return sent, time.monotonic() - begin, usage.ru_maxrss * 1024


def main(arguments=None):
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--gb", type=float, nargs="+", default=[0.1, 1.0])
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder, "pipe.stl")
        spec.write_text(SPEC)
        for gb in options.gb:
            sent, seconds, peak = measured(gb * 1e9, spec)
            work = f"{sent / 1e9:6.2f} GB  {seconds:7.1f} s  {sent / 1e6 / seconds:6.1f} MB/s"
            print(f"{work}  peak {peak / 2**20:6.1f} MiB  load {os.getloadavg()[0]:.1f}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
