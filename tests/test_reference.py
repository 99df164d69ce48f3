"""The language reference names every code, operator and alias that there is."""

import re
from pathlib import Path

from stlspec.errors import CATALOGUE
from stlspec.lang.grammar import grammar_text

TEXT = (Path(__file__).parents[1] / "grammars" / "README.md").read_text(encoding="utf-8")


def test_the_table_of_codes_is_the_catalogue() -> None:
    rows = re.findall(r"^\| ([A-Z]\d{3}) \| (\w+) \| (.+) \|$", TEXT, re.M)
    assert rows == [(row.code, row.level, row.title) for row in sorted(CATALOGUE.values(), key=lambda r: r.code)]


def test_every_word_and_sign_of_the_grammar_is_named() -> None:
    words = re.findall(r'^[A-Z_]+(?:\.\d)?: "(.+)"$', grammar_text(), re.M)
    assert len(words) > 70
    plain = TEXT.replace("\\|", "|")
    missing = [w for w in words if w not in (":=", "{", "}", ")", "]") and not re.search(rf"[`\s(\[]{re.escape(w)}", plain)]
    assert missing == []
