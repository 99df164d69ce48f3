"""Processes are timed by the CPU seconds of children, and a failing one is not timed at all."""

import sys

import pytest

from tests.benchmarks import startup
from tests.benchmarks.contest import OwnFailureError


def test_a_process_that_works_takes_cpu_time():
    assert 0 < startup.child_seconds([sys.executable, "-c", "sum(range(100000))"]) < 10


def test_a_process_that_fails_is_told_with_what_it_said():
    with pytest.raises(OwnFailureError, match="no luck"):
        startup.child_seconds([sys.executable, "-c", "raise SystemExit('no luck')"])
