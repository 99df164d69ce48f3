from math import inf

import pytest

from stlspec.paper.spread import Spread, duration, ratios, short, spread


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([5], (5, 5, 5)),
        ([1, 2, 3], (1, 2, 3)),
        ([4, 1, 3, 2], (1, 2, 4)),
        ([1, 2, 3, 4, 5], (2, 3, 4)),
        ([1, None, 2], (1, 2, inf)),
        ([None, None], (inf, inf, inf)),
    ],
)
def test_quartiles_are_numbers_that_occurred_the_outer_ones_in_doubt(values, expected):
    assert spread(values) == expected


def test_no_values_have_no_quartiles():
    with pytest.raises(ValueError, match="no values"):
        spread([])


def test_ratios_go_seed_by_seed_and_leave_out_what_neither_reached():
    assert ratios([10, None, None, 6], [5, 4, None, None]) == [2.0, inf, 0.0]


@pytest.mark.parametrize(
    ("value", "text"), [(inf, "never"), (0.000613, "0.000613"), (12.345, "12.3"), (999.7, "1 000"), (93083, "93 083")]
)
def test_numbers_are_written_short(value, text):
    assert short(value) == text


def test_a_spread_is_written_as_median_and_quartiles():
    assert str(Spread(1.0, 2.5, inf)) == "2.5 (1 to never)"


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.5, "0.5 s"), (119, "119 s"), (120, "2 minutes"), (4800, "80 minutes")]
)
def test_a_time_is_written_in_seconds_or_minutes(seconds, text):
    assert duration(seconds) == text
