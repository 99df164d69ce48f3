"""Files that hold a spec or a bundle.

In: a path. Out: its text as `SourceText`, or the bundle that it compiles to or holds. What is no spec (a mesh,
binary data, a folder) is refused before anything is parsed; writing is atomic.
"""

import errno
import os
import secrets
import struct
from collections.abc import Mapping
from pathlib import Path

from stlspec.compiler import bundle_file
from stlspec.compiler.bundle import BundleData
from stlspec.compiler.compiling import compile_source
from stlspec.errors import InputError, UsageError, diagnostic
from stlspec.source import SourceText

LARGEST_SPEC = 16 * 2**20
_MESH_HEADER, _MESH_FACET = 84, 50


def read_bytes(path: str | Path, limit: int = LARGEST_SPEC) -> bytes:
    """Read a file of at most `limit` bytes.

    Raises: InputError: it cannot be read, or is larger.
    """
    shown = str(path)
    try:
        with Path(path).open("rb") as file:
            data = file.read(limit + 1)
            size = os.fstat(file.fileno()).st_size if len(data) > limit else len(data)
    except (OSError, ValueError) as error:
        problem = (getattr(error, "strerror", None) or str(error)).lower()
        way = "is the path right?" if isinstance(error, FileNotFoundError) else "check the path and its permissions"
        raise InputError([diagnostic("S092", file=shown, verb="read", problem=problem, help=way)]) from None
    if len(data) > limit:
        raise InputError([diagnostic("S093", file=shown, size=size, limit=limit)])
    return data


def write_bytes(path: str | Path, data: bytes) -> None:
    """Write a file, whole or not at all; links are followed, a device or a pipe is simply written to.

    Raises: InputError: it cannot be written.
    """
    target = Path(os.path.realpath(path))
    temporary = None
    try:
        if target.exists() and not target.is_file():
            target.write_bytes(data)
            return
        if target.exists() and not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, "permission denied")
        mode = target.stat().st_mode & 0o777 if target.exists() else None
        temporary = target.with_name(f".{target.name}.{secrets.token_hex(4)}")
        handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        if mode is not None:
            temporary.chmod(mode)
        temporary.replace(target)
    except OSError as error:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        problem = (error.strerror or str(error)).lower()
        way = "check that its folder exists and can be written"
        raise InputError([diagnostic("S092", file=str(path), verb="write", problem=problem, help=way)]) from None


def read_source(path: str | Path) -> SourceText:
    """Read a spec as text.

    Raises: InputError: S090 a mesh, S091 no UTF-8 text, S092 unreadable, S093 too large.
    """
    return decode(read_bytes(path), str(path))


def read_used(path: str) -> SourceText:
    """Read a file that a spec uses: a regular one, so that no device or pipe is waited for.

    Raises: InputError: as `read_source`; B706: it is a compiled bundle.
    """
    # `Path` raises for a name that is too long, where these say no.
    if os.path.exists(path) and not os.path.isfile(path):  # noqa: PTH110, PTH113
        way = "name the file of a spec"
        raise InputError([diagnostic("S092", file=path, verb="read", problem="it is no regular file", help=way)])
    data = read_bytes(path)
    if looks_like_bundle(path, data):
        raise InputError([diagnostic("B706", file=path)])
    return decode(data, path)


def decode(data: bytes, name: str) -> SourceText:
    """Turn the bytes of a spec into text; see `read_source`."""
    if _is_mesh(data):
        raise InputError([diagnostic("S090", file=name)])
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        problem = f"byte {error.start} is 0x{data[error.start]:02x}"
        raise InputError([diagnostic("S091", file=name, problem=problem)]) from None
    if "\0" in text:
        raise InputError([diagnostic("S091", file=name, problem="it holds NUL characters")])
    return SourceText.of(name, text)


def _is_mesh(data: bytes) -> bool:
    """Tell whether this is a stereolithography mesh, as text or as binary data."""
    start = data[:4096].lower()
    if start.lstrip().startswith(b"solid") and (b"facet" in start or b"endsolid" in start):
        return True
    if len(data) < _MESH_HEADER:
        return False
    (facets,) = struct.unpack_from("<I", data, _MESH_HEADER - 4)
    return len(data) == _MESH_HEADER + _MESH_FACET * facets and b"\0" in data[:_MESH_HEADER]


def looks_like_bundle(path: str | Path, data: bytes) -> bool:
    """Tell whether a file is meant as a bundle: by its extension, or because it begins as JSON."""
    return str(path).endswith(".stlb") or data[:64].lstrip().startswith(b"{")


def read_bundle(path: str | Path) -> BundleData:
    """Load a compiled bundle from a file.

    Raises: InputError: it cannot be read. BundleError: it is damaged, foreign or changed.
    """
    return bundle_file.load(read_bytes(path, bundle_file.LARGEST), str(path))


def read_spec(path: str | Path, params: Mapping[str, float | str] | None = None) -> BundleData:
    """Compile a spec file, or load it if it is a bundle.

    Raises: SpecError, InputError, BundleError; UsageError: params with a bundle.
    """
    data = read_bytes(path, bundle_file.LARGEST)
    if looks_like_bundle(path, data):
        bundle = bundle_file.load(data, str(path))
        if params:
            raise UsageError([diagnostic("B705", file=str(path))])
        return bundle
    if len(data) > LARGEST_SPEC:
        raise InputError([diagnostic("S093", file=str(path), size=len(data), limit=LARGEST_SPEC)])
    return compile_source(decode(data, str(path)), params, read_used)
