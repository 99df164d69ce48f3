"""JSON: one demonstration object, or a list of them.

In: a file. Out: one `Recording` an object; those of a list are numbered from 0. A file that has one object on
each line is read by `jsonl`, whatever its name promises is not guessed at.
"""

from pathlib import Path

from stlspec.errors import DataError
from stlspec.readers.document import decode, is_lines, numbered, other_format, recording_of
from stlspec.readers.model import Recording, read_text, refusal


def read(path: Path) -> list[Recording]:
    """Read a JSON file.

    Not in the paper: a file format.

    Raises: DataError D803, D805, D830, D832, D833, D835 to D839: the file cannot be used.
    """
    text = read_text(path, "a demonstration object, or a list of them")
    try:
        document = decode(text, path)
    except DataError:
        if is_lines(text):
            raise other_format(path, "each line is a JSON document of its own", ".jsonl") from None
        raise
    if not isinstance(document, list):
        return [recording_of(document, path)]
    if not document:
        raise refusal("D803", path, where=": the list is empty")
    return numbered([recording_of(each, path, f"demonstration {i}") for i, each in enumerate(document)])
