"""Specs as people of a dozen fields write them: clean, and they do what their own expectations say."""

from pathlib import Path

import pytest

from stlspec.cli.main import run
from stlspec.compiler.review import review_source
from stlspec.source import SourceText

DOMAINS = sorted((Path(__file__).parent / "domains").glob("*.stl"))


@pytest.mark.parametrize("path", DOMAINS, ids=lambda path: path.stem)
def test_each_is_clean_and_meets_its_expectations(path, capsys):
    assert review_source(SourceText.of(path.name, path.read_text(encoding="utf-8"))).diagnostics == ()
    assert run(["test", str(path)]) == 0
    assert "expectation" in capsys.readouterr().out


def test_there_are_a_dozen():
    assert len(DOMAINS) == 12
