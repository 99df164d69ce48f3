"""Freed memory is kept for the next evaluation."""

import subprocess
import sys

import pytest

FAULTS = """
import resource, sys
import numpy as np
from stlspec.semantics.memory import keep_freed_memory
if sys.argv[1] == "keep":
    keep_freed_memory()
for _ in range(3):  # the first round gets the memory from the system in any case
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    arrays = [np.ones(1_000_000) for _ in range(6)]  # as an evaluation holds several at once
    del arrays
    after = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
print(after - before)
"""


def faults(how):
    run = subprocess.run([sys.executable, "-c", FAULTS, how], capture_output=True, text=True, check=True)
    return int(run.stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="page faults are counted on Linux")
def test_an_array_gets_the_memory_of_the_one_before_without_page_faults():
    if faults("not") < 1000:
        pytest.skip("this C library keeps freed memory by itself")
    assert faults("keep") < 100
