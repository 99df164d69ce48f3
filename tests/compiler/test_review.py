"""What `check` and editors show: errors alone while there are any, then warnings too."""

from pathlib import Path

import pytest

from stlspec.compiler.files import read_source, read_used
from stlspec.compiler.review import review_source
from stlspec.compiler.selection import Selection
from stlspec.source import SourceText

SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.stl"))


def test_lints_wait_until_there_are_no_errors():
    text = "signal x\nsignal y\nhard a: always (z > 1)\n"
    assert [d.code for d in review_source(SourceText.of("s", text)).diagnostics] == ["N101"]


def test_a_selection_applies_to_checks_and_lints_alike():
    text = "signal x\nsignal y\nhard a: always (x > 1)\nsoft b: eventually (x > 1)\n"
    found = review_source(SourceText.of("s", text), selection=Selection(ignore=("L606",), deny=True)).diagnostics
    assert [(d.code, d.severity) for d in found] == [("L615", "error"), ("G505", "error")]


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_the_specs_of_the_paper_are_clean(path):
    assert review_source(read_source(path), None, read_used).diagnostics == ()
