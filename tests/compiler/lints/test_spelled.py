"""Mixes without brackets on which tools disagree, and the brackets that settle them."""

import pytest

from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.compiler.compiling import compile_source
from stlspec.compiler.review import review_source
from stlspec.source import SourceText

HEAD = "signal x\nsignal p: bool\nsignal q: bool\nsignal r: bool\n"


def mixes(formula):
    found = review_source(SourceText.of("s", f"{HEAD}soft a: {formula}\n")).diagnostics
    return [d for d in found if d.code == "L613"]


@pytest.mark.parametrize(
    "formula",
    ["G p & q", "p & q -> r", "p until q and r", "(always p) and eventually q or r", "p and eventually q or r"],
)
def test_a_mix_is_reported_once_and_its_fix_keeps_the_meaning(formula):
    (found,) = mixes(formula)
    before, after = found.source.text, found.fixes[0].applied(found.source.text)
    assert "L613" not in [d.code for d in review_source(SourceText.of("s", after)).diagnostics]
    assert meaning_sha256(compile_source(SourceText.of("s", before))) == meaning_sha256(
        compile_source(SourceText.of("s", after))
    )


@pytest.mark.parametrize(
    "formula",
    [
        "(once p) implies eventually q",
        "always (p and q)",
        "p and q or r",
        "always x > 5",
        "not p and q",
        "p implies always q",
        "p and q and r",
    ],
)
def test_what_all_tools_read_alike_is_left_alone(formula):
    assert mixes(formula) == []
