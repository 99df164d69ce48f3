"""The language reference names every code, operator and alias that there is."""

import re
from pathlib import Path

from stlspec.errors import CATALOGUE
from stlspec.lang.grammar import grammar_text

PAGE = Path(__file__).parents[1] / "grammars" / "README.md"
TEXT = PAGE.read_text(encoding="utf-8")
HEAD = "| code | level | title |\n|---|---|---|\n"


def table() -> str:
    rows = sorted(CATALOGUE.values(), key=lambda row: row.code)
    return "".join(f"| {row.code} | {row.level} | {row.title} |\n" for row in rows)


def test_the_table_of_codes_is_the_catalogue() -> None:
    assert TEXT.split(HEAD)[1] == table(), "run `python tests/test_reference.py` to write it again"


def test_every_word_and_sign_of_the_grammar_is_named() -> None:
    words = re.findall(r'^[A-Z_]+(?:\.\d)?: "(.+)"$', grammar_text(), re.M)
    assert len(words) > 70
    plain = TEXT.replace("\\|", "|")
    missing = [
        w for w in words if w not in (":=", "{", "}", ")", "]") and not re.search(rf"[`\s(\[]{re.escape(w)}", plain)
    ]
    assert missing == []


if __name__ == "__main__":
    PAGE.write_text(TEXT.split(HEAD)[0] + HEAD + table(), encoding="utf-8")
