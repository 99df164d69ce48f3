"""Virtual environments for libraries that cannot live beside ours: `python -m stlspec.paper.libraries`.

In: a folder and the packages that it is to hold. Out: the interpreter that can import them. An environment is made
once, by `venv` and `pip`, in a folder of another name that is renamed when it is complete, so that there is never
half of one; it is known again by the packages that were asked for.
"""

import os
import shutil
import subprocess
import sys
import time
import venv
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from stlspec.errors import UsageError, diagnostic, render

MCE_IRL = ("imitation==1.0.1", "seals==0.2.1", "torch==2.13.0")
"""imitation needs gymnasium below 1.0, and brings it; any recent torch does, pinned for its figures."""

HELP = "it needs the network once, and 2 GB in the folder of XDG_CACHE_HOME, or ~/.cache; nothing else needs them"
SECONDS = 1800
_MARK = "packages.txt"


class NotInstalledError(Exception):
    """The packages cannot be installed here; says why in one line."""


def cache() -> Path:
    """Return the folder of this user for what can be made again."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "stlspec"


def find(folder: Path, packages: Sequence[str]) -> Path | None:
    """Return the interpreter of an environment that `install` made for the same packages; None: there is none."""
    try:
        known = (folder / _MARK).read_text() == _mark(packages)
    except (OSError, ValueError):
        return None
    python = _python(folder)
    return python if known and python.exists() else None


def install(folder: Path, packages: Sequence[str], seconds: float = SECONDS) -> Path:
    """Return the interpreter of an environment with packages, made if it is not there yet.

    Not in the paper: its baseline lived beside its own code, before gymnasium 1.0.

    Args:    folder: replaced if it holds other packages. seconds: how long pip may take.
    Raises:  NotInstalledError: pip cannot install them, or the folder cannot be written.
    """
    found = find(folder, packages)
    if found is not None:
        return found
    making = folder.with_name(f".{folder.name}.{os.getpid()}")
    _sweep(making.parent, f".{folder.name}.*", 2 * seconds)
    try:
        making.parent.mkdir(parents=True, exist_ok=True)
        venv.create(making, with_pip=True, clear=True, symlinks=os.name != "nt")
        _pip(_python(making), packages, seconds)
        (making / _MARK).write_text(_mark(packages))
        shutil.rmtree(folder, ignore_errors=True)
        making.rename(folder)
    except OSError as error:
        raise NotInstalledError(f"'{error.filename}': {error.strerror}") from None
    except subprocess.CalledProcessError as error:  # venv could not set up pip
        raise NotInstalledError(str(error)[:200]) from None
    finally:
        shutil.rmtree(making, ignore_errors=True)
    return _python(folder)


def _sweep(parent: Path, pattern: str, seconds: float) -> None:
    """Remove what installations left that were killed: nobody works for so long on a folder, which holds 2 GB."""
    for left in parent.glob(pattern):
        with suppress(OSError):
            if time.time() - left.stat().st_mtime > seconds:
                shutil.rmtree(left, ignore_errors=True)


def _python(folder: Path) -> Path:
    return folder / "Scripts" / "python.exe" if os.name == "nt" else folder / "bin" / "python"


def _mark(packages: Sequence[str]) -> str:
    return "\n".join([sys.version, *packages])


def _pip(python: Path, packages: Sequence[str], seconds: float) -> None:
    command = [str(python), "-m", "pip", "install", "--quiet", "--no-input", "--disable-pip-version-check"]
    try:
        done = subprocess.run(  # noqa: S603 - our own interpreter and pinned packages
            [*command, "--retries", "1", *packages], capture_output=True, text=True, timeout=seconds, check=False
        )
    except subprocess.TimeoutExpired:
        raise NotInstalledError(f"pip took longer than {seconds:g} s") from None
    if done.returncode:
        errors = [line.strip() for line in done.stderr.splitlines() if "error" in line.lower()]
        raise NotInstalledError((errors or ["pip failed"])[-1][:200])


def main() -> int:
    """Make the environment of MCE-IRL, and say where it is.

    Raises: UsageError D880: it cannot be made.
    """
    folder = cache() / "mce-irl"
    if find(folder, MCE_IRL) is None:
        print(f"installing {', '.join(MCE_IRL)} in {folder}, about 2 GB", file=sys.stderr, flush=True)
    try:
        print(install(folder, MCE_IRL))
    except NotInstalledError as error:
        what = f"the libraries of MCE-IRL cannot be installed: {error}"
        raise UsageError([diagnostic("D880", what=what, help=HELP)]) from None
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except UsageError as refused:
        print(*map(render, refused.diagnostics), sep="\n", file=sys.stderr)
        sys.exit(2)
