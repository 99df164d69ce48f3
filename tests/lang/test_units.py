"""Units as exponents of words."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.lang.units import KNOWN, NANOSECONDS, SCALES, SPELLINGS, dimension, is_unit_word, spell


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("m", {"m": 1}),
        ("m/s", {"m": 1, "s": -1}),
        ("m/s**2", {"m": 1, "s": -2}),
        ("m/s/s", {"m": 1, "s": -2}),
        ("kg*m**2/s**2", {"kg": 1, "m": 2, "s": -2}),
        ("1/s", {"s": -1}),
        ("m/m", {}),
        ("%", {"percent": 1}),
        ("", {}),
        ("m//s", None),
        ("m s", None),
        ("/s", None),
        ("m**", None),
        ("3 m", None),
    ],
)
def test_a_unit_is_read_as_exponents(unit, expected):
    assert dimension(unit) == expected


@given(st.dictionaries(st.sampled_from(["m", "s", "kg", "rad"]), st.integers(-3, 3).filter(bool)))
def test_a_dimension_is_spelled_so_that_it_reads_back(exponents):
    assert dimension(spell(exponents)) == exponents


def test_time_units_are_exact_multiples_of_a_nanosecond():
    assert NANOSECONDS["h"] == 60 * NANOSECONDS["min"] == 3600 * NANOSECONDS["s"] == 3600 * 10**9
    assert NANOSECONDS["s"] == 10**3 * NANOSECONDS["ms"] == 10**6 * NANOSECONDS["us"]


def test_habits_of_spelling_lead_to_units_that_are_known():
    assert set(SPELLINGS.values()) <= KNOWN
    assert not any(is_unit_word(word) for word in SPELLINGS)


def test_scales_are_between_words_that_the_language_knows():
    assert set(SCALES) <= KNOWN
    assert {base for base, _ in SCALES.values()} <= KNOWN
    assert all(base not in SCALES or SCALES[base] == (base, 1) for base, _ in SCALES.values())
