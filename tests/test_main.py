"""`python -m stlspec` is the command."""

import subprocess
import sys


def test_the_package_runs_as_a_command() -> None:
    done = subprocess.run([sys.executable, "-m", "stlspec", "--version"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "stlspec 0.1.0\n")
