"""Frames as PNG, without an image library.

In: what an environment renders, (height, width, 3) of uint8. Out: the bytes of a PNG file.
"""

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

_HEAD = b"\x89PNG\r\n\x1a\n"
_FASTEST = 1


def png(frame: NDArray[np.uint8]) -> bytes:
    """Return a frame as a PNG file.

    Not in the paper: a file format. Args: frame: (height, width, 3), red, green, blue.
    """
    height, width, _ = frame.shape
    # Each row begins with its filter: 0, none.
    rows = np.zeros((height, 1 + 3 * width), dtype=np.uint8)
    rows[:, 1:] = frame.reshape(height, 3 * width)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        _HEAD
        + _chunk(b"IHDR", header)
        + _chunk(b"IDAT", zlib.compress(rows.tobytes(), _FASTEST))
        + _chunk(b"IEND", b"")
    )


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
