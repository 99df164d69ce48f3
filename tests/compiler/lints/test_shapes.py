"""Shapes that say something else than they seem to."""

import pytest

from stlspec.compiler.review import review_source
from stlspec.source import SourceText

HEAD = "signal x\nsignal p: bool\nsignal q: bool\nparam open\n"
CODES = ("L610", "L612")


def found_in(formula, strength="soft"):
    found = review_source(SourceText.of("s", f"{HEAD}{strength} a: {formula}\n")).diagnostics
    return [d for d in found if d.code in CODES]


@pytest.mark.parametrize(
    "formula", ["always (p implies next q)", "G (p -> (q and X p))", "always[0, inf] (p implies X q)"]
)
def test_a_next_that_fails_at_the_end_is_found_and_its_fix_cures_it(formula):
    (found,) = found_in(formula)
    assert found.code == "L610"
    text = found.fixes[0].applied(found.source.text)
    assert [d.code for d in review_source(SourceText.of("s", text)).diagnostics if d.code in CODES] == []


@pytest.mark.parametrize(
    "formula", ["always (p implies wnext q)", "always[0, 5] (p implies next q)", "p implies next q"]
)
def test_a_next_that_need_not_fail_is_left_alone(formula):
    assert found_in(formula) == []


@pytest.mark.parametrize(
    ("formula", "meaning"),
    [
        ("always always p", "`always (p)`"),
        ("eventually (eventually p)", "`eventually (p)`"),
        ("always eventually p", "`p` holds at the last sample"),
        ("F G F p", "`p` holds at the last sample"),
        ("eventually historically once p", "`p` holds at the first sample"),
    ],
)
def test_towers_that_collapse_are_found_once(formula, meaning):
    found = [d for d in found_in(formula) if d.code == "L612"]
    assert len(found) == 1 and meaning in found[0].message


@pytest.mark.parametrize(
    "formula", ["always eventually[0, 5] p", "always[0, 5] always p", "always (p implies eventually q)"]
)
def test_towers_with_bounds_mean_what_they_say(formula):
    assert [d.code for d in found_in(formula)] == []
