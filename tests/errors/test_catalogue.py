"""The catalogue of codes: complete rows, examples that do what they say, templates that can be filled."""

import re
import string
from pathlib import Path

import pytest

from stlspec import errors
from stlspec.compiler.review import review_source
from stlspec.errors import CATALOGUE, diagnostic
from stlspec.source import SourceText

PACKAGE = Path(errors.__file__).parents[1]
SPECS = [row for row in CATALOGUE.values() if row.kind == "spec"]


def found_in(text):
    return [d.code for d in review_source(SourceText.of("example.stl", text)).diagnostics]


@pytest.mark.parametrize("row", SPECS, ids=lambda row: row.code)
def test_a_bad_example_gives_its_code_once_and_a_good_one_nothing(row):
    assert found_in(row.bad) == [row.code]
    assert found_in(row.good) == []


@pytest.mark.parametrize("row", CATALOGUE.values(), ids=lambda row: row.code)
def test_a_row_says_what_why_and_the_way_out(row):
    assert re.fullmatch(r"[SNTUIGLBDX]\d{3}", row.code)
    assert row.level in ("error", "warning")
    assert row.title and row.message and row.explanation.endswith((".", ")"))
    assert row.bad and row.good


@pytest.mark.parametrize("row", CATALOGUE.values(), ids=lambda row: row.code)
def test_templates_are_filled_by_named_fields_only(row):
    fields = {
        name
        for template in (row.message, row.label, row.help)
        for _, name, _, _ in string.Formatter().parse(template)
        if name is not None
    }
    assert all(name.isidentifier() for name in fields)
    made = diagnostic(row.code, **dict.fromkeys(fields, "{x}"))
    assert made.severity == row.level


def test_codes_are_unique_and_every_one_of_the_language_is_used_somewhere():
    codes = [row.code for part in errors._PARTS for row in part.CODES]
    assert len(codes) == len(set(codes)) == len(CATALOGUE)
    sources = [path.read_text() for path in PACKAGE.rglob("*.py") if path.parent.name != "errors"]
    used = set(re.findall(r'"([SNTUIGBL]\d{3})"', "\n".join(sources)))
    assert {code for code in CATALOGUE if code[0] in "SNTUIGBL"} == used
