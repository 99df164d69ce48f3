"""JSON Lines: one demonstration object a line.

In: a file. Out: one `Recording` a line, numbered from 0; blank lines do not count. Lines end at LF or CRLF
only, since the other characters that end a line in Unicode may stand inside a JSON string.
"""

from pathlib import Path

from stlspec.readers.document import decode, numbered, recording_of
from stlspec.readers.model import Recording, read_text, refusal


def read(path: Path) -> list[Recording]:
    """Read a JSON Lines file.

    Not in the paper: a file format.

    Raises: DataError D803, D805, D830, D832, D833, D835 to D839: the file cannot be used.
    """
    text = read_text(path, "one demonstration object a line")
    recordings = [
        recording_of(decode(line, path, number), path, f"line {number}")
        for number, line in enumerate(text.split("\n"), 1)
        if line.strip()
    ]
    if not recordings:
        raise refusal("D803", path, where=": all lines are blank")
    return numbered(recordings)
