"""JSON Lines: one demonstration object a line.

In: a file. Out: one `Recording` a line, numbered from 0; blank lines do not count. Lines end at LF or CRLF
only, since the other characters that end a line in Unicode may stand inside a JSON string.
"""

from pathlib import Path

from stlspec.errors import DataError
from stlspec.readers.document import decode, is_whole, numbered, other_format, recording_of
from stlspec.readers.model import Recording, read_text, refusal


def read(path: Path) -> list[Recording]:
    """Read a JSON Lines file.

    Not in the paper: a file format.

    Raises: DataError D803, D805, D830, D832, D833, D835 to D839: the file cannot be used.
    """
    text = read_text(path, "one demonstration object a line")
    try:
        documents = [
            (decode(line, path, number), number) for number, line in enumerate(text.split("\n"), 1) if line.strip()
        ]
    except DataError:
        if "\n" in text.strip() and is_whole(text):
            raise other_format(path, "it is one JSON document over several lines", ".json") from None
        raise
    recordings = [recording_of(document, path, f"line {number}") for document, number in documents]
    if not recordings:
        raise refusal("D803", path, where=": all lines are blank")
    return numbered(recordings)
