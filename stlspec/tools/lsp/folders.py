"""The specs in the folders that an editor works in, whether or not they are open.

In: folders. Out: paths of spec files. Hidden folders and those of installed packages are passed over, and so are the
3-D meshes that share the ending, told by their first bytes.
"""

import os
from collections.abc import Iterable

from stlspec.errors import InputError, diagnostic

ENDINGS = (".stl", ".stlspec")
MOST_ENTRIES = 100_000
"""How many files and folders are looked at."""
MOST_SPECS = 2_000
_PASSED_OVER = frozenset({"node_modules", "site-packages", "__pycache__", "venv"})


def specs_under(folders: Iterable[str], *, deep: bool = True) -> tuple[str, ...]:
    """Return the spec files under folders, each once, in a fixed order; `deep`: those in folders below them too.

    Raises: InputError: D880, there are too many to look through.
    """
    found: dict[str, None] = {}
    entries = 0
    for folder in folders:
        for root, names, files in os.walk(folder):
            names[:] = sorted(n for n in names if deep and not n.startswith(".") and n not in _PASSED_OVER)
            entries += len(names) + len(files)
            paths = [os.path.join(root, name) for name in sorted(files) if name.endswith(ENDINGS)]  # noqa: PTH118
            found.update(dict.fromkeys(filter(_may_be_spec, paths)))
            if entries > MOST_ENTRIES or len(found) > MOST_SPECS:
                what = f"the folder `{folder}` holds too many files to look through for uses of a name"
                raise InputError([diagnostic("D880", what=what, help="open a smaller folder")])
    return tuple(found)


def _may_be_spec(path: str) -> bool:
    """Tell a text from a mesh, as far as the beginning shows it; what cannot be read is no spec."""
    try:
        if not os.path.isfile(path):  # noqa: PTH113 - a pipe is not waited for
            return False
        with open(path, "rb") as file:  # noqa: PTH123 - as above
            start = file.read(84)
    except (OSError, ValueError):
        return False
    return b"\0" not in start and not start.lstrip().lower().startswith(b"solid")
