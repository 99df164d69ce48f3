"""Too deep is a matter of levels, not of length."""

import pytest

from stlspec.lang.depth import DEEPEST, too_deep
from stlspec.lang.parse import parse
from stlspec.source import SourceText

FLAT = " and ".join(["a"] * 1000)


@pytest.mark.parametrize("formula", ["(" * DEEPEST + "a" + ")" * DEEPEST, "not " * DEEPEST + "a", FLAT])
def test_what_is_just_deep_enough_passes(formula):
    source = SourceText.of("s", f"let p = {formula}")
    (statement,) = parse(source).statements
    assert too_deep(source, statement) is None


def test_one_level_more_is_refused_where_it_stands():
    source = SourceText.of("s", "signal x\nhard a: " + "not " * (DEEPEST + 1) + "x")
    assert [d.code for d in parse(source).diagnostics] == ["S007"]
